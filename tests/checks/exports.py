# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks what libkestrel.so exports and binds.

    python3 tests/checks/exports.py build/libkestrel.so

Exports: exactly the functions that kestrel.h declares. Binds: none of OpenImageIO's libraries,
which would come into Blender with other versions of what it has already.
"""

import re
import subprocess
import sys
from pathlib import Path

HEADER = Path(__file__).resolve().parents[2] / "core" / "include" / "kestrel" / "kestrel.h"
UNWANTED = ("OpenImageIO", "OpenEXR", "Imath", "assimp", "libfmt", "opencv", "boost")


def tool(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def main():
    library = sys.argv[1]
    declared = set(re.findall(r"KESTREL_API\s[^;(]*?\b(kestrel\w+)\s*\(", HEADER.read_text()))
    symbols = tool("nm", "-D", "--defined-only", library).split("\n")
    # An '@@VERSION' suffix and the version's own absolute symbol come from a version script.
    exported = {line.split()[2].split("@")[0] for line in symbols
                if len(line.split()) == 3 and line.split()[1] != "A"}
    needed = re.findall(r"NEEDED.*\[(.*)\]", tool("readelf", "-d", library))
    faults = [f"exported but not in kestrel.h: {name}" for name in sorted(exported - declared)]
    faults += [f"in kestrel.h but not exported: {name}" for name in sorted(declared - exported)]
    faults += [f"links {name}" for name in needed if any(word in name for word in UNWANTED)]
    print("\n".join(faults) or f"{len(exported)} functions exported; links {', '.join(needed)}")
    return 1 if faults or not declared else 0


if __name__ == "__main__":
    sys.exit(main())
