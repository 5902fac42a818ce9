# SPDX-License-Identifier: GPL-3.0-or-later
"""The world: a colour or an equirectangular image, and the ambient light that it gives.

A surface of albedo a under a uniform world of radiance L, with nothing in the way, reflects a L;
so the ambient light is the world's mean radiance.
"""

import math

from mathutils import Matrix

from .. import compat
from ..native import capi
from . import nodes
from .image import cached_mean, mean_radiance, sync_texture


MIST_FALLOFF = {"QUADRATIC": 2.0, "LINEAR": 1.0, "INVERSE_QUADRATIC": 0.5}


def _background(reader, socket, stack=(), depth=0):
    """The Background node of a world's tree, with its group stack, or (None, ())."""
    node, _, above = reader.source(socket, stack)
    if node is None or depth > nodes.MAX_CHAIN:
        return None, ()
    if node.type in ("BACKGROUND", "EMISSION"):
        return node, above
    reader.unsupported(node, "the first background that it leads to is used")
    for candidate in node.inputs:
        if candidate.type == "SHADER":
            found = _background(reader, candidate, above, depth + 1)
            if found[0]:
                return found
    return None, ()


def _environment(reader, socket, stack):
    """(Environment Texture node, stack, colour factor) of a colour input; no node where the input
    is a colour."""
    node, _, above = reader.source(socket, stack)
    if node is not None and node.type == "TEX_ENVIRONMENT":
        return node, above, nodes.WHITE
    if node is not None and node.type == "TEX_SKY":
        reader.unsupported(node, "a plain sky colour is used")
        return None, above, (0.30, 0.48, 0.80)
    return None, above, reader.color(socket, stack).color


def rotation(reader, socket, stack):
    """3x3 matrix from world directions to the image's."""
    node, origin, above = reader.source(socket, stack)
    if node is None or (node.type == "TEX_COORD" and origin.name == "Generated"):
        return Matrix.Identity(3)
    if node.type != "MAPPING":
        reader.unsupported(node, "the world is not turned")
        return Matrix.Identity(3)
    inner = rotation(reader, node.inputs["Vector"], above)
    turn = Matrix.Identity(3)
    for axis, angle in zip("XYZ", node.inputs["Rotation"].default_value):
        turn = Matrix.Rotation(angle, 3, axis) @ turn
    if node.vector_type == "TEXTURE":
        turn = turn.transposed()
    scale = node.inputs.get("Scale")
    if scale is not None and any(not math.isclose(s, 1.0) for s in scale.default_value):
        reader.unsupported(node, "only its rotation is used")
    return turn @ inner


def _image_world(export, node, stack, reader, factor, item):
    """Fill `item` from an Environment Texture; returns the ambient light."""
    if node.projection != "EQUIRECTANGULAR":
        reader.unsupported(node, "its image is taken as equirectangular")
    item.kind = capi.WORLD_EQUIRECTANGULAR
    item.color[:] = factor
    texture = nodes.Texture(node.image, node.interpolation == "Closest", capi.EXTENSION_REPEAT)
    item.textures[0] = sync_texture(export, texture)
    turn = rotation(reader, node.inputs["Vector"], stack)
    item.map_from_world[:] = [value for column in turn.col for value in column]
    mean = cached_mean(export, texture, mean_radiance)
    return tuple(f * c for f, c in zip(factor, mean))


def _fill(export, world, item):
    if not compat.uses_nodes(world):
        item.color[:] = world.color
        return tuple(world.color)
    output = nodes.output_node(world.node_tree, "OUTPUT_WORLD")
    if output is None:
        return nodes.BLACK
    reader = nodes.Reader(f"World '{world.name}'", export.warn)
    background, stack = _background(reader, output.inputs["Surface"])
    if background is None:
        return nodes.BLACK
    strength = max(reader.number(background.inputs["Strength"], stack), 0.0)
    node, above, color = _environment(reader, background.inputs["Color"], stack)
    factor = tuple(max(c, 0.0) * strength for c in color)
    if node is not None and node.image is not None:
        return _image_world(export, node, above, reader, factor, item)
    item.color[:] = nodes.BLACK if node is not None else factor
    return tuple(item.color)


def sync_world(export, world):
    """Send the world; returns the ambient light that it gives, linear RGB radiance."""
    item = capi.World()
    item.kind = capi.WORLD_COLOR
    item.map_from_world[:] = (1, 0, 0, 0, 1, 0, 0, 0, 1)
    ambient = nodes.BLACK if world is None else _fill(export, world, item)
    if world is not None:
        mist = world.mist_settings
        item.mist_start, item.mist_depth = mist.start, mist.depth
        item.mist_falloff = MIST_FALLOFF[mist.falloff]
    export.note("world", bytes(item))
    export.scene.set_world(item)
    return ambient
