# SPDX-License-Identifier: GPL-3.0-or-later
"""What an evaluation of the depsgraph changed."""

from .. import compat
from .light import sync_light
from .object import columns, object_key


def touched_geometry(depsgraph):
    """Keys of the objects and their data whose geometry this evaluation changed."""
    return {compat.datablock_key(update.id.original) for update in depsgraph.updates
            if update.is_updated_geometry}


def moved_objects(depsgraph, entangled):
    """[(key, evaluated object), ...] if this evaluation did nothing but move objects, and none of
    those whose keys are `entangled`; else None."""
    moved = []
    for update in depsgraph.updates:
        if not update.is_updated_transform or update.is_updated_geometry or (
                update.is_updated_shading or update.id.bl_rna.identifier != "Object"):
            return None
        key = object_key(update.id.original)
        if key in entangled:
            return None
        moved.append((key, update.id))
    return moved


def sync_moved(export, moved):
    """Send what moved_objects() says."""
    export.move_objects([key for key, _ in moved],
                        [columns(obj.matrix_world) for _, obj in moved])
    for key, obj in moved:
        if obj.type == "LIGHT" and key in export.session.objects.rows:
            sync_light(export, key, obj.data, obj.matrix_world)
