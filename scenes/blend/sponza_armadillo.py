# SPDX-License-Identifier: GPL-3.0-or-later
"""Sponza Armadillo: the paper's second test scene, Sponza with a glass armadillo statue.

    blender -b --factory-startup --python scenes/blend/sponza_armadillo.py -- --out FILE.blend

Counts follow the paper's Table 4: 25 objects (Sponza joined into 3, a pedestal, the armadillo and
20 glass spheres), none reflective, 21 refractive. Table 4's 292,544 triangles are read as those of
the whole scene: 262,087 of Sponza, 12 of the pedestal, 20 spheres of 360, and the armadillo
collapsed to the 23,245 that remain. `--full` keeps the armadillo's own
292,544 triangles (561,843 in all). Needs the scene data's `sponza` and `stanford` folders; a
stand-in hall and a lumpy ball replace what is missing, and a line on stdout says so. Writes
FILE.blend.
"""

import math
import os
import random
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import bpy
import common
import shading
import sponza_hall
from sponza_hall import FLOOR_Z, NAVE_Y

ARMADILLO_FILE = "stanford/armadillo_292k_derived.ply"
SCENE_TRIANGLES = 292_544
STATUE_X, STATUE_HEIGHT, PEDESTAL_HEIGHT = 5.2, 2.6, 0.5  # metres
TINTS = [(1.0, 1.0, 1.0), (0.70, 0.92, 1.0), (1.0, 0.80, 0.62), (0.78, 1.0, 0.76)]


def add_arguments(parser):
    parser.add_argument("--full", action="store_true",
                        help="keep the armadillo's 292,544 triangles")


def import_armadillo(path):
    """The statue, upright, facing +X, standing on the pedestal."""
    before = set(bpy.data.objects)
    if "ply_import" in dir(bpy.ops.wm):
        bpy.ops.wm.ply_import(filepath=str(path))
    else:
        bpy.ops.import_mesh.ply(filepath=str(path))
    statue = next(obj for obj in bpy.data.objects if obj not in before)
    statue.name = statue.data.name = "Armadillo"
    statue.rotation_mode = "XYZ"
    statue.rotation_euler = (0.0, 0.0, math.radians(90.0))
    return statue


def lumpy_ball():
    def point(u, v):
        around, up = 2 * math.pi * u, math.pi * (v - 0.5)
        radius = 1.0 + 0.15 * math.sin(7 * around) * math.cos(up) ** 2 * math.sin(9 * up)
        return (radius * math.cos(around) * math.cos(up),
                radius * math.sin(around) * math.cos(up), radius * math.sin(up))
    return common.add_grid("Armadillo", point, 146, 80, None)


def place_statue(statue):
    """Scale the statue to its height and stand it on the pedestal, transform applied."""
    matrix = statue.matrix_basis.copy()
    statue.data.transform(matrix)
    statue.matrix_basis.identity()
    lows = [min(v.co[axis] for v in statue.data.vertices) for axis in range(3)]
    highs = [max(v.co[axis] for v in statue.data.vertices) for axis in range(3)]
    scale = STATUE_HEIGHT / (highs[2] - lows[2])
    target = (STATUE_X, NAVE_Y, FLOOR_Z + PEDESTAL_HEIGHT)
    for vertex in statue.data.vertices:
        middle = ((lows[0] + highs[0]) / 2, (lows[1] + highs[1]) / 2, lows[2])
        vertex.co = [(vertex.co[a] - middle[a]) * scale + target[a] for a in range(3)]
    statue.data.polygons.foreach_set("use_smooth", [True] * len(statue.data.polygons))


def add_statue(full):
    path = common.find_data(ARMADILLO_FILE)
    if path is None:
        print("building a lumpy ball instead of the armadillo", flush=True)
    statue = import_armadillo(path) if path else lumpy_ball()
    place_statue(statue)
    statue.data.materials.clear()
    statue.data.materials.append(shading.glass("ArmadilloGlass", (0.86, 0.96, 0.90), 1.5))
    others = [obj for obj in bpy.context.scene.objects if obj.type == "MESH" and obj != statue]
    if not full:
        common.decimate([statue], SCENE_TRIANGLES - sum(map(common.count_triangles, others)))
        statue.data.polygons.foreach_set("use_smooth", [True] * len(statue.data.polygons))


def add_spheres():
    """20 glass spheres of 360 triangles in two loose rows beside the statue, explicit seed."""
    draw = random.Random(21)
    for index in range(20):
        side = -1 if index % 2 else 1
        radius = draw.uniform(0.28, 0.62)
        x = 8.0 - 0.95 * index + draw.uniform(-0.25, 0.25)
        height = radius if index % 3 else draw.uniform(1.2, 2.8)
        y = NAVE_Y + side * draw.uniform(1.35, 2.1)
        name = f"Glass{index + 1:02}"
        material = shading.glass(name, TINTS[index % len(TINTS)], round(draw.uniform(1.3, 1.6), 2))
        common.add_sphere(name, (x, y, FLOOR_Z + height), radius, material, 20, 10)


def main():
    args = common.parse_args(__doc__, add_arguments)
    common.clear_scene()
    sponza_hall.build_hall()
    common.add_box("Pedestal", (STATUE_X, NAVE_Y, FLOOR_Z + PEDESTAL_HEIGHT / 2),
                   (1.6, 1.6, PEDESTAL_HEIGHT), shading.diffuse("Marble", (0.62, 0.60, 0.57)))
    add_spheres()
    add_statue(args.full)
    sponza_hall.add_hall_lights()
    common.add_camera((11.4, NAVE_Y - 0.9, FLOOR_Z + 1.9),
                      (2.0, NAVE_Y + 0.1, FLOOR_Z + 1.75), 32.0)
    common.finish("sponza_armadillo", args)


main()
