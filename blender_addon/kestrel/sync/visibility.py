# SPDX-License-Identifier: GPL-3.0-or-later
"""Which kinds of rays meet an object, and whether it is a hole in the picture."""

from ..native import capi

# Blender's switches. Its diffuse and volume rays do not exist here.
SWITCHES = {"visible_camera": capi.RAYS_CAMERA, "visible_shadow": capi.RAYS_SHADOW,
            "visible_glossy": capi.RAYS_REFLECTION, "visible_transmission": capi.RAYS_REFRACTION}


def visibility(export, obj, owner, view_layer):
    """(RAYS_… that do not meet it, whether it is a holdout) of an object that `owner`, itself or its
    instancer, places in `view_layer`; all evaluated. As in Cycles, the instancer's own switches
    count too, and its collections alone say what is a holdout or indirect only."""
    hidden = 0
    for name, rays in SWITCHES.items():
        if not (getattr(obj, name) and getattr(owner, name)):
            hidden |= rays
    if owner.indirect_only_get(view_layer=view_layer):
        hidden |= capi.RAYS_CAMERA
    if export.session.unseen_material:
        # The original's: an evaluated object may name a material that Blender has freed.
        material = obj.original.active_material
        if material is not None and material.name == export.session.unseen_material:
            hidden |= capi.RAYS_CAMERA
    if obj.is_shadow_catcher or owner.is_shadow_catcher:
        export.warn(f"Object '{owner.name}': shadow catchers are not supported; it is drawn like "
                    "any other object.")
    return hidden, bool(owner.holdout_get(view_layer=view_layer))
