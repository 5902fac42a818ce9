# SPDX-License-Identifier: GPL-3.0-or-later
"""What materials take from meshes by name: further UV maps, and colours.

A mesh brings only what some material on it wants: ("uv", name) or ("color", name) pairs.
"""

import numpy as np

from .. import compat
from ..session import stable_id

RENDER_COLOR = "\0render"  # stands for the colour attribute that rendering uses


def attribute_id(name):
    """The core's id of an attribute; 0, the mesh's own UV map, for no name."""
    return stable_id(name.encode("utf-8", "replace")) if name else 0


def _colors(mesh, name):
    """(float32 (N, 3) linear, domain) of an attribute, or None where it is no colour."""
    attribute = mesh.attributes.get(name) if name else compat.render_color(mesh)
    found = attribute and compat.attribute_values(attribute)
    if found is None:
        return None
    width = found.shape[1]
    if width == 1:
        found = np.repeat(found, 3, axis=1)
    elif width == 2:
        found = np.pad(found, ((0, 0), (0, 1)))
    return np.ascontiguousarray(found[:, :3]), attribute.domain


def _per_corner(mesh, values, domain):
    """Values of a domain at every corner of the mesh; None for a domain that has no place there."""
    if domain == "CORNER":
        return values
    if domain == "POINT":
        return values[compat.corner_vertices(mesh)]
    if domain == "FACE":
        return np.repeat(values, compat.corner_totals(mesh), axis=0)
    return None


def _uvs(mesh, name):
    layer = mesh.uv_layers.get(name)
    if layer is not None:
        return compat.corner_uvs(layer)
    attribute = mesh.attributes.get(name)
    values = attribute and compat.attribute_values(attribute)
    if values is None or values.shape[1] < 2:
        return None
    values = _per_corner(mesh, values, attribute.domain)
    return None if values is None else np.ascontiguousarray(values[:, :2])


def read_attributes(mesh, wanted):
    """[(id, float32 (C, 2) or (C, 3)), ...] per corner, of what the mesh has of `wanted`."""
    result = {}
    for kind, name in wanted:
        values = None
        found = None if kind == "uv" or name in mesh.uv_layers else _colors(mesh, name)
        if found is not None:
            values = _per_corner(mesh, *found)
        if values is None and name:
            values = _uvs(mesh, name)
        if values is not None:
            result.setdefault(attribute_id(name or RENDER_COLOR), values)
    return list(result.items())
