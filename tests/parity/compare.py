# SPDX-License-Identifier: GPL-3.0-or-later
"""Compare pictures with the Cycles references: PSNR in dB and SSIM.

    python3 tests/parity/compare.py DIR            every case that DIR has as NAME.exr
    python3 tests/parity/compare.py A.exr B.exr    two files

Needs Python 3 with numpy. With a folder, exits with 1 where a case is missing or below its
tolerance; informative cases are printed and never fail. `--difference DIR` also writes, for each
case, the absolute difference (scene-linear) as DIR/NAME.difference.exr.
"""

import argparse
import os
import sys
from pathlib import Path

import numpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import cases
import exr
import metrics


def compare_files(first, second):
    a, b = exr.read(first), exr.read(second)
    return metrics.psnr(a, b), metrics.ssim(a, b)


def compare_case(case, folder, difference_folder):
    """One line of the report, and whether the case passes."""
    path = folder / f"{case.name}.exr"
    if not path.exists():
        return f"{case.name:16} missing: {path}", case.informative
    decibels, similarity = compare_files(path, cases.reference_path(case.name))
    if difference_folder:
        difference_folder.mkdir(parents=True, exist_ok=True)
        difference = numpy.abs(exr.read(path) - exr.read(cases.reference_path(case.name)))
        exr.write(difference_folder / f"{case.name}.difference.exr", difference)
    passes = decibels >= case.tolerance_db
    verdict = "ok" if passes else "informative" if case.informative else "FAILED"
    line = (f"{case.name:16} {decibels:6.2f} dB (at least {case.tolerance_db:g})  "
            f"SSIM {similarity:.4f}  {verdict}")
    return line, passes or case.informative


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("paths", nargs="+", type=Path, help="a folder, or two EXR files")
    parser.add_argument("--difference", type=Path, metavar="DIR")
    args = parser.parse_args()
    if len(args.paths) == 2:
        decibels, similarity = compare_files(*args.paths)
        print(f"{decibels:.2f} dB, SSIM {similarity:.4f}")
        return 0
    results = [compare_case(case, args.paths[0], args.difference) for case in cases.CASES]
    print("\n".join(line for line, _ in results))
    return 0 if all(passes for _, passes in results) else 1


if __name__ == "__main__":
    sys.exit(main())
