# SPDX-License-Identifier: GPL-3.0-or-later
"""Evaluated geometry as the core's meshes, one for all objects that share it."""

import numpy as np

from .. import compat
from ..native import capi
from ..session import digest
from .attributes import attribute_id, read_attributes

# What has triangles once evaluated; metaballs of a family are all in its first object.
GEOMETRY = {"MESH", "CURVE", "SURFACE", "FONT", "META"}


def triangulate(mesh):
    """int32 (3T,): the corners of every triangle, or None where each polygon is a triangle."""
    if 3 * len(mesh.polygons) == len(mesh.loops):
        if (compat.corner_totals(mesh) == 3).all():
            return None
    mesh.calc_loop_triangles()
    return compat.triangle_corners(mesh)


def render_uv_layer(mesh):
    """The UV map that rendering uses, or None."""
    return next((layer for layer in mesh.uv_layers if layer.active_render), None)


def arrays(mesh, slot_count, wanted=()):
    """The arguments of capi.Scene.set_mesh after the name. `wanted`: attributes by name."""
    positions = compat.vertex_positions(mesh)
    corners = triangulate(mesh)

    def per_corner(values):
        if values is None:
            return None
        return values if corners is None else np.take(values, corners, axis=0)

    triangles = per_corner(compat.corner_vertices(mesh)).view(np.uint32).reshape(-1, 3)
    layer = render_uv_layer(mesh)
    uvs = per_corner(compat.corner_uvs(layer)) if layer else None
    wanted = [item for item in wanted if not (layer and item == ("uv", layer.name))]
    attributes = [(ident, per_corner(values))
                  for ident, values in read_attributes(mesh, wanted)]
    slots = compat.polygon_materials(mesh) if slot_count > 1 else None
    if slots is not None:
        slots = slots if corners is None else slots[compat.triangle_polygons(mesh)]
        slots = np.clip(slots, 0, slot_count - 1).astype(np.uint32)
    return (positions, triangles, per_corner(compat.corner_normals(mesh)), uvs, slots,
            attribute_id(layer.name if layer else ""), attributes)


def _send(export, mesh, key, name, shape):
    """Id of this mesh, or 0 where it has no faces."""
    if len(mesh.polygons) == 0:
        return 0
    *values, uv_map, attributes = arrays(mesh, *shape)
    ident = export.new_id(capi.KIND_MESH, key)
    content = (name, digest(*values, *(array for _, array in attributes)), uv_map,
               tuple(ident for ident, _ in attributes))
    export.put(capi.KIND_MESH, ident, content,
               lambda: export.scene.set_mesh(ident, name, *values, uv_map, attributes))
    return ident


def _identity(obj):
    """What this object's geometry is shared by, within one evaluation."""
    data = obj.data
    if obj.type == "MESH":
        return data.as_pointer(), len(data.vertices), len(data.loops)
    return compat.datablock_key(obj.original)


def sync_mesh(export, obj, wanted=()):
    """Id of an evaluated object's geometry in the core, or 0 where there is none to draw.
    `wanted`: what its materials take from it by name."""
    identity = (_identity(obj), wanted)
    if identity in export.meshes:
        return export.meshes[identity]
    original = obj.original
    own = original.modifiers or obj.type != "MESH"
    key = compat.datablock_key(original if own else original.data)
    shape = (len(obj.material_slots), wanted)
    ident = export.unchanged_mesh(key, compat.datablock_key(original), shape)
    if ident is None:
        ident = _read(export, obj, key, shape)
    export.meshes[identity] = ident
    export.remember_mesh(key, ident, shape)
    return ident


def _read(export, obj, key, shape):
    if obj.type == "MESH" and not obj.data.is_editmode:
        return _send(export, obj.data, key, obj.data.name_full, shape)
    mesh = obj.to_mesh()
    ident = _send(export, mesh, key, obj.original.name_full, shape) if mesh else 0
    obj.to_mesh_clear()
    return ident
