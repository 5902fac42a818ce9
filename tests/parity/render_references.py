# SPDX-License-Identifier: GPL-3.0-or-later
"""Render the Cycles references of the parity cases and say what changed.

    blender -b --factory-startup --python tests/parity/render_references.py -- [--out DIR] [NAME...]

Writes `tests/references/cycles/NAME.exr` (or DIR/NAME.exr): scene-linear RGB, half floats, ZIP, no
metadata. Prints the PSNR in dB against the file that was there before; with `--seed` and a copy of
the references as DIR that is the references' own noise. Needs Cycles and numpy in
Blender's Python.
"""

import argparse
import os
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import bpy
import cases
import exr
import metrics
import scenes


def parse_args():
    parser = argparse.ArgumentParser(prog="render_references.py")
    parser.add_argument("--out", type=Path, default=cases.REFERENCE_FOLDER, metavar="DIR")
    parser.add_argument("--samples", type=int, help="per pixel, instead of the case's own")
    parser.add_argument("--seed", type=int, default=1, help="of Cycles' sampler")
    parser.add_argument("names", nargs="*", help="cases (all by default)")
    return parser.parse_args(sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else [])


def render(case, samples, seed):
    """Scene-linear pixels of a case as Cycles draws it."""
    scene = scenes.build(case)
    scene.render.engine = "CYCLES"
    scene.cycles.seed = seed
    if samples:
        scene.cycles.samples = samples
    settings = scene.render.image_settings
    settings.file_format, settings.color_mode, settings.color_depth = "OPEN_EXR", "RGB", "32"
    settings.exr_codec = "ZIP"
    with tempfile.TemporaryDirectory() as folder:
        scene.render.filepath = os.path.join(folder, "picture.exr")
        bpy.ops.render.render(write_still=True)
        return exr.read(scene.render.filepath)


def main():
    args = parse_args()
    args.out.mkdir(parents=True, exist_ok=True)
    for case in [cases.find_case(name) for name in args.names] or cases.CASES:
        start = time.monotonic()
        pixels = render(case, args.samples, args.seed)
        path = args.out / f"{case.name}.exr"
        change = "new"
        if path.exists():
            change = f"{metrics.psnr(exr.read(path), pixels):.1f} dB to the file before"
        exr.write(path, pixels)
        print(f"{case.name}: {time.monotonic() - start:.1f} s, {change}", flush=True)


main()
