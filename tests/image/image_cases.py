# SPDX-License-Identifier: GPL-3.0-or-later
"""The image cases as data. Each is a scene of `tests/image/scenes`, changed by a JSON merge patch,
rendered small by the kestrel command with primary = raster and rays, and compared with
`tests/references/image/NAME.exr` or, where `same_as` names one, with another case's picture.
Probes are known answers, worked out by hand.
"""

from typing import NamedTuple

SIZE_PX = (256, 144)
BOTH = ("raster", "rays")


class Probe(NamedTuple):
    x: int  # pixels from the left
    y: int  # pixels from the top
    rgb: tuple  # scene-linear
    tolerance: float  # of each channel
    why: str


class Case(NamedTuple):
    name: str
    scene: str
    shows: str
    tolerance_db: float = 40.0
    patch: dict = {}
    settings: dict = {}
    layer: str = "Combined"
    same_as: str = ""
    probes: tuple = ()
    primaries: tuple = BOTH
    samples: int = 4
    size: tuple = SIZE_PX


CASES = []


def find(name):
    for case in CASES:
        if case.name == name:
            return case
    raise SystemExit(f"no image case '{name}'. There are: {', '.join(c.name for c in CASES)}")
