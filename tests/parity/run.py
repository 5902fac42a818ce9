# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders parity cases in Blender with KESTREL and compares them with the Cycles references.

    python3 tests/parity/run.py --build BUILD --prepare     package the add-on, write the .blend files
    python3 tests/parity/run.py --build BUILD NAME          one case

Works in BUILD/parity with a Blender user folder of its own; KESTREL_BLENDER names the Blender.
Exits with 0 (passed), 1 (failed) or 77 (skipped, with the reason). The report is
BUILD/image_report/index.html.
"""

import argparse
import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

FOLDER = Path(__file__).resolve().parent
REPOSITORY = FOLDER.parents[1]
sys.path.insert(0, str(FOLDER.parent / "image"))
import report

import cases
import exr
import metrics

SKIPPED = 77
SAMPLES = 16
TIMEOUT_S = 900


def blender(work, *arguments):
    """Run Blender in background with the packaged add-on enabled; raises RuntimeError if it fails."""
    command = [os.environ.get("KESTREL_BLENDER", "blender"), "-b", "--addons", "kestrel",
               *map(str, arguments)]
    environment = {**os.environ, "BLENDER_USER_SCRIPTS": str(work / "scripts"),
                   "BLENDER_USER_CONFIG": str(work / "config"),
                   "BLENDER_USER_EXTENSIONS": str(work / "extensions")}
    run = subprocess.run(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                         stderr=subprocess.STDOUT, text=True, env=environment, timeout=TIMEOUT_S)
    if run.returncode:
        raise RuntimeError(f"Blender ended with {run.returncode}:\n{run.stdout[-4000:]}")
    return run.stdout


def prepare(build, work):
    shutil.rmtree(work, ignore_errors=True)
    addons = work / "scripts" / "addons"
    addons.mkdir(parents=True)
    (work / "config").mkdir()
    made = subprocess.run([sys.executable, REPOSITORY / "packaging" / "make_zip.py", "--build",
                           build, "--dist", work], check=True, stdout=subprocess.PIPE, text=True)
    with zipfile.ZipFile(made.stdout.strip()) as archive:
        archive.extractall(addons)
    print(blender(work, "--factory-startup", "--python-exit-code", 1, "--python",
                  FOLDER / "build_scenes.py", "--", "--out", work / "blend"))
    return 0


def compare(case, build, work):
    picture_path = work / f"{case.name}.exr"
    picture_path.unlink(missing_ok=True)
    log = blender(work, work / "blend" / f"{case.name}.blend", "-E", "KESTREL",
                  "--python-exit-code", 1, "--python", FOLDER / "render_kestrel.py", "--", "--out",
                  picture_path, "--samples", SAMPLES)
    if not picture_path.exists():
        raise RuntimeError(f"Blender wrote no picture:\n{log[-4000:]}")
    picture, reference = exr.read(picture_path), exr.read(cases.reference_path(case.name))
    decibels, similarity = metrics.psnr(reference, picture), metrics.ssim(reference, picture)
    passed = decibels >= case.tolerance_db
    verdict = "passed" if passed else "informative" if case.informative else "failed"
    figures = {"PSNR": f"{decibels:.2f} dB (at least {case.tolerance_db:g})",
               "SSIM": f"{similarity:.4f}"}
    report.write_case(build / "image_report", f"cycles.{case.name}", case.shows, verdict, figures,
                      reference, picture)
    print(f"{case.name}: {verdict}: PSNR {figures['PSNR']}, SSIM {figures['SSIM']}")
    if verdict == "failed":
        print(f"pictures: {build / 'image_report' / f'cycles.{case.name}'}")
    return 1 if verdict == "failed" else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--build", type=Path, default=Path("build"))
    parser.add_argument("--prepare", action="store_true")
    parser.add_argument("--list", action="store_true")
    parser.add_argument("name", nargs="?")
    args = parser.parse_args()
    if args.list:
        print("\n".join(case.name for case in cases.CASES))
        return 0
    program = os.environ.get("KESTREL_BLENDER", "blender")
    if shutil.which(program) is None:
        print(f"SKIP: there is no '{program}' (KESTREL_BLENDER)")
        return SKIPPED
    build = args.build.resolve()
    work = build / "parity"
    if args.prepare:
        return prepare(build, work)
    if not args.name:
        parser.error("name a case, or --prepare")
    return compare(cases.find_case(args.name), build, work)


if __name__ == "__main__":
    sys.exit(main())
