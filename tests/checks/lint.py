# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks of the sources: pyflakes over all Python, a licence line in every source file, `bpy` only
where the add-on's layout allows it, shell scripts that parse.

    python3 tests/checks/lint.py
"""

import subprocess
import sys
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
FOLDERS = ("core", "shaders", "blender_addon", "scenes", "tests", "packaging", "cmake")
SUFFIXES = {".py", ".h", ".cpp", ".glsl", ".vert", ".frag", ".comp", ".cmake"}
SCRIPTS = ("dev", ".ci/run")
LICENCE = "SPDX-License-Identifier: GPL-3.0-or-later"
LICENCE_WITHIN_LINES = 3  # a #! line, and the opening of a C comment
NO_BPY = ("native",)  # parts of the add-on that must work outside Blender


def sources():
    files = [path for folder in FOLDERS for path in (REPOSITORY / folder).rglob("*")
             if path.suffix in SUFFIXES or path.name == "CMakeLists.txt"]
    return sorted(files) + [REPOSITORY / "CMakeLists.txt"] + [REPOSITORY / s for s in SCRIPTS]


def name(path):
    return str(path.relative_to(REPOSITORY))


def check_licences(files):
    return [f"{name(path)}: the licence line is missing ('{LICENCE}')" for path in files
            if LICENCE not in "".join(path.read_text(encoding="utf-8").splitlines(True)
                                      [:LICENCE_WITHIN_LINES])]


def check_python(files):
    python = [str(path) for path in files if path.suffix == ".py"]
    run = subprocess.run([sys.executable, "-m", "pyflakes", *python], capture_output=True,
                         text=True)
    lines = (run.stdout + run.stderr).splitlines()
    if run.returncode and not lines:
        lines = [f"pyflakes ended with {run.returncode}"]
    return lines


def check_bpy(files):
    addon = REPOSITORY / "blender_addon" / "kestrel"
    return [f"{name(path)}: imports bpy" for path in files
            if addon in path.parents and path.relative_to(addon).parts[0] in NO_BPY
            and "import bpy" in path.read_text(encoding="utf-8")]


def check_shell():
    return [line for script in SCRIPTS for line in
            subprocess.run(["bash", "-n", script], cwd=REPOSITORY, capture_output=True,
                           text=True).stderr.splitlines()]


def main():
    files = sources()
    faults = check_licences(files) + check_python(files) + check_bpy(files) + check_shell()
    print("\n".join(faults) or f"{len(files)} files checked")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
