# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes of Blender's Vector menu, and displacement."""

import bpy

from .curves import curves


def mapping(site):
    return site.b.op("mapping", site.value("Vector"), site.value("Location"),
                     site.value("Rotation"), site.value("Scale", default=1.0),
                     modes=(site.node.vector_type,))


def vector_rotate(site):
    return site.b.op("vector_rotate", site.value("Vector"), site.value("Center"),
                     site.value("Axis", default=0.0), site.value("Angle", default=0.0),
                     site.value("Rotation", default=0.0),
                     modes=(site.node.rotation_type, "YES" if site.node.invert else "NO"))


def vector_transform(site):
    """Before Blender 4 Cycles moves normals as vectors, but for their length."""
    node, b = site.node, site.b
    old_normal = node.vector_type == "NORMAL" and bpy.app.version < (4, 0)
    moved = b.op("vector_transform", site.value("Vector"),
                 modes=("VECTOR" if old_normal else node.vector_type, node.convert_from,
                        node.convert_to))
    return b.vector_math("NORMALIZE", moved) if old_normal else moved


def normal(site):
    """A direction that the node holds, or how far an input faces it."""
    b = site.b
    direction = b.vector_math("NORMALIZE", site.c.own_value(site.node.outputs["Normal"]))
    if site.output.name == "Normal":
        return direction
    return b.vector_math("DOT_PRODUCT", direction, b.vector_math("NORMALIZE",
                                                                 site.value("Normal")))


def normal_map(site):
    node = site.node
    if node.space == "TANGENT":
        site.c.use_tangent_map(site, node.uv_map)
    return site.b.op("normal_map", site.value("Color"), site.value("Strength"),
                     modes=(node.space,))


def bump(site):
    base = site.normal()
    socket = site.socket("Height")
    if not site.is_linked("Height"):
        return base
    return site.c.bumped(socket, site.stack, base, site.value("Strength"), site.value("Distance"),
                         site.node.invert)


def vector_curves(site):
    vector = site.value("Vector")
    return site.b.mix(site.value("Fac", "Factor"), vector,
                      curves(site, vector, site.node.mapping, (0, 1, 2)))


def displacement(site):
    """Where a vector is wanted: along the normal."""
    b = site.b
    height = b.multiply(b.subtract(site.value("Height"), site.value("Midlevel")),
                        site.value("Scale"))
    return b.multiply(height, site.normal())


def vector_displacement(site):
    site.note("it displaces nothing")
    return site.b.constant(0.0)


def displace(compiler, output, material):
    """Let the surface's normals follow what is linked to the output's Displacement."""
    node, _, stack = compiler.source(output.inputs["Displacement"], ())
    if node is None:
        return
    if node.type != "DISPLACEMENT":
        compiler.reader.note(node, stack, "the surface is not displaced")
        return
    method = getattr(material, "displacement_method", None) or getattr(
        getattr(material, "cycles", None), "displacement_method", "BUMP")
    if method != "BUMP":
        compiler.reader.note(node, stack, "the surface is bumped instead of displaced")
    scale = compiler.value(node.inputs["Scale"], stack)
    compiler.shading_normal = compiler.bumped(node.inputs["Height"], stack,
                                              compiler.shading_normal, 1.0, scale)


VALUES = {
    "MAPPING": mapping,
    "VECTOR_ROTATE": vector_rotate,
    "VECT_TRANSFORM": vector_transform,
    "NORMAL": normal,
    "NORMAL_MAP": normal_map,
    "BUMP": bump,
    "CURVE_VEC": vector_curves,
    "DISPLACEMENT": displacement,
    "VECTOR_DISPLACEMENT": vector_displacement,
}
