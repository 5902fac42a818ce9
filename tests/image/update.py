# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders the references of the image cases anew and says what changed.

    python3 tests/image/update.py [--build BUILD] [NAME...]

Look at each changed picture before committing it. References are rendered with primary rays, which
give the same bits on every machine; half floats, lossless, without metadata.
"""

import argparse
import sys
from pathlib import Path

import image_cases
import numpy
import rendering

import exr
import metrics


def update(build, case):
    """Write the reference of a case; returns what changed."""
    path = rendering.REFERENCES / f"{case.name}.exr"
    picture = rendering.render(build, case, "rays", Path(build) / "image_work" / "update")
    picture = picture.astype(numpy.float16).astype(numpy.float32)
    if path.exists():
        old = exr.read(path)
        if numpy.array_equal(old, picture):
            return "unchanged"
        same_size = old.shape == picture.shape
        change = f"changed, {metrics.psnr(old, picture):.2f} dB to the old one" if same_size else \
            f"changed, size was {old.shape[1]}x{old.shape[0]}"
    else:
        change = "new"
    path.parent.mkdir(parents=True, exist_ok=True)
    exr.write(path, picture)
    return f"{change}, {path.stat().st_size} bytes"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--build", type=Path, default=Path("build"))
    parser.add_argument("names", nargs="*")
    args = parser.parse_args()
    own = [case for case in image_cases.CASES if case.reference and not case.same_as]
    chosen = [image_cases.find(name) for name in args.names] or own
    for case in chosen:
        print(f"{case.name}: {update(args.build, case)}", flush=True)
    if not args.names:
        for path in sorted(rendering.REFERENCES.glob("*.exr")):
            if path.stem not in {case.name for case in own}:
                print(f"{path}: belongs to no case; remove it")
    return 0


if __name__ == "__main__":
    sys.exit(main())
