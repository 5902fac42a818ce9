# SPDX-License-Identifier: GPL-3.0-or-later
"""What the runners of tests inside Blender share: their options, and the user folder with the add-on.

tests/blender/run.py --prepare installs the add-on from its zip into BUILD/blender_user, and all of
these tests use that one.
"""

import argparse
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
SKIPPED = 77  # exit status of a test that cannot be run here


def names(folder):
    """Names of the tests in a folder: camera for test_camera.py."""
    return sorted(path.stem.removeprefix("test_") for path in folder.glob("test_*.py"))


def parser(folder, description):
    """The options that the runner of this folder's tests takes."""
    known = names(folder)
    made = argparse.ArgumentParser(prog="run.py", description=description.split("\n")[0])
    made.add_argument("names", nargs="*", metavar="NAME", choices=known + [[]])
    made.add_argument("--list", action="store_true", help="print the names, one a line")
    made.add_argument("--build", type=Path, default=REPOSITORY / "build",
                      help="folder with libkestrel.so")
    return made


def user_folders(build):
    """Environment that gives Blender the user folder in which the add-on is installed."""
    user = build.resolve() / "blender_user"
    return {f"BLENDER_USER_{name.upper()}": str(user / name)
            for name in ("config", "scripts", "extensions")}
