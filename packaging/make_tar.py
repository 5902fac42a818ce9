# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes dist/kestrel-VERSION-linux-x64.tar for hosts other than Blender: the self-contained library, the
header, CMake and pkg-config files, and the `kestrel` command with its image plug-in.

    python3 packaging/make_tar.py [--build build] [--dist dist]

The command and the plug-in use the system's assimp and OpenImageIO. The same input gives the same
bytes. Prints the tar's path.
"""

import subprocess
import sys
import tarfile
import tempfile
from pathlib import Path

import bundle
import licences
import make_zip

DATE_S = 1577836800  # of every entry: 2020-01-01
COMMAND_PACKAGES = ("libcli11-dev",)  # compiled into the command


def stage(build, folder):
    """Install into `folder`, with the self-contained library in the place of the plain one."""
    subprocess.run(["cmake", "--install", build, "--prefix", folder], check=True,
                   stdout=subprocess.DEVNULL)
    library = next(folder.rglob("libkestrel.so"))
    _, bundled = bundle.bundle(build / "libkestrel.so", library.parent)
    for name, text in licences.texts(bundled.values(), COMMAND_PACKAGES):
        target = folder / "share" / "doc" / "kestrel" / name
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(text)


def write_tar(target, folder, top):
    def plain(info):
        info.mtime, info.uid, info.gid, info.uname, info.gname = DATE_S, 0, 0, "", ""
        info.mode = 0o755 if info.isdir() or info.mode & 0o100 else 0o644
        return info

    part = target.with_suffix(".part")
    with tarfile.open(part, "w", format=tarfile.PAX_FORMAT) as archive:
        for path in sorted(folder.rglob("*")):
            archive.add(path, f"{top}/{path.relative_to(folder)}", recursive=False, filter=plain)
    part.replace(target)


def main():
    args = make_zip.parse_arguments(__doc__)
    name = make_zip.package_name()
    target = args.dist / f"{name}.tar"
    try:
        with tempfile.TemporaryDirectory() as folder:
            stage(args.build, Path(folder))
            write_tar(target, Path(folder), name)
    except make_zip.FAULTS as error:
        sys.exit(f"make_tar: {error}")
    except subprocess.CalledProcessError:
        sys.exit(f"make_tar: 'cmake --install' failed for {args.build}; run './dev build' first")
    print(target)


if __name__ == "__main__":
    main()
