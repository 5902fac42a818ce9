# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the add-on's tests inside Blender, with the add-on installed from its zip.

    python3 tests/blender/run.py [--build build] --prepare      package and install it
    python3 tests/blender/run.py [--build build] [NAME ...]     NAME: camera for test_camera.py
    python3 tests/blender/run.py --list

The Blender is that of KESTREL_BLENDER, or `blender`; its user folder is BUILD/blender_user. Without a
Blender the tests are skipped (exit status 77). KESTREL_LIBRARY may name another library to test.
"""

import os
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))

from blender_run import REPOSITORY, SKIPPED, names, parser, user_folders  # noqa: E402


def parse(arguments):
    options = parser(HERE, __doc__)
    options.add_argument("--prepare", action="store_true", help="package and install the add-on")
    return options.parse_args(arguments)


def prepare(args, blender):
    """Make the zip and install it as an artist would; returns the exit status."""
    folders = user_folders(args.build)
    shutil.rmtree(args.build / "blender_user", ignore_errors=True)
    for folder in folders.values():
        os.makedirs(folder)
    made = subprocess.run(
        [sys.executable, str(REPOSITORY / "packaging/make_zip.py"), "--build", str(args.build),
         "--dist", str(args.build / "blender_user")], check=True, stdout=subprocess.PIPE, text=True)
    return subprocess.run(
        [blender, "-b", "-noaudio", "--python-exit-code", "1", "--python",
         str(REPOSITORY / "packaging/install_addon.py"), "--", made.stdout.strip(), "--add-on"],
        env={**os.environ, **folders}, check=False).returncode


def run_outside(args):
    """Start Blender with this very script; returns the exit status."""
    blender = shutil.which(os.environ.get("KESTREL_BLENDER", "blender"))
    if blender is None:
        print("SKIP: Blender is not installed (KESTREL_BLENDER may name one)")
        return SKIPPED
    if args.prepare:
        return prepare(args, blender)
    environment = {**os.environ, **user_folders(args.build), "KESTREL_TEST_BLENDER": blender,
                   "KESTREL_TEST_COMMAND": str(args.build.resolve() / "kestrel")}
    return subprocess.run(
        [blender, "-b", "--factory-startup", "-noaudio", "--python-exit-code", "1", "--python",
         str(HERE / "run.py"), "--", *args.names], env=environment, check=False).returncode


def run_inside(args):
    """Run the tests in this Blender; returns whether all passed."""
    import addon_utils
    sys.dont_write_bytecode = True
    sys.path.insert(0, str(REPOSITORY / "tests/parity"))
    if addon_utils.enable("kestrel", default_set=True) is None:
        print("the add-on did not start; the reason stands above")
        return False
    suite = unittest.defaultTestLoader.loadTestsFromNames(
        [f"test_{name}" for name in args.names or names(HERE)])
    return unittest.TextTestRunner(stream=sys.stdout, verbosity=2).run(suite).wasSuccessful()


def main():
    if "bpy" in sys.modules:
        own = sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else []
        sys.exit(0 if run_inside(parse(own)) else 1)
    args = parse(sys.argv[1:])
    if args.list:
        print("\n".join(names(HERE)))
        return
    sys.exit(run_outside(args))


if __name__ == "__main__":
    main()
