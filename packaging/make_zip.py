# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes dist/kestrel-VERSION-linux-x64.zip: the add-on with the built libraries inside.

    python3 packaging/make_zip.py [--build build] [--dist dist]

The libraries use the system's Embree, TBB, libepoxy and OpenImageIO. The same input gives the same
bytes. Prints the zip's path.
"""

import argparse
import platform
import re
import sys
import zipfile
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[1]
ADDON = REPOSITORY / "blender_addon" / "kestrel"
LIBRARIES = ("libkestrel.so", "libkestrel_oiio.so")
DATE = (2020, 1, 1, 0, 0, 0)  # of every entry


def project_version():
    text = (REPOSITORY / "CMakeLists.txt").read_text()
    return re.search(r"project\(kestrel VERSION ([0-9.]+)", text).group(1)


def addon_files():
    """The add-on's own files as (name in the zip, path)."""
    for path in sorted(ADDON.rglob("*")):
        relative = path.relative_to(ADDON)
        if path.is_file() and "__pycache__" not in relative.parts and relative.parts[:2] != (
                "native", "lib"):
            yield f"kestrel/{relative.as_posix()}", path


def entries(build):
    yield from addon_files()
    for library in LIBRARIES:
        yield f"kestrel/native/lib/{library}", build / library
    yield "kestrel/LICENSE", REPOSITORY / "LICENSE"
    yield "kestrel/LICENSES.md", REPOSITORY / "packaging" / "LICENSES.md"


def write_zip(target, build):
    part = target.with_suffix(".part")
    with zipfile.ZipFile(part, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, path in entries(build):
            info = zipfile.ZipInfo(name, DATE)
            info.external_attr = (0o755 if path.suffix == ".so" else 0o644) << 16
            info.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(info, path.read_bytes())
    part.replace(target)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--build", type=Path, default=REPOSITORY / "build")
    parser.add_argument("--dist", type=Path, default=REPOSITORY / "dist")
    args = parser.parse_args()
    missing = [str(path) for _, path in entries(args.build) if not path.is_file()]
    if missing:
        sys.exit(f"make_zip: not there: {', '.join(missing)}. Run './dev build' first.")
    machine = {"x86_64": "x64", "aarch64": "arm64"}.get(platform.machine(), platform.machine())
    args.dist.mkdir(parents=True, exist_ok=True)
    target = args.dist / f"kestrel-{project_version()}-linux-{machine}.zip"
    write_zip(target, args.build)
    print(target)


if __name__ == "__main__":
    main()
