# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes dist/kestrel-VERSION-linux-x64.zip: the add-on with everything it needs inside.

    python3 packaging/make_zip.py [--build build] [--dist dist]

One file for every Blender: an add-on for 3.4 to 4.1, an extension for 4.2 and later, as both
installers take a zip of one folder. The libraries are self-contained (bundle.py); the image plug-in
is not among them. The same input gives the same bytes. Prints the zip's path.
"""

import argparse
import platform
import re
import sys
import tempfile
import zipfile
from pathlib import Path

import bundle
import elf
import licences

REPOSITORY = Path(__file__).resolve().parents[1]
ADDON = REPOSITORY / "blender_addon" / "kestrel"
FAULTS = (bundle.BundleError, elf.ElfError, licences.LicenceError)  # what keeps a package from being made
DATE = (2020, 1, 1, 0, 0, 0)  # of every entry


def project_version():
    text = (REPOSITORY / "CMakeLists.txt").read_text()
    return re.search(r"project\(kestrel VERSION ([0-9.]+)", text).group(1)


def machine():
    return {"x86_64": "x64", "aarch64": "arm64"}.get(platform.machine(), platform.machine())


def package_name():
    return f"kestrel-{project_version()}-linux-{machine()}"


def parse_arguments(description):
    """--build and --dist, as both packages take them; the folder of --dist is made."""
    parser = argparse.ArgumentParser(description=description.split("\n")[0])
    parser.add_argument("--build", type=Path, default=REPOSITORY / "build")
    parser.add_argument("--dist", type=Path, default=REPOSITORY / "dist")
    args = parser.parse_args()
    args.dist.mkdir(parents=True, exist_ok=True)
    return args


def addon_files():
    """The add-on's own files as (name in the zip, path)."""
    for path in sorted(ADDON.rglob("*")):
        relative = path.relative_to(ADDON)
        if path.is_file() and "__pycache__" not in relative.parts and relative.parts[:2] != (
                "native", "lib"):
            yield f"kestrel/{relative.as_posix()}", path


def entries(build, scratch):
    """Every file as (name in the zip, bytes)."""
    for name, path in addon_files():
        yield name, path.read_bytes()
    libraries, bundled = bundle.bundle(build / "libkestrel.so", scratch)
    for path in libraries:
        yield f"kestrel/native/lib/{path.name}", path.read_bytes()
    for name, text in licences.texts(bundled.values()):
        yield f"kestrel/{name}", text


def write_zip(target, build):
    part = target.with_suffix(".part")
    with tempfile.TemporaryDirectory() as scratch, \
            zipfile.ZipFile(part, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in entries(build, Path(scratch)):
            info = zipfile.ZipInfo(name, DATE)
            info.external_attr = (0o755 if ".so" in name else 0o644) << 16
            info.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(info, data)
    part.replace(target)


def main():
    args = parse_arguments(__doc__)
    if not (args.build / "libkestrel.so").is_file():
        sys.exit(f"make_zip: there is no libkestrel.so in {args.build}. Run './dev build' first.")
    target = args.dist / f"{package_name()}.zip"
    try:
        write_zip(target, args.build)
    except FAULTS as error:
        sys.exit(f"make_zip: {error}")
    print(target)


if __name__ == "__main__":
    main()
