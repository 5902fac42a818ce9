# SPDX-License-Identifier: GPL-3.0-or-later
"""Lights, in the unit of the core: the radiance that a white Lambert surface facing the light
reflects, at 1 m for those that have a place.

What Cycles gives on such a surface: a sun of strength E, E / pi; a point or spot light of power P,
P / (4 pi²); an area light, far along its axis, P / (4 pi).
"""

import math

import bpy

from .. import compat
from ..native import capi
from . import nodes

RADIANCE_OF = {
    "SUN": 1.0 / math.pi,
    "POINT": 1.0 / (4.0 * math.pi ** 2),
    "SPOT": 1.0 / (4.0 * math.pi ** 2),
    "AREA": 1.0 / (4.0 * math.pi),
}


def emission_factor(light, warn):
    """What the light's node tree multiplies its colour with."""
    if not compat.uses_nodes(light):
        return nodes.WHITE
    output = nodes.output_node(light.node_tree, "OUTPUT_LIGHT")
    if output is None:
        return nodes.BLACK
    reader = nodes.Reader(f"Light '{light.name}'", warn)
    node, _, stack = reader.source(output.inputs["Surface"])
    if node is None:
        return nodes.BLACK
    if node.type != "EMISSION":
        reader.unsupported(node, "the light keeps its own colour and power")
        return nodes.WHITE
    color = reader.color(node.inputs["Color"], stack)
    if color.texture:
        reader.unsupported(node, "the light's colour is the same in all directions")
    return tuple(c * reader.number(node.inputs["Strength"], stack) for c in color.color)


def describe(light, matrix, library, warn):
    """The capi.Light of a Blender light at this world matrix."""
    item = library.default_light()
    item.name = capi.encode(light.name_full)
    scale = light.energy * RADIANCE_OF[light.type]
    factors = zip(light.color, compat.light_factor(light), emission_factor(light, warn))
    item.color[:] = [max(scale * c * f * e, 0.0) for c, f, e in factors]
    item.position[:] = matrix.translation
    direction = -matrix.col[2].to_3d()
    item.direction[:] = direction.normalized() if direction.length else (0.0, 0.0, -1.0)
    item.specular_factor = light.specular_factor
    item.casts_shadow = compat.light_casts_shadow(light)
    if light.type == "SUN":
        item.type = capi.LIGHT_DIRECTIONAL
    elif light.type == "POINT":
        item.type = capi.LIGHT_POINT
    else:
        item.type = capi.LIGHT_SPOT
        # An area light shines to one side with the cosine, which a soft half-space cone follows.
        item.spot_angle = light.spot_size if light.type == "SPOT" else math.pi
        item.spot_blend = light.spot_blend if light.type == "SPOT" else 1.0
        exponent = compat.spot_exponent(bpy.app.version)
        item.spot_exponent = exponent if light.type == "SPOT" else 0.0
    return item


def sync_light(export, key, light, matrix):
    """Send one light; `key` is its object's."""
    if light.type == "AREA":
        export.warn(f"Light '{light.name}': area lights are drawn as spot lights without size.")
    item = describe(light, matrix, export.session.scene.library, export.warn)
    ident = export.new_id(capi.KIND_LIGHT, key)
    export.put(capi.KIND_LIGHT, ident, capi.content(item),
               lambda: export.scene.set_light(ident, item))
