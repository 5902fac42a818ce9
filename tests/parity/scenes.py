# SPDX-License-Identifier: GPL-3.0-or-later
"""Builders of the parity cases listed in `cases.py`; runs inside Blender, needs no outside data.

Each builder fills an empty scene. Surfaces are Diffuse BSDF (Lambert) unless the case is about
something else, balls are smooth and finely divided, lights are hard, and the world is black unless
it is the case itself, so that Cycles without diffuse bounces has one exact answer. Lengths in
metres, Z up, light energies in W (suns W/m2).
"""

import math
import sys
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scenes" / "blend"))
import common
import shading

SIZE_PX = (400, 225)
BALL = (256, 128)  # segments, rings
BLACK = (0.0, 0.0, 0.0)
BOXES = {  # colour, location, size, turn in degrees
    "Red": ((0.75, 0.08, 0.06), (-1.9, 1.2, 0.7), (0.9, 0.9, 1.4), 20),
    "Green": ((0.10, 0.55, 0.14), (1.9, 1.5, 0.5), (0.8, 0.8, 1.0), -25),
    "Blue": ((0.08, 0.18, 0.70), (1.6, -1.0, 0.3), (0.6, 0.6, 0.6), 35),
    "Yellow": ((0.80, 0.62, 0.08), (-1.5, -1.1, 0.25), (0.5, 0.5, 0.5), 10),
}


# ---- shared pieces ---------------------------------------------------------------------------

def checker_floor(size=10.0, squares=10):
    """Chequered floor of two matte materials (no image), one quad a square."""
    floor = common.add_grid("Floor", lambda u, v: ((u - 0.5) * size, (v - 0.5) * size, 0.0),
                            squares, squares, None, smooth=False)
    floor.data.materials.append(shading.diffuse("Light", (0.75, 0.72, 0.66)))
    floor.data.materials.append(shading.diffuse("Dark", (0.22, 0.26, 0.32)))
    for polygon in floor.data.polygons:
        polygon.material_index = (polygon.index // squares + polygon.index) % 2
    return floor


def plain_floor(size=10.0):
    return common.add_plane("Floor", (0, 0, 0), (size, size), shading.diffuse("Floor"))


def coloured_boxes(collection=None):
    boxes = []
    for name, (color, location, size, turn) in BOXES.items():
        box = common.add_box(name, location, size, shading.diffuse(name, color), turn)
        if collection:
            bpy.context.scene.collection.objects.unlink(box)
            collection.objects.link(box)
        boxes.append(box)
    return boxes


def matte_ball(location, radius, color=(0.7, 0.7, 0.7)):
    return common.add_sphere("MatteBall", location, radius, shading.diffuse("Matte", color), *BALL)


def sun():
    common.add_sun("Sun", (0.55, 0.65, -1.0), 3.2)


def camera(location=(0.0, -6.0, 2.6), target=(0.0, 0.0, 0.6), lens_mm=38.0):
    common.set_world(BLACK, 0.0)
    return common.add_camera(location, target, lens_mm)


def test_image():
    """64 x 64 picture with an up, a right and four different corners; values as stored (sRGB)."""
    def texel(u, v):
        if min(u, v, 1 - u, 1 - v) < 0.06:
            return (0.15, 0.15, 0.18, 1.0)
        if 0.40 < u < 0.60 and v > 0.25:
            return (0.90, 0.30, 0.15, 1.0)
        if abs(u - 0.5) < 0.95 - v and v > 0.68:
            return (0.95, 0.85, 0.25, 1.0)
        stripe = int(v * 8) % 2 if u > 0.5 else int((u + v) * 8) % 2
        return (0.25 + 0.6 * u, 0.80 if stripe else 0.45, 0.25 + 0.6 * v, 1.0)
    return shading.image_from_function("TestImage", 64, 64, texel)


# ---- mirrors and glass -----------------------------------------------------------------------

def mirror_ball():
    checker_floor()
    coloured_boxes()
    common.add_sphere("MirrorBall", (0, 0.2, 0.95), 0.95, shading.mirror("Mirror"), *BALL)
    sun()
    camera()


def facing_mirrors():
    """Upright mirrors at y = 2 and y = -2; the camera stands before the near one."""
    checker_floor()
    silver = shading.mirror("Mirror", (0.9, 0.9, 0.9))
    for name, y, turn in (("Far", 2.0, 90.0), ("Near", -2.0, -90.0)):
        mirror = common.add_plane(name, (0, y, 1.2), (5.0, 2.2), silver)
        mirror.rotation_euler = (math.radians(turn), 0, 0)
    coloured_boxes()
    matte_ball((0.1, 0.3, 0.5), 0.5, (0.75, 0.45, 0.65))
    common.add_sun("Sun", (0.35, 0.20, -1.0), 3.2)
    camera((-0.5, -1.9, 1.7), (0.25, 2.0, 0.75), 24.0)


def glass_ball():
    checker_floor()
    coloured_boxes()
    common.add_sphere("GlassBall", (0, -0.6, 1.0), 0.9, shading.glass("Glass", ior=1.45), *BALL)
    common.add_box("BackWall", (0, 4.0, 1.5), (10.0, 0.2, 3.0),
                   shading.diffuse("Wall", (0.55, 0.40, 0.30)))
    sun()
    camera((0.0, -6.0, 1.9), (0.0, 0.0, 0.9))


# ---- shadows ---------------------------------------------------------------------------------

def sun_shadow():
    plain_floor()
    coloured_boxes()
    matte_ball((0.1, 0.3, 1.0), 0.6)
    sun()
    camera()


def point_shadow():
    plain_floor()
    coloured_boxes()
    matte_ball((0.1, 0.3, 0.7), 0.5)
    common.add_point("Point", (-0.3, -1.3, 2.4), 260.0, (1.0, 0.9, 0.75))
    camera()


def spot_shadow():
    """Left spot: sharp rim (blend 0); right spot: soft rim (blend 0.3)."""
    plain_floor()
    coloured_boxes()
    matte_ball((0.0, 0.6, 0.5), 0.5)
    common.add_spot("SharpRim", (-2.6, -1.8, 3.2), (-1.2, 0.2, 0.0), 700.0, 50.0, 0.0,
                    (1.0, 0.85, 0.7))
    common.add_spot("SoftRim", (2.6, -1.8, 3.2), (1.2, 0.2, 0.0), 700.0, 54.0, 0.3,
                    (0.7, 0.85, 1.0))
    camera()


# ---- textures --------------------------------------------------------------------------------

def textured_plane():
    common.add_plane("Textured", (0, 0, 0), (4.4, 4.4), shading.diffuse("Image", image=test_image()))
    common.add_box("TexturedBox", (1.0, 0.7, 0.5), (1.0, 1.0, 1.0),
                   shading.diffuse("BoxImage", image=bpy.data.images["TestImage"]), 25)
    sun()
    camera((0.0, -4.6, 3.0), (0.0, 0.1, 0.1))


def texture_mapping():
    """Mapping node of type Point: location (0.2, 0.1), turned 30 degrees, scale (2, 3)."""
    material = shading.diffuse("Mapped", image=test_image())
    nodes, links = material.node_tree.nodes, material.node_tree.links
    mapping, coordinates = nodes.new("ShaderNodeMapping"), nodes.new("ShaderNodeTexCoord")
    mapping.inputs["Location"].default_value = (0.2, 0.1, 0.0)
    mapping.inputs["Rotation"].default_value = (0.0, 0.0, math.radians(30.0))
    mapping.inputs["Scale"].default_value = (2.0, 3.0, 1.0)
    image = next(node for node in nodes if node.type == "TEX_IMAGE")
    links.new(coordinates.outputs["UV"], mapping.inputs["Vector"])
    links.new(mapping.outputs["Vector"], image.inputs["Vector"])
    common.add_plane("Mapped", (0, 0, 0), (4.4, 4.4), material)
    sun()
    camera((0.0, -4.6, 3.0), (0.0, 0.1, 0.1))


def normal_map():
    """Waves in a tangent-space map; without the map both surfaces would be evenly lit."""
    def texel(u, v):
        nx, ny = 0.45 * math.cos(8 * math.pi * u), 0.35 * math.cos(6 * math.pi * v)
        length = math.sqrt(nx * nx + ny * ny + 1.0)
        return (0.5 + 0.5 * nx / length, 0.5 + 0.5 * ny / length, 0.5 + 0.5 / length, 1.0)
    image = shading.image_from_function("Waves", 128, 128, texel, non_color=True)
    material, nodes, links, output = shading.new_material("Waves")
    shader, normal = nodes.new("ShaderNodeBsdfDiffuse"), nodes.new("ShaderNodeNormalMap")
    links.new(shading.image_node(nodes, image).outputs["Color"], normal.inputs["Color"])
    links.new(normal.outputs["Normal"], shader.inputs["Normal"])
    links.new(shader.outputs["BSDF"], output.inputs["Surface"])
    common.add_plane("WavyFloor", (0, 0, 0), (5.0, 5.0), material)

    def cylinder(u, v):
        angle = 2 * math.pi * u
        return (0.7 * math.cos(angle), 0.7 * math.sin(angle) + 0.6, 0.1 + 3.4 * v)
    common.add_grid("WavyCylinder", cylinder, 256, 8, material)
    sun()
    camera()


def alpha_leaf():
    """Left card: Mix of Transparent and Diffuse BSDF by alpha; right card: Principled alpha."""
    def texel(u, v):
        inside = abs(u - 0.5) < 0.42 * math.sin(math.pi * v) or abs(u - 0.5) < 0.03
        return (0.25 + 0.3 * v, 0.65, 0.20, 1.0 if inside else 0.0)
    image = shading.image_from_function("Leaf", 512, 512, texel)
    mixed, nodes, links, output = shading.new_material("MixLeaf")
    texture, mix = shading.image_node(nodes, image), nodes.new("ShaderNodeMixShader")
    shader, clear = nodes.new("ShaderNodeBsdfDiffuse"), nodes.new("ShaderNodeBsdfTransparent")
    links.new(texture.outputs["Color"], shader.inputs["Color"])
    links.new(texture.outputs["Alpha"], mix.inputs["Fac"])
    links.new(clear.outputs["BSDF"], mix.inputs[1])
    links.new(shader.outputs["BSDF"], mix.inputs[2])
    links.new(mix.outputs["Shader"], output.inputs["Surface"])
    shading.use_alpha_clip(mixed)
    # Roughness 0.5 keeps Blender 3's Principled diffuse close to Lambert.
    principled = shading.principled("PrincipledLeaf", roughness=0.5, image=image, alpha=True)
    for name, x, material in (("MixLeaf", -1.1, mixed), ("PrincipledLeaf", 1.1, principled)):
        card = common.add_plane(name, (x, 0.2, 1.1), (1.6, 1.8), material)
        card.rotation_euler = (math.radians(80), 0, 0)
    plain_floor()
    common.add_sun("Sun", (0.25, 0.75, -0.75), 3.2)
    camera()


# ---- cameras, instances, environment ---------------------------------------------------------

def ortho_shift():
    sun_shadow()
    data = bpy.context.scene.camera.data
    data.type, data.ortho_scale = "ORTHO", 5.6
    data.shift_x, data.shift_y = 0.12, -0.08


def persp_shift():
    sun_shadow()
    data = bpy.context.scene.camera.data
    data.shift_x, data.shift_y = -0.15, 0.10


def instances():
    """A hidden collection of boxes, drawn by five empties; one empty draws two of them nested."""
    inner, outer = bpy.data.collections.new("Inner"), bpy.data.collections.new("Outer")
    coloured_boxes(inner)

    def instance(name, collection, location, turn_deg, scale, parent_collection=None):
        empty = common.link(bpy.data.objects.new(name, None), parent_collection)
        empty.instance_type, empty.instance_collection = "COLLECTION", collection
        empty.location, empty.scale = location, scale
        empty.rotation_euler = (0.0, 0.0, math.radians(turn_deg))

    instance("Nested1", inner, (-0.9, 0.0, 0.0), 0, (0.4, 0.4, 0.4), outer)
    instance("Nested2", inner, (0.9, 0.2, 0.0), 60, (0.35, 0.35, 0.8), outer)
    instance("Pair", outer, (0.0, -1.2, 0.0), 5, (1.0, 1.0, 1.0))
    instance("Left", inner, (-2.2, 1.6, 0.0), 30, (0.6, 0.6, 0.6))
    instance("Right", inner, (2.2, 1.6, 0.0), -75, (0.6, 0.4, 1.1))
    instance("Mirrored", inner, (0.0, 1.9, 0.0), 0, (-0.5, 0.5, 0.5))
    plain_floor()
    sun()
    camera()


def environment():
    """Sky with a coloured mark on every side, so that no turn or flip goes unseen."""
    marks = [(0.50, 0.55, 0.06, (3.0, 0.4, 0.3)), (0.75, 0.60, 0.05, (0.3, 2.5, 0.4)),
             (0.25, 0.60, 0.05, (0.3, 0.5, 3.0)), (0.04, 0.55, 0.03, (2.5, 2.3, 0.4)),
             (0.62, 0.75, 0.04, (2.0, 0.4, 2.2)), (0.42, 0.40, 0.03, (0.3, 2.2, 2.2))]

    def texel(u, v):
        sky = (0.9 - 0.7 * (v - 0.5) * 2, 0.95 - 0.5 * (v - 0.5) * 2, 1.0)
        color = sky if v > 0.5 else (0.28 * v + 0.05, 0.22 * v + 0.05, 0.15 * v + 0.03)
        for x, y, radius, mark in marks:
            distance = math.hypot((u - x) * 2, v - y)
            share = min(1.0, max(0.0, (radius - distance) / 0.02))  # five texels of soft rim
            color = tuple(c + share * (m - c) for c, m in zip(color, mark))
        return (*color, 1.0)
    image = shading.image_from_function("Sky", 512, 256, texel, is_float=True)
    silver = shading.mirror("Mirror")
    common.add_sphere("MirrorBall", (-0.9, 0.0, 1.0), 1.0, silver, *BALL)
    common.add_box("MirrorBox", (1.3, 0.2, 0.7), (1.2, 1.2, 1.4), silver, 30)
    camera((0.0, -5.0, 1.4), (0.0, 0.0, 1.1), 28.0)
    common.set_world((1.0, 1.0, 1.0), 0.8, image)


# ---- one case --------------------------------------------------------------------------------

def build(case):
    """Fill the open file with a case, ready to render by Cycles or Kestrel."""
    scene = common.clear_scene()
    globals()[case.name]()
    common.set_render_settings(SIZE_PX)
    common.set_cycles(scene.cycles, case.samples)
    scene.render.film_transparent = False
    set_kestrel(scene)
    return scene


def set_kestrel(scene):
    """Kestrel's settings for comparisons with Cycles, where the add-on is enabled."""
    if hasattr(scene, "kestrel"):
        wanted = {"pixel_filter": "box", "filter_width": 1.0, "max_depth": 10, "samples": 64}
        for name, value in wanted.items():
            if hasattr(scene.kestrel, name):
                setattr(scene.kestrel, name, value)
