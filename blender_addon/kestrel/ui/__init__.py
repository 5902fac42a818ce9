# SPDX-License-Identifier: GPL-3.0-or-later
"""Panels: Kestrel's own, a file for each tab of the Properties editor, and those of Blender's that
make sense with it."""

import bpy

from . import coverage, light, material, object, presets, render, view_layer, world
from .common import ENGINE

TABS = (presets, render, coverage, object, view_layer, material, light, world)
CLASSES = tuple(cls for tab in TABS for cls in tab.CLASSES)

# Panels for every engine without one of its own that show what Kestrel has not, or shows itself.
NOT_FOR_KESTREL = {
    "DATA_PT_area", "DATA_PT_camera_stereoscopy", "DATA_PT_falloff_curve", "DATA_PT_light",
    "DATA_PT_preview", "DATA_PT_spot", "DATA_PT_volume_render",
    "EEVEE_MATERIAL_PT_viewport_settings", "NODE_DATA_PT_light", "OBJECT_PT_shading",
    "RENDER_PT_output_views", "RENDER_PT_stereoscopy", "WORLD_PT_context_world",
}
# Panels of Blender's that only engines which name them show.
ALSO_FOR_KESTREL = {"DATA_PT_camera_dof", "DATA_PT_camera_dof_aperture"}
NOT_FOR_KESTREL_PREFIXES = ("DATA_PT_lightprobe", "MATERIAL_PT_freestyle", "RENDER_PT_freestyle",
                            "RENDER_PT_gpencil", "RENDER_PT_grease_pencil", "RENDER_PT_simplify",
                            "VIEWLAYER_PT_freestyle")


def shared_panels():
    """Blender's panels that every engine without special needs shows."""
    for panel in bpy.types.Panel.__subclasses__():
        engines = getattr(panel, "COMPAT_ENGINES", ())
        name = panel.__name__
        if name in ALSO_FOR_KESTREL or (
                "BLENDER_RENDER" in engines and name not in NOT_FOR_KESTREL
                and not name.startswith(NOT_FOR_KESTREL_PREFIXES)):
            yield panel


_shared = []


def register():
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    _shared.extend(shared_panels())
    for panel in _shared:
        panel.COMPAT_ENGINES.add(ENGINE)


def unregister():
    while _shared:
        _shared.pop().COMPAT_ENGINES.discard(ENGINE)
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
