# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes libkestrel.so self-contained: it and every library it needs, but for glibc's, in one folder.

    python3 packaging/bundle.py build/libkestrel.so FOLDER

Blender has libraries of its own loaded, Embree, TBB and libstdc++ among them, and the loader looks
into those first, whatever a library's file is called. So the copies get private file names, private
names for all their symbols and paths relative to their own folder. Then nothing in the folder can
bind to Blender's copies, and nothing of Blender's to them. Versions of symbols are no protection: a
library without any, such as libunwind, stands in for all of them.
"""

import re
import subprocess
import sys
from pathlib import Path

import elf

# glibc's own, which must be the process's one.
SYSTEM = re.compile(r"^(lib(c|m|dl|rt|pthread)\.so\.\d+|ld-linux.*|linux-vdso.*)$")

# What TBB looks up by name at run time: its allocator and its topology helper. Blender may have both.
LOOKED_UP = re.compile(r"^(scalable_\w+|__TBB_\w+)$")
TBB_LOADS = ("libtbbmalloc.so.2", "libtbbbind_2_5.so.3", "libtbbbind_2_0.so.3", "libtbbbind.so.3",
             "libirml.so.1")


class BundleError(Exception):
    """The reason why there can be no bundle."""


def run(*command):
    try:
        return subprocess.run(command, check=True, capture_output=True, text=True).stdout
    except FileNotFoundError as error:
        raise BundleError(f"{command[0]} is not installed; './dev' installs what is needed") from error
    except subprocess.CalledProcessError as error:
        raise BundleError(f"{' '.join(map(str, command))}: {error.stderr.strip()}") from error


def needed_libraries(library):
    """{soname: path} of all that is to be bundled, in the order of `ldd`."""
    found = {}
    for line in run("ldd", str(library)).splitlines():
        match = re.match(r"\s*(\S+)(?: => (\S+))? \(0x", line)
        if match is None:
            raise BundleError(f"{library}: {line.strip()}")
        if not SYSTEM.match(Path(match[1]).name):
            found[match[1]] = Path(match[2] or match[1])
    return found


def private_soname(soname):
    """libtbb.so.12 becomes libkestrel_tbb.so.12."""
    return "libkestrel_" + soname.removeprefix("lib")


def chosen_names(library, copies):
    """{symbol: private name} for the whole bundle: what the copies export, and what TBB looks up."""
    exported = set().union(*(file.exports() for file in copies))
    imported = [symbol for file in (library, *copies) for symbol in file.symbols()
                if not symbol.defined]
    # A name that is meant to come from glibc keeps its name everywhere.
    exported -= {symbol.name for symbol in imported if symbol.version.startswith("GLIBC_")}
    looked_up = {symbol.name for symbol in imported if LOOKED_UP.match(symbol.name)}
    names = {name: elf.private_name(name) for name in sorted(exported | looked_up)}
    taken = set(names) | {symbol.name for symbol in imported}
    if len(set(names.values())) != len(names) or not taken.isdisjoint(names.values()):
        raise BundleError("two symbols would get the same name")
    return names


def make_private(file, names):
    file.rename(names)
    for name in filter(LOOKED_UP.match, names):
        if file.has_text(name):
            file.replace_text(name, names[name])
    for name in filter(file.has_text, TBB_LOADS):
        file.replace_text(name, "k" + name[1:])


def set_paths(path, soname, sonames):
    """Write the private sonames of `sonames` into the file at `path`."""
    replaced = [word for old in sonames for word in ("--replace-needed", old, private_soname(old))]
    # patchelf 0.14 mixes up the arguments of several changes made at once.
    for words in (["--set-soname", soname], ["--set-rpath", "$ORIGIN"], replaced):
        run("patchelf", *words, str(path))


def bundle(library, folder):
    """Write the bundle; returns its files' paths and {soname: path} of what was bundled."""
    library = Path(library)
    needed = needed_libraries(library)
    copies = {soname: elf.Elf(path) for soname, path in needed.items()}
    original = elf.Elf(library)
    names = chosen_names(original, copies.values())
    folder.mkdir(parents=True, exist_ok=True)
    written = []
    for soname, file in {library.name: original, **copies}.items():
        make_private(file, names)
        private = soname if soname == library.name else private_soname(soname)
        target = folder / private
        target.unlink(missing_ok=True)  # a running Blender may have the old one mapped
        file.write(target)
        target.chmod(0o755)
        set_paths(target, private, needed)
        run("strip", "--strip-unneeded", str(target))
        written.append(target)
    return written, needed


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    try:
        written, _ = bundle(sys.argv[1], Path(sys.argv[2]))
    except (BundleError, elf.ElfError) as error:
        sys.exit(f"bundle: {error}")
    print("\n".join(map(str, written)))


if __name__ == "__main__":
    main()
