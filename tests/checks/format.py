# SPDX-License-Identifier: GPL-3.0-or-later
"""Puts the C++ code into the project's format (.clang-format).

    python3 tests/checks/format.py [--check]

`--check` changes nothing and exits with 1 where a file differs. The format is that of clang-format
14 (Debian 12); other versions differ in details, so with them the check exits with 77 (skipped).
"""

import argparse
import re
import subprocess
import sys
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
FOLDERS = ("core", "tests")
VERSION = 14
SKIPPED = 77


def sources():
    return sorted(str(path.relative_to(REPOSITORY)) for folder in FOLDERS
                  for pattern in ("*.h", "*.cpp") for path in (REPOSITORY / folder).rglob(pattern))


def find_tool():
    """The command of the wanted version, or None with a reason printed."""
    found = "clang-format is not installed"
    for tool in (f"clang-format-{VERSION}", "clang-format"):
        try:
            text = subprocess.run([tool, "--version"], capture_output=True, text=True).stdout
        except FileNotFoundError:
            continue
        found = text.strip()
        if re.search(rf"version {VERSION}\.", text):
            return tool
    print(f"SKIP: the format is that of clang-format {VERSION}; here: {found}")
    return None


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--check", action="store_true")
    args = parser.parse_args()
    tool = find_tool()
    if tool is None:
        return SKIPPED
    files = sources()
    mode = ["--dry-run", "-Werror"] if args.check else ["-i"]
    status = subprocess.run([tool, *mode, *files], cwd=REPOSITORY).returncode
    if status:
        print("Run './dev format' and look at what it changed.")
        return 1
    print(f"{len(files)} files {'are in' if args.check else 'put into'} format")
    return 0


if __name__ == "__main__":
    sys.exit(main())
