# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks that the rasteriser and primary rays fill the same G-buffer.

    python3 tests/image/primaries.py --build BUILD SCENE.kscene [--size WxH]

At least 99.5 % of the pixels must show the same object, and on those the lighting must agree within
40 dB. One sample at the pixel's centre, so that edges are not blurred. Exits with 0, 1 or 77.
"""

import argparse
import os
import re
import sys
from pathlib import Path

import numpy
import rendering
import report

import exr
import metrics

SKIPPED = 77
SAME_OBJECT, LIGHTING_DB = 0.995, 40.0


def missing_data(scene):
    """The first file of the scene data that the scene needs and that is not there, or None."""
    default = rendering.FOLDER.parents[2] / "shared" / "scenes"
    folder = Path(os.environ.get("KESTREL_SCENE_DATA") or default)
    names = re.findall(r"\$\{KESTREL_SCENE_DATA\}/([^\"]+)", scene.read_text(encoding="utf-8"))
    return next((folder / name for name in names if not (folder / name).exists()), None)


def planes_of(path):
    data = Path(path).read_bytes()
    attributes, offset = exr.read_header(data)
    return exr.read_planes(data, offset, attributes)


def one_channel(planes, layer):
    names = [name for name in planes if name == layer or name.startswith(f"{layer}.")]
    if len(names) != 1:
        raise RuntimeError(f"no layer '{layer}' of one channel among {', '.join(sorted(planes))}")
    return planes[names[0]]


def render(build, scene, size, primary, work):
    out = work / f"{primary}.exr"
    rendering.run_command(build, "render", scene, "-o", out, "--size", size, "--passes",
                          "Combined,Lighting,ObjectId", "--set", f"primary={primary}", "--set",
                          "samples=1")
    return planes_of(out)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--build", type=Path, default=Path("build"))
    parser.add_argument("--size", default="640x360")
    parser.add_argument("scene", type=Path)
    args = parser.parse_args()
    missing, reason = missing_data(args.scene), rendering.gl_error(args.build)
    if missing or reason:
        print(f"SKIP: scene data missing: {missing}" if missing else f"SKIP: no OpenGL: {reason}")
        return SKIPPED
    name = f"primaries.{args.scene.stem}"
    work = args.build / "image_work" / name
    work.mkdir(parents=True, exist_ok=True)
    raster, rays = (render(args.build, args.scene, args.size, primary, work)
                    for primary in ("raster", "rays"))
    same = one_channel(raster, "ObjectId") == one_channel(rays, "ObjectId")
    lit = [numpy.stack([planes[f"Lighting.{c}"] for c in "RGB"], axis=-1)
           for planes in (raster, rays)]
    decibels = metrics.psnr(*lit, mask=same)
    passed = same.mean() >= SAME_OBJECT and decibels >= LIGHTING_DB
    figures = {"same object": f"{100 * same.mean():.3f} % (at least {100 * SAME_OBJECT:g})",
               "lighting": f"{decibels:.2f} dB there (at least {LIGHTING_DB:g})"}
    report.write_case(args.build / "image_report", name, "rasteriser (result) against primary rays",
                      "passed" if passed else "failed", figures, lit[1], lit[0])
    print("\n".join(f"{label}: {figure}" for label, figure in figures.items()))
    return 0 if passed else 1


if __name__ == "__main__":
    sys.exit(main())
