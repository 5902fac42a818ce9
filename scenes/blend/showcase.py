# SPDX-License-Identifier: GPL-3.0-or-later
"""Showcase: a small scene of everything Kestrel draws, made without any outside data.

    blender -b --factory-startup --python scenes/blend/showcase.py -- --out FILE.blend

A checker floor, a mirror ball, a glass ball that shows the room upside down, a tinted glass cube,
coloured boxes, a crate with a generated image, a normal-mapped pillar, a leaf screen with binary
alpha, and a sun, a point light and two spots with hard shadows. 1280x720, images packed. Writes
FILE.blend.
"""

import math
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import common
import shading

FLOOR_SIZE = 16.0  # metres
SQUARES = 16


# ---- generated images ------------------------------------------------------------------------

def checker_image():
    """Two-tone squares with a thin joint; 16 texels a square."""
    def texel(u, v):
        column, row = int(u * SQUARES), int(v * SQUARES)
        inside = min(u * SQUARES % 1, v * SQUARES % 1, 1 - u * SQUARES % 1, 1 - v * SQUARES % 1)
        if inside < 0.03:
            return (0.30, 0.29, 0.28, 1.0)
        return (0.86, 0.83, 0.76, 1.0) if (column + row) % 2 else (0.28, 0.34, 0.40, 1.0)
    return shading.image_from_function("Checker", 512, 512, texel)


def crate_image():
    """Planks with a frame, in wood colours."""
    def texel(u, v):
        edge = min(u, v, 1 - u, 1 - v)
        frame = edge < 0.12 or abs(u - v) < 0.07
        along = v if frame and min(u, 1 - u) < 0.12 else u
        grain = 0.5 + 0.5 * math.sin(60 * along + 6 * math.sin(9 * u + 4 * v))
        gap = not frame and (v * 5) % 1 < 0.06
        tone = (0.62 if frame else 0.48) + 0.10 * grain - (0.35 if gap else 0.0)
        return (tone * 1.15, tone * 0.82, tone * 0.48, 1.0)
    return shading.image_from_function("Crate", 256, 256, texel)


def brick_normal_image():
    """Tangent-space normal map of bricks with rounded edges (stored as 0.5 + 0.5 n)."""
    def slope(x, width):
        edge = min(x, 1 - x)
        return 0.0 if edge > width else (1 if x < 0.5 else -1) * -0.9 * (1 - edge / width)

    def texel(u, v):
        row = int(v * 12)
        nx = slope((u * 8 + 0.5 * (row % 2)) % 1, 0.10)
        ny = slope(v * 12 % 1, 0.16)
        length = math.sqrt(nx * nx + ny * ny + 1.0)
        return (0.5 + 0.5 * nx / length, 0.5 + 0.5 * ny / length, 0.5 + 0.5 / length, 1.0)
    return shading.image_from_function("BrickNormals", 512, 512, texel, non_color=True)


def leaf_image():
    """Four leaves; alpha is 1 inside a leaf and 0 outside."""
    def texel(u, v):
        x, y = (u * 2) % 1 - 0.5, (v * 2) % 1
        half_width = 0.40 * math.sin(math.pi * y) ** 0.8
        inside = abs(x) < half_width
        vein = abs(x) < 0.015 or abs((y * 7 + abs(x) * 5) % 1) < 0.10
        green = 0.72 if vein else 0.52
        return (0.30 if vein else 0.20, green, 0.16, 1.0 if inside else 0.0)
    return shading.image_from_function("Leaves", 256, 256, texel)


# ---- objects ---------------------------------------------------------------------------------

def add_stage():
    common.add_plane("Floor", (0, 0, 0), (FLOOR_SIZE, FLOOR_SIZE),
                     shading.principled("Floor", image=checker_image()))
    common.add_box("BackWall", (0, 5.2, 2.6), (16.0, 0.3, 5.2),
                   shading.diffuse("Wall", (0.34, 0.28, 0.27)))
    for index, x in enumerate((-4.6, 4.6)):
        pillar = common.add_grid(f"Pillar{index + 1}", pillar_point, 64, 32, shading.principled(
            f"Pillar{index + 1}", (0.70, 0.42, 0.30), normal_image=brick_normal_image()))
        pillar.location = (x, 3.4, 0.0)


def pillar_point(u, v):
    angle = 2 * math.pi * u
    return (0.55 * math.cos(angle), 0.55 * math.sin(angle), 3.4 * v)


def add_balls():
    common.add_sphere("MirrorBall", (-1.75, 0.9, 1.15), 1.15, shading.mirror("Silver"), 128, 64)
    common.add_sphere("GlassBall", (1.05, -0.9, 0.85), 0.85,
                      shading.glass("Glass", ior=1.45), 128, 64)
    common.add_sphere("AmberBall", (-0.55, -1.75, 0.38), 0.38,
                      shading.glass("Amber", (1.0, 0.66, 0.28), 1.5), 96, 48)
    common.add_sphere("GoldBall", (3.3, 0.2, 0.55), 0.55,
                      shading.mirror("Gold", (1.0, 0.76, 0.36)), 96, 48)


def add_boxes():
    colors = {"Red": (0.72, 0.06, 0.05), "Green": (0.08, 0.46, 0.12), "Blue": (0.06, 0.16, 0.62),
              "Yellow": (0.85, 0.62, 0.06)}
    places = {"Red": ((0.1, 2.9, 0.75), (0.9, 0.9, 1.5), 25),
              "Green": ((-3.7, -0.1, 0.4), (0.8, 0.8, 0.8), 15),
              "Blue": ((1.9, 2.2, 1.0), (0.8, 0.8, 2.0), -20),
              "Yellow": ((-2.5, -1.7, 0.25), (0.5, 0.5, 0.5), 40)}
    for name, (location, size, turn) in places.items():
        common.add_box(f"{name}Box", location, size, shading.diffuse(name, colors[name]), turn)
    common.add_box("Crate", (3.25, 1.9, 0.6), (1.2, 1.2, 1.2),
                   shading.principled("Crate", image=crate_image()), 30)
    common.add_box("GlassCube", (2.45, -1.95, 0.351), (0.7, 0.7, 0.7),
                   shading.glass("AquaGlass", (0.70, 0.95, 0.96), 1.33), 35)


def add_leaf_screen():
    """Upright card of leaves that throws a cut-out shadow."""
    screen = common.add_plane("LeafScreen", (-3.3, 2.6, 1.3), (1.8, 2.2), shading.principled(
        "Leaves", image=leaf_image(), alpha=True))
    screen.rotation_euler = (math.radians(90), 0, math.radians(18))


def add_lights():
    common.set_world((0.42, 0.55, 0.78), 0.18)
    common.add_sun("Sun", (0.85, 0.45, -1.0), 3.6, (1.0, 0.95, 0.86))
    common.add_point("Lamp", (2.2, -2.6, 3.6), 260.0, (1.0, 0.80, 0.58))
    common.add_spot("SpotBlue", (-5.0, -3.2, 4.2), (-1.6, 1.2, 0.4), 900.0, 38.0, 0.1,
                    (0.62, 0.78, 1.0))
    common.add_spot("SpotRose", (4.8, 0.5, 4.4), (0.8, 4.9, 2.2), 900.0, 24.0, 0.05,
                    (1.0, 0.62, 0.60))


def main():
    args = common.parse_args(__doc__)
    common.clear_scene()
    add_stage()
    add_balls()
    add_boxes()
    add_leaf_screen()
    add_lights()
    common.add_camera((0.35, -7.2, 2.5), (0.05, 0.4, 1.0), 31.0)
    common.finish("showcase", args)


main()
