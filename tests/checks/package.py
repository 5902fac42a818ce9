# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks the add-on's zip: made twice it has the same bytes, it holds what an installation needs,
and the library inside loads from there and finds the image plug-in beside it.

    python3 tests/checks/package.py BUILD
"""

import ctypes
import json
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
WANTED = ("kestrel/__init__.py", "kestrel/blender_manifest.toml", "kestrel/LICENSE",
          "kestrel/LICENSES.md", "kestrel/native/lib/libkestrel.so",
          "kestrel/native/lib/libkestrel_oiio.so")


def make(build, folder):
    run = subprocess.run(
        [sys.executable, str(REPOSITORY / "packaging" / "make_zip.py"), "--build", build, "--dist",
         str(folder)], check=True, capture_output=True, text=True)
    return Path(run.stdout.strip())


def device_info(folder):
    library = ctypes.CDLL(str(folder / "kestrel/native/lib/libkestrel.so"))
    library.kestrelNewDevice.restype = ctypes.c_void_p
    library.kestrelGetDeviceInfo.restype = ctypes.c_char_p
    library.kestrelGetDeviceInfo.argtypes = [ctypes.c_void_p]
    library.kestrelReleaseDevice.argtypes = [ctypes.c_void_p]
    device = library.kestrelNewDevice()
    info = json.loads(library.kestrelGetDeviceInfo(device))
    library.kestrelReleaseDevice(device)
    return info


def main():
    build = sys.argv[1]
    faults = []
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        first, second = make(build, folder / "a"), make(build, folder / "b")
        if first.read_bytes() != second.read_bytes():
            faults.append("two zips of the same input differ")
        with zipfile.ZipFile(first) as archive:
            names = archive.namelist()
            archive.extractall(folder)
        faults += [f"missing in the zip: {name}" for name in WANTED if name not in names]
        faults += [f"does not belong into the zip: {name}" for name in names
                   if "__pycache__" in name or not name.startswith("kestrel/")]
        info = {} if faults else device_info(folder)
    print("\n".join(faults) or f"{first.name}: {len(names)} files; {json.dumps(info)}")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
