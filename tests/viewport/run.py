# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the viewport's tests in a Blender with a window, on a virtual screen, with the add-on of
this checkout.

    python3 tests/viewport/run.py [--build build] [NAME ...]     NAME: motion for test_motion.py
    python3 tests/viewport/run.py --list

Library and Blender are chosen as in tests/blender/run.py. Without a Blender, or without xvfb-run,
the tests are skipped (exit status 77).
"""

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
REPOSITORY = HERE.parents[1]
SKIPPED = 77
SIZE = "960", "540"  # of the window, pixels
TIME_LIMIT_S = 540.0


def names():
    return sorted(path.stem.removeprefix("test_") for path in HERE.glob("test_*.py"))


def parse(arguments):
    parser = argparse.ArgumentParser(prog="run.py", description=__doc__.split("\n")[0])
    parser.add_argument("names", nargs="*", metavar="NAME", choices=names() + [[]])
    parser.add_argument("--list", action="store_true", help="print the names, one a line")
    parser.add_argument("--build", type=Path, default=REPOSITORY / "build",
                        help="folder with libkestrel.so")
    return parser.parse_args(arguments)


# ---- outside of Blender ------------------------------------------------------------------------

def run_outside(args):
    """Start Blender on a virtual screen with this very script; returns the exit status."""
    blender = shutil.which(os.environ.get("KESTREL_BLENDER", "blender"))
    screen = shutil.which("xvfb-run")
    if blender is None or screen is None:
        missing = "xvfb-run" if blender else "Blender"
        print(f"SKIP: {missing} is not installed")
        return SKIPPED
    with tempfile.TemporaryDirectory() as folder:
        verdict = Path(folder) / "verdict"
        environment = dict(os.environ, LIBGL_ALWAYS_SOFTWARE="1", TMPDIR=folder,
                           KESTREL_TEST_BLENDER=blender, KESTREL_TEST_VERDICT=str(verdict))
        environment.setdefault("KESTREL_LIBRARY", str(args.build.resolve() / "libkestrel.so"))
        try:
            subprocess.run(
                [screen, "-a", "-s", "-screen 0 {}x{}x24".format(*SIZE), blender, "-noaudio",
                 "--factory-startup", "--window-geometry", "0", "0", *SIZE, "--python",
                 str(HERE / "run.py"), "--", *args.names],
                env=environment, check=False, timeout=TIME_LIMIT_S)
        except subprocess.TimeoutExpired:
            print(f"Blender did not end within {TIME_LIMIT_S:.0f} s")
            return 1
        if not verdict.exists():
            print("Blender ended before its tests did")
            return 1
        return 0 if verdict.read_text(encoding="utf-8") == "passed" else 1


# ---- inside ------------------------------------------------------------------------------------

def start_inside(args):
    import addon_utils
    import bpy
    sys.dont_write_bytecode = True
    sys.path[:0] = [str(HERE), str(REPOSITORY / "tests/blender"),
                    str(REPOSITORY / "blender_addon"), str(REPOSITORY / "tests/parity")]
    bpy.context.preferences.view.show_splash = False
    if addon_utils.enable("kestrel", default_set=True) is None:
        print("the add-on did not start; the reason stands above")
        os._exit(1)
    import stepper
    suite = unittest.defaultTestLoader.loadTestsFromNames(
        [f"test_{name}" for name in args.names or names()])

    def end(passed):
        Path(os.environ["KESTREL_TEST_VERDICT"]).write_text("passed" if passed else "failed",
                                                            encoding="utf-8")
        bpy.ops.wm.quit_blender()

    stepper.run(suite, end)


def main():
    if "bpy" in sys.modules:
        start_inside(parse(sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else []))
        return
    args = parse(sys.argv[1:])
    if args.list:
        print("\n".join(names()))
        return
    sys.exit(run_outside(args))


if __name__ == "__main__":
    main()
