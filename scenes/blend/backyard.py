# SPDX-License-Identifier: GPL-3.0-or-later
"""Backyard: the paper's fourth test scene, trees with alpha-masked leaves and detailed shadows.

    blender -b --factory-startup --python scenes/blend/backyard.py -- --out FILE.blend

Opens the scene data's `backyard/backyard.blend` and adds a mirror ball and two glass balls. Counts
follow the paper's Table 4: 48 objects (each tree's trunk and leaves joined: 12; each kind of grass,
flower, clover and bush joined: 17; 10 hedges; house, roof, windows, ground, terrace, water; the
three balls), 1 reflective, 2 refractive, 1.13 M triangles. `--instances` keeps the file's own
1,471 mesh objects, which share 32 meshes. Stacked foliage needs 64 transparent bounces in Cycles
(set). Exits with status 2 where the file is missing. Writes FILE.blend.
"""

import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import bpy
import common
import shading

SCENE_FILE = "backyard/backyard.blend"
SUN_ENERGY = 9.0  # W/m2
ENVIRONMENT_STRENGTH = 1.1
PAINT = {"house": (0.40, 0.35, 0.29), "window": (0.08, 0.11, 0.16)}  # less bright than the file's
TREES = ("aspen", "birch", "maple")
PLANTS = ("bush", "clover", "flowers", "grass")


def add_arguments(parser):
    parser.add_argument("--instances", action="store_true", help="keep the plants separate")


def open_file(path):
    bpy.ops.wm.open_mainfile(filepath=str(path), load_ui=False)
    for image in bpy.data.images:
        image.filepath = bpy.path.abspath(image.filepath)


def group_name(obj):
    """Name of the joined object that a mesh object goes into, or None to keep it as it is."""
    mesh = obj.data.name
    if mesh.startswith(TREES):
        return f"{mesh.split('_')[0]} {obj.location.x:.3f} {obj.location.y:.3f}"
    if mesh.startswith(PLANTS):
        return mesh
    return "windows" if mesh.startswith("window") else None


def join_plants():
    groups = {}
    for obj in bpy.context.scene.objects:
        if obj.type == "MESH" and group_name(obj):
            groups.setdefault(group_name(obj), []).append(obj)
    counts = dict.fromkeys(TREES, 0)
    for name, objects in sorted(groups.items()):
        tree = name.split()[0]
        if tree in counts:
            counts[tree] += 1
            name = f"{tree}_{counts[tree]}"
        common.join(name, objects)


def add_balls():
    common.add_sphere("GazingBall", (-2.6, -7.4, 0.75), 0.75, shading.mirror("Mirror"), 64, 32)
    common.add_sphere("GlassBall1", (-4.9, -9.2, 0.55), 0.5,
                      shading.glass("Glass1", ior=1.5), 64, 32)
    common.add_sphere("GlassBall2", (-1.2, -9.6, 0.45), 0.4,
                      shading.glass("Glass2", (0.75, 0.93, 1.0), 1.33), 64, 32)


def paint():
    for material in bpy.data.materials:
        for prefix, color in PAINT.items():
            if material.name.startswith(prefix):
                shader = next(n for n in material.node_tree.nodes if n.type == "BSDF_PRINCIPLED")
                shader.inputs["Base Color"].default_value = (*color, 1.0)


def set_sky():
    """Keep the file's sky image, at a strength that leaves the sun's shadows clear."""
    for node in bpy.context.scene.world.node_tree.nodes:
        if node.type == "BACKGROUND":
            node.inputs["Strength"].default_value = ENVIRONMENT_STRENGTH


def main():
    args = common.parse_args(__doc__, add_arguments)
    open_file(common.require_data(SCENE_FILE))
    shading.make_all_matte()
    paint()
    if not args.instances:
        join_plants()
    add_balls()
    for light in bpy.data.lights:
        if light.type == "SUN":
            light.angle, light.energy = 0.0, SUN_ENERGY
    set_sky()
    common.finish("backyard", args)


main()
