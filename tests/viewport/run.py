# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the viewport's tests in a Blender with a window, on a virtual screen, with the add-on
that tests/blender/run.py --prepare installed from its zip.

    python3 tests/viewport/run.py [--build build] [NAME ...]     NAME: motion for test_motion.py
    python3 tests/viewport/run.py --list

Library and Blender are chosen as in tests/blender/run.py. Without a Blender, or without xvfb-run,
the tests are skipped (exit status 77).
"""

import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "blender")]

from blender_run import REPOSITORY, SKIPPED, names, parser, user_folders  # noqa: E402

SIZE = "960", "540"  # of the window, pixels
TIME_LIMIT_S = 540.0


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
        environment = {**os.environ, **user_folders(args.build), "LIBGL_ALWAYS_SOFTWARE": "1",
                       "TMPDIR": folder, "KESTREL_TEST_BLENDER": blender,
                       "KESTREL_TEST_VERDICT": str(verdict)}
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
    sys.path.insert(0, str(REPOSITORY / "tests/parity"))
    bpy.context.preferences.view.show_splash = False
    if addon_utils.enable("kestrel", default_set=True) is None:
        print("the add-on did not start; the reason stands above")
        os._exit(1)
    import stepper
    suite = unittest.defaultTestLoader.loadTestsFromNames(
        [f"test_{name}" for name in args.names or names(HERE)])

    def end(passed):
        Path(os.environ["KESTREL_TEST_VERDICT"]).write_text("passed" if passed else "failed",
                                                            encoding="utf-8")
        bpy.ops.wm.quit_blender()

    stepper.run(suite, end)


def main():
    if "bpy" in sys.modules:
        own = sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else []
        start_inside(parser(HERE, __doc__).parse_args(own))
        return
    args = parser(HERE, __doc__).parse_args(sys.argv[1:])
    if args.list:
        print("\n".join(names(HERE)))
        return
    sys.exit(run_outside(args))


if __name__ == "__main__":
    main()
