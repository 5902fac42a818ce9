# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the images that the image cases' scenes use, into tests/image/scenes/textures.

    python3 tests/image/make_textures.py

The files are committed; this script says what is in them.
"""

from pathlib import Path

import numpy
import report

FOLDER = Path(__file__).resolve().parent / "scenes" / "textures"
RED, GREEN, BLUE, YELLOW = (255, 0, 0), (0, 255, 0), (0, 0, 255), (255, 255, 0)
CUBE = {"px": (255, 0, 0), "nx": (0, 255, 255), "py": (0, 255, 0), "ny": (255, 0, 255),
        "pz": (0, 0, 255), "nz": (255, 255, 0)}


def quadrants(top_left, top_right, bottom_left, bottom_right, half):
    picture = numpy.empty((2 * half, 2 * half, 3), numpy.uint8)
    picture[:half, :half], picture[:half, half:] = top_left, top_right
    picture[half:, :half], picture[half:, half:] = bottom_left, bottom_right
    return picture


def tilted_normals():
    """Left half leans 45 degrees towards +u, right half towards +v; OpenGL's convention."""
    s = numpy.sqrt(0.5)
    picture = numpy.empty((8, 8, 3))
    picture[:, :4], picture[:, 4:] = (s, 0, s), (0, s, s)
    return numpy.rint((picture * 0.5 + 0.5) * 255).astype(numpy.uint8)


def cube_face(color):
    """Mid grey, and the face's colour in the upper left quarter: turns and flips show."""
    face = numpy.full((16, 16, 3), 188, numpy.uint8)  # 0.503 linear
    face[:8, :8] = color
    return face


def equirectangular():
    """Four colours for the quarters of the horizon, white above, black below. The middle of the
    picture lies towards +X, so +Y is a quarter to the left of it (u = 0.25)."""
    sky = numpy.zeros((16, 32, 3), numpy.uint8)
    sky[:4] = 255
    for first, color in ((0, YELLOW), (4, GREEN), (12, RED), (20, BLUE), (28, YELLOW)):
        sky[4:12, first:first + 8] = color
    return sky


def main():
    FOLDER.mkdir(parents=True, exist_ok=True)
    report.write_png(FOLDER / "quadrants.png", quadrants(RED, GREEN, BLUE, YELLOW, 8))
    report.write_png(FOLDER / "grey188.png", numpy.full((4, 4, 3), 188, numpy.uint8))
    report.write_png(FOLDER / "tilted_normals.png", tilted_normals())
    report.write_png(FOLDER / "sky.png", equirectangular())
    for name, color in CUBE.items():
        report.write_png(FOLDER / f"cube_{name}.png", cube_face(color))


main()
