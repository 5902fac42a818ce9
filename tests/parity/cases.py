# SPDX-License-Identifier: GPL-3.0-or-later
"""The parity cases as data: name, least PSNR against Cycles in dB, and what the picture shows.

Importable without Blender. `scenes.py` builds the case NAME with its function NAME, the reference
is `tests/references/cycles/NAME.exr`. An informative case is reported and never fails a test.
"""

from pathlib import Path
from typing import NamedTuple

REFERENCE_FOLDER = Path(__file__).resolve().parents[1] / "references" / "cycles"


class Case(NamedTuple):
    name: str
    tolerance_db: float
    shows: str
    samples: int = 256  # of the Cycles reference, per pixel
    informative: bool = False


CASES = [
    Case("mirror_ball", 40.0, "Glossy ball, roughness 0, over a floor and boxes in hard sunlight"),
    Case("facing_mirrors", 39.0, "two mirrors face to face, reflections up to 10 deep"),
    Case("sun_shadow", 40.0, "hard shadows of a sun of angle 0"),
    Case("point_shadow", 42.0, "hard shadows of a point light of radius 0"),
    Case("spot_shadow", 39.0, "one spot with blend 0 and one with blend 0.3, radius 0", 1024),
    Case("glass_ball", 25.0, "Glass ball, IOR 1.45: the room upside down", 1024, True),
    Case("textured_plane", 38.0, "sRGB image, UVs, linear interpolation, magnified"),
    # Informative until materials can turn their textures: tiling and offset only so far.
    Case("texture_mapping", 35.0, "the same image through a Mapping node, repeated and turned", 256,
         True),
    # Informative: Cycles bends normals that would reflect below the surface, Kestrel does not yet.
    Case("normal_map", 35.0, "tangent-space normal map on a plane and a cylinder", 256, True),
    Case("ortho_shift", 38.0, "orthographic camera with lens shift"),
    Case("persp_shift", 38.0, "perspective camera with lens shift"),
    Case("instances", 38.0, "collection instances: turned, scaled unevenly, nested"),
    Case("environment", 45.0, "equirectangular float image, seen directly and in mirrors"),
    Case("alpha_leaf", 40.0, "binary alpha through Transparent BSDF and Principled alpha, shadows"),
]


def find_case(name):
    return next(case for case in CASES if case.name == name)


def reference_path(name):
    return REFERENCE_FOLDER / f"{name}.exr"
