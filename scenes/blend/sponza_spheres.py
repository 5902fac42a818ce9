# SPDX-License-Identifier: GPL-3.0-or-later
"""Sponza Spheres: the paper's first test scene, Sponza with 3 mirror and 23 glass spheres.

    blender -b --factory-startup --python scenes/blend/sponza_spheres.py -- --out FILE.blend

Counts follow the paper's Table 4: 29 objects (Sponza joined into 3, and 26 spheres), 3 reflective,
23 refractive, 272,127 triangles (262,087 + 17 * 400 + 9 * 360; the paper has 272,144). `--fine`
gives every sphere 128 x 64 faces instead, for pictures without visible facets. Needs the scene
data's `sponza` folder, else a stand-in hall of the same counts is built. Writes FILE.blend.
"""

import os
import random
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import common
import shading
import sponza_hall
from sponza_hall import FLOOR_Z, NAVE_Y

# x, offset from the nave's middle, height of the centre above the floor, radius; metres
MIRRORS = [(5.0, 1.55, 0.85, 0.85), (3.4, -1.45, 1.75, 0.65), (-5.5, 0.3, 1.3, 1.1)]
GLASSES = [
    (7.9, -0.95, 0.50, 0.50), (8.3, 0.85, 0.34, 0.34), (7.0, 0.05, 1.25, 0.32),
    (6.9, 2.05, 2.20, 0.34), (6.4, -2.05, 1.10, 0.36), (5.2, -0.55, 0.58, 0.58),
    (4.3, 0.55, 2.75, 0.45), (3.0, 0.60, 0.48, 0.48), (2.2, -2.0, 0.55, 0.55),
    (1.6, -0.65, 0.40, 0.40), (1.2, 1.85, 1.90, 0.60), (0.2, -0.60, 2.50, 0.60),
    (-0.9, -1.9, 0.80, 0.60), (-1.5, 1.60, 0.65, 0.65), (-2.4, 0.9, 3.60, 0.60),
    (-3.2, -1.7, 1.80, 0.60), (-4.3, 2.1, 2.00, 0.55), (-3.6, -0.3, 0.45, 0.45),
    (-6.6, -1.9, 3.10, 0.65), (-8.3, -1.4, 0.80, 0.80), (-9.5, 1.5, 3.40, 0.75),
    (-11.0, -0.2, 4.40, 0.80), (-12.0, 1.4, 0.90, 0.90),
]
TINTS = [(1.0, 1.0, 1.0), (1.0, 1.0, 1.0), (1.0, 0.72, 0.60), (0.65, 0.90, 1.0),
         (0.75, 1.0, 0.72), (1.0, 0.92, 0.60)]
COARSE, MEDIUM, FINE = (20, 10), (20, 11), (128, 64)  # segments, rings


def add_arguments(parser):
    parser.add_argument("--fine", action="store_true", help="smoother spheres than the paper's")


def add_spheres(fine):
    """3 mirrors and 23 glasses; indices of refraction 1.3 to 1.6, from an explicit seed."""
    draw = random.Random(20)
    spheres = [(*place, True) for place in MIRRORS] + [(*place, False) for place in GLASSES]
    by_size = sorted(spheres, key=lambda sphere: -sphere[3])
    medium = {sphere[:3] for sphere in by_size[:17]}
    silver = shading.mirror("Mirror")
    for index, (x, y, z, radius, is_mirror) in enumerate(spheres):
        segments, rings = FINE if fine else MEDIUM if (x, y, z) in medium else COARSE
        name = f"Mirror{index + 1}" if is_mirror else f"Glass{index - len(MIRRORS) + 1:02}"
        material = silver if is_mirror else shading.glass(
            name, TINTS[index % len(TINTS)], round(draw.uniform(1.3, 1.6), 2))
        common.add_sphere(name, (x, NAVE_Y + y, FLOOR_Z + z), radius, material, segments, rings)


def main():
    args = common.parse_args(__doc__, add_arguments)
    common.clear_scene()
    sponza_hall.build_hall()
    add_spheres(args.fine)
    sponza_hall.add_hall_lights()
    common.add_camera((12.2, NAVE_Y - 0.6, FLOOR_Z + 2.7), (0.0, NAVE_Y + 0.1, FLOOR_Z + 1.7), 30.0)
    common.finish("sponza_spheres", args)


main()
