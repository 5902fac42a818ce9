# SPDX-License-Identifier: GPL-3.0-or-later
"""The licence texts of what a package holds, as (name in the package, bytes).

Debian keeps them in /usr/share/doc/PACKAGE/copyright, and the long texts those refer to in
/usr/share/common-licenses.
"""

import re
import subprocess
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[1]
DOCUMENTS = Path("/usr/share/doc")
COMMON = Path("/usr/share/common-licenses")
HEADER_PACKAGES = ("libglm-dev", "libfmt-dev", "nlohmann-json3-dev")  # compiled into libkestrel.so


class LicenceError(Exception):
    """A library whose licence is not at hand."""


def package_of(library):
    """The package that a library's file came with."""
    path = str(Path(library).resolve())
    # Where /lib is a link to /usr/lib, dpkg may know the file by either path.
    for name in (path, path.removeprefix("/usr")):
        run = subprocess.run(["dpkg", "-S", name], capture_output=True, text=True)
        if run.returncode == 0:
            return run.stdout.split(":", 1)[0]
    raise LicenceError(f"no package holds {path}, so its licence is not at hand")


def texts(libraries, extra_packages=()):
    """The texts for `libraries`, for the headers in libkestrel.so and for `extra_packages`."""
    packages = {package_of(path) for path in libraries} | {*HEADER_PACKAGES, *extra_packages}
    found, common = {}, set()
    for package in sorted(packages):
        path = DOCUMENTS / package / "copyright"
        if not path.is_file():
            raise LicenceError(f"{path} is not there")
        found[f"licenses/{package}.txt"] = path.read_bytes()
        common |= set(re.findall(r"common-licenses/([A-Za-z0-9.-]*[A-Za-z0-9])",
                                 path.read_text(encoding="utf-8", errors="replace")))
    for name in sorted(common):
        if (COMMON / name).is_file():
            found[f"licenses/{name}.txt"] = (COMMON / name).read_bytes()
    found["LICENSE"] = (REPOSITORY / "LICENSE").read_bytes()
    found["LICENSES.md"] = (REPOSITORY / "packaging" / "LICENSES.md").read_bytes()
    return sorted(found.items())
