# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes of Blender's Input menu."""

GEOMETRY = {"Position": "POSITION", "True Normal": "TRUE_NORMAL", "Incoming": "INCOMING",
            "Parametric": "PARAMETRIC", "Backfacing": "BACKFACING"}
COORDINATES = {"Generated": "GENERATED", "Camera": "CAMERA", "Window": "WINDOW",
               "Normal": "OBJECT_NORMAL"}
OBJECT = {"Location": "OBJECT_LOCATION", "Object Index": "OBJECT_INDEX",
          "Material Index": "MATERIAL_INDEX", "Random": "OBJECT_RANDOM"}
LIGHT_PATH = {"Is Camera Ray": "IS_CAMERA", "Is Shadow Ray": "IS_SHADOW",
              "Is Glossy Ray": "IS_REFLECTION", "Is Reflection Ray": "IS_REFLECTION",
              "Is Transmission Ray": "IS_TRANSMISSION", "Ray Length": "RAY_LENGTH",
              "Ray Depth": "RAY_DEPTH"}
CAMERA = {"View Vector": "VIEW_VECTOR", "View Z Depth": "VIEW_DEPTH",
          "View Distance": "VIEW_DISTANCE"}


def zero(site):
    return site.b.constant(0.0)


def own_output(site):
    """A Value or RGB node's."""
    return site.c.own_value(site.node.outputs[0])


def matrix_times(b, matrix, point):
    """A point by a constant 4 x 4 matrix."""
    rows = [b.vector_math("DOT_PRODUCT", point, b.constant(*row[:3])) for row in matrix[:3]]
    return b.add(b.combine(*rows), b.constant(*(row[3] for row in matrix[:3])))


def texture_coordinate(site):
    name = site.output.name
    if site.node.from_instancer and name in ("Generated", "UV"):
        site.note("it gives the instance's own coordinates")
    if name == "UV":
        return site.uv()
    if name == "Object":
        if site.node.object is None:
            return site.c.input("OBJECT")
        matrix = site.node.object.matrix_world.inverted_safe()
        return matrix_times(site.b, matrix, site.c.input("POSITION"))
    if name == "Reflection":
        return reflection(site)
    return site.c.input(COORDINATES[name])


def reflection(site):
    incoming = site.b.multiply(site.c.input("INCOMING"), site.b.constant(-1.0))
    return site.b.vector_math("REFLECT", incoming, site.c.shading_normal)


def uv_map(site):
    if site.node.from_instancer:
        site.note("it gives the instance's own coordinates")
    return site.c.attribute("uv", site.node.uv_map)


def attribute(site):
    node = site.node
    if node.attribute_type != "GEOMETRY" or not node.attribute_name:
        site.note("it gives 0")
        return zero(site)
    if site.output.name == "Alpha":
        site.note("its alpha is 1")
        return site.b.constant(1.0)
    value = site.c.attribute("color", node.attribute_name)
    return value if site.output.name in ("Color", "Vector") else site.b.average(value)


def color_attribute(site):
    if site.output.name == "Alpha":
        site.note("its alpha is 1")
        return site.b.constant(1.0)
    return site.c.attribute("color", site.node.layer_name)


def radial_tangent(site, axis="Z"):
    """Around an axis of the object, in the surface."""
    b = site.b
    place = b.subtract(site.c.input("GENERATED"), 0.5)
    x, y, z = (b.component(place, which) for which in "XYZ")
    minus = [b.multiply(b.constant(-1.0), c) for c in (x, y, z)]
    around = {"X": (0.0, minus[2], y), "Y": (minus[2], 0.0, x), "Z": (minus[1], x, 0.0)}[axis]
    return in_surface(site, b.combine(*around))


def in_surface(site, vector):
    """The unit vector across the normal that is nearest to one in object space. It moves with the
    object as normals do, in Cycles too."""
    b, normal = site.b, site.c.input("NORMAL")
    vector = b.op("vector_transform", vector, modes=("NORMAL", "OBJECT", "WORLD"))
    side = b.vector_math("NORMALIZE", b.vector_math("CROSS_PRODUCT", vector, normal))
    return b.vector_math("CROSS_PRODUCT", normal, side)


def tangent(site):
    if site.node.direction_type == "RADIAL":
        return radial_tangent(site, site.node.axis)
    site.c.use_tangent_map(site, site.node.uv_map)
    along = site.b.op("vector_transform", site.c.input("TANGENT"),
                      modes=("VECTOR", "WORLD", "OBJECT"))
    return in_surface(site, along)


def geometry(site):
    name = site.output.name
    if name == "Normal":
        return site.c.shading_normal
    if name == "Tangent":
        return radial_tangent(site)
    if name in GEOMETRY:
        return site.c.input(GEOMETRY[name])
    site.note(f"'{name}' is {0.5 if name == 'Pointiness' else 0.0:g}")
    return site.b.constant(0.5 if name == "Pointiness" else 0.0)


def object_info(site):
    name = site.output.name
    if name in OBJECT:
        return site.c.input(OBJECT[name])
    site.note(f"'{name}' is white" if name == "Color" else f"'{name}' is 1")
    return site.b.constant(1.0)


def light_path(site):
    name = site.output.name
    if name in LIGHT_PATH:
        return site.c.input(LIGHT_PATH[name])
    if name == "Is Singular Ray":
        return site.b.math("ADD", site.c.input("IS_REFLECTION"), site.c.input("IS_TRANSMISSION"))
    if name != "Is Diffuse Ray":  # there are none
        site.note(f"'{name}' is 0")
    return zero(site)


def layer_weight(site):
    mode = "FRESNEL" if site.output.name == "Fresnel" else "FACING"
    return site.b.op("layer_weight", site.value("Blend"), site.normal(), modes=(mode,))


def fresnel(site):
    return site.b.op("fresnel", site.value("IOR"), site.normal())


def camera(site):
    return site.c.input(CAMERA[site.output.name])


def ambient_occlusion(site):
    site.note("nothing occludes")
    return site.value("Color") if site.output.name == "Color" else site.b.constant(1.0)


def bevel(site):
    site.note("edges are not rounded")
    return site.normal()


def wireframe(site):
    site.note("there are no wires")
    return zero(site)


def hair_info(site):
    if site.output.name != "Is Strand":
        site.note(f"'{site.output.name}' is 0")
    else:
        site.note("strands are taken for surfaces")
    return zero(site)


def nothing_known(site):
    site.note(f"'{site.output.name}' is 0")
    return zero(site)


VALUES = {
    "VALUE": own_output,
    "RGB": own_output,
    "TEX_COORD": texture_coordinate,
    "UVMAP": uv_map,
    "ATTRIBUTE": attribute,
    "VERTEX_COLOR": color_attribute,
    "TANGENT": tangent,
    "NEW_GEOMETRY": geometry,
    "OBJECT_INFO": object_info,
    "LIGHT_PATH": light_path,
    "LAYER_WEIGHT": layer_weight,
    "FRESNEL": fresnel,
    "CAMERA": camera,
    "AMBIENT_OCCLUSION": ambient_occlusion,
    "BEVEL": bevel,
    "WIREFRAME": wireframe,
    "HAIR_INFO": hair_info,
    "PARTICLE_INFO": nothing_known,
    "POINT_INFO": nothing_known,
    "VOLUME_INFO": nothing_known,
}
