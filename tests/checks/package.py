# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks the add-on's zip: made twice it has the same bytes, it holds what an installation needs and
nothing of OpenImageIO, it is small enough, from outside it needs only glibc, in the version that the
README names, its version is the same wherever it stands, and the library inside loads from there.

    python3 tests/checks/package.py BUILD
"""

import ctypes
import json
import re
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(REPOSITORY / "packaging"))
import bundle
import elf
import make_zip

WANTED = ("kestrel/__init__.py", "kestrel/blender_manifest.toml", "kestrel/LICENSE",
          "kestrel/LICENSES.md", "kestrel/native/lib/libkestrel.so")
LICENCES = ("embree", "tbb", "epoxy", "stdc++", "gcc", "glm", "fmt", "nlohmann")
LARGEST_BYTES = 40e6


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


def outside_faults(folder):
    """What the libraries need beyond each other, and of which glibc."""
    libraries = sorted((folder / "kestrel/native/lib").iterdir())
    faults, newest = [], (0, 0)
    for path in libraries:
        text = subprocess.run(["readelf", "-d", path], check=True, capture_output=True,
                              text=True).stdout
        needed = re.findall(r"NEEDED.*\[(.*)\]", text)
        faults += [f"{path.name} needs {name}" for name in needed
                   if name not in [p.name for p in libraries] and not bundle.SYSTEM.match(name)]
        if "[$ORIGIN]" not in text:
            faults.append(f"{path.name} does not look beside itself for what it needs")
        found = [re.fullmatch(r"GLIBC_(\d+)\.(\d+)(\.\d+)?", version)
                 for version in elf.Elf(path).needed_versions()]
        newest = max([newest, *(tuple(map(int, match.groups()[:2])) for match in found if match)])
    wanted = f"glibc {newest[0]}.{newest[1]}"
    if wanted not in (REPOSITORY / "README.md").read_text(encoding="utf-8"):
        faults.append(f"the zip needs {wanted}, and README.md does not say so")
    return faults


def version_faults(folder):
    version = make_zip.project_version()
    manifest = (folder / "kestrel/blender_manifest.toml").read_text()
    entry = (folder / "kestrel/__init__.py").read_text()
    faults = []
    if f'\nversion = "{version}"\n' not in manifest:
        faults.append(f"blender_manifest.toml has another version than {version}")
    if f'"version": ({version.replace(".", ", ")})' not in entry:
        faults.append(f"bl_info has another version than {version}")
    return faults


def main():
    build = sys.argv[1]
    faults = []
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        first, second = make(build, folder / "a"), make(build, folder / "b")
        if first.read_bytes() != second.read_bytes():
            faults.append("two zips of the same input differ")
        size = first.stat().st_size
        if size > LARGEST_BYTES:
            faults.append(f"the zip has {size / 1e6:.1f} MB")
        with zipfile.ZipFile(first) as archive:
            names = archive.namelist()
            archive.extractall(folder)
        faults += [f"missing in the zip: {name}" for name in WANTED if name not in names]
        faults += [f"no licence of {part} in the zip" for part in LICENCES
                   if not any(part in name for name in names if "/licenses/" in name)]
        faults += [f"does not belong into the zip: {name}" for name in names
                   if "__pycache__" in name or not name.startswith("kestrel/")
                   or re.search("oiio|OpenImageIO", name)]
        faults += outside_faults(folder) + version_faults(folder)
        info = {} if faults else device_info(folder)
    print("\n".join(faults) or
          f"{first.name}: {len(names)} files, {size / 1e6:.1f} MB; {json.dumps(info)}")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
