# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders one image case with the kestrel command and judges it.

    python3 tests/image/run.py --build BUILD NAME PRIMARY      PRIMARY: raster or rays
    python3 tests/image/run.py --list                          every NAME PRIMARY, one a line

Exits with 0 (passed), 1 (failed) or 77 (skipped, with the reason). The report is
BUILD/image_report/index.html; a failed case keeps reference, result and difference there.
"""

import argparse
import sys
from pathlib import Path

import image_cases
import numpy
import rendering
import report

import exr
import metrics

SKIPPED = 77


class Judgement:
    """What was found out about one picture."""

    def __init__(self, picture):
        self.picture = picture
        self.reference = None
        self.figures = {}
        self.faults = []

    def compare(self, label, reference, tolerance_db):
        """Require at least `tolerance_db` against another picture."""
        if reference.shape != self.picture.shape:
            self.faults.append(f"{label}: size {reference.shape} against {self.picture.shape}")
            return
        decibels = metrics.psnr(reference, self.picture)
        self.figures[label] = f"{decibels:.2f} dB (at least {tolerance_db:g})"
        if not decibels >= tolerance_db:
            self.faults.append(f"{label}: {decibels:.2f} dB, at least {tolerance_db:g} wanted")

    def probe(self, probe):
        """Require a known answer at a pixel."""
        found = self.picture[probe.y, probe.x]
        text = "({:.4g} {:.4g} {:.4g})".format(*found)
        self.figures[f"pixel {probe.x},{probe.y}"] = f"{text}, {probe.why}"
        wanted = numpy.asarray(probe.rgb)
        if not numpy.all(numpy.abs(found - wanted) <= probe.tolerance):
            self.faults.append("pixel {},{}: {} where ({:.4g} {:.4g} {:.4g}) is right: {}".format(
                probe.x, probe.y, text, *wanted, probe.why))


def judge(build, case, primary, work):
    judgement = Judgement(rendering.render(build, case, primary, work))
    if not numpy.isfinite(judgement.picture).all():
        judgement.faults.append("the picture holds values that are not finite")
    for probe in case.probes:
        judgement.probe(probe)
    if case.same_as:
        other = image_cases.find(case.same_as)
        judgement.reference = rendering.render(build, other, primary, work)
        judgement.compare(f"against {other.name}", judgement.reference, case.tolerance_db)
    elif case.reference:
        path = rendering.REFERENCES / f"{case.name}.exr"
        if path.exists():
            judgement.reference = exr.read(path)
            judgement.compare("reference", judgement.reference, case.tolerance_db)
        else:
            judgement.faults.append(f"no reference {path}; tests/image/update.py makes it")
    return judgement


def run(build, case, primary):
    folder = Path(build) / "image_report"
    name = f"{case.name}.{primary}"
    reason = rendering.gl_error(build) if primary == "raster" else None
    if reason:
        print(f"SKIP: no OpenGL: {reason}")
        report.write_case(folder, name, case.shows, "skipped", {"reason": reason})
        return SKIPPED
    result = judge(build, case, primary, Path(build) / "image_work" / name)
    report.write_case(folder, name, case.shows, "failed" if result.faults else "passed",
                      result.figures, result.reference, result.picture)
    for label, figure in result.figures.items():
        print(f"{label}: {figure}")
    for fault in result.faults:
        print(f"FAILED: {fault}")
    if result.faults:
        print(f"pictures: {folder / name}; report: {folder / 'index.html'}")
    return 1 if result.faults else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--build", type=Path, default=Path("build"))
    parser.add_argument("--list", action="store_true")
    parser.add_argument("name", nargs="?")
    parser.add_argument("primary", nargs="?", choices=("raster", "rays"))
    args = parser.parse_args()
    if args.list:
        print("\n".join(f"{case.name} {primary}" for case in image_cases.CASES
                        for primary in case.primaries))
        return 0
    if not args.primary:
        parser.error("name a case and raster or rays")
    return run(args.build, image_cases.find(args.name), args.primary)


if __name__ == "__main__":
    sys.exit(main())
