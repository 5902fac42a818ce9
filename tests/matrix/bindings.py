# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads what the loader bound while Blender rendered with Kestrel (LD_DEBUG=bindings).

Allowed are Kestrel's own libraries, glibc, and for malloc and its like whichever allocator the process
has. Everything else, Blender's own Embree and TBB above all, is a fault; so is anything of Blender's
that was bound to Kestrel's libraries.
"""

import re
from collections import Counter
from pathlib import Path

OWN = "libkestrel"  # what the names of all of Kestrel's own libraries begin with
GLIBC = re.compile(r"^(lib(c|m|dl|rt|pthread)\.so\.\d+|ld-linux-x86-64\.so\.2)$")
ALLOCATOR = re.compile(r"^(malloc|calloc|realloc|free|memalign|posix_memalign|aligned_alloc|"
                       r"malloc_usable_size|valloc|pvalloc|reallocarray)$")
LINE = re.compile(r"binding file (\S+) \[\d+\] to (\S+) \[\d+\]: \w+ symbol `([^']+)'")


def bindings(logs):
    """Set of (library, library it binds to, symbol) with one of Kestrel's own on either side."""
    found = set()
    for log in logs:
        with open(log, encoding="utf-8", errors="replace") as lines:
            found |= {match.groups() for line in lines if OWN in line
                      for match in [LINE.search(line)] if match}
    return found


def is_own(path):
    return Path(path).name.startswith(OWN)


def is_allowed(source, target, symbol):
    name = Path(target).name
    if not is_own(source):
        return False
    return is_own(target) or bool(GLIBC.match(name) or ALLOCATOR.match(symbol))


def report(found):
    """(text that lists library by library what was bound, faults)."""
    counts = Counter((Path(source).name, Path(target).name) for source, target, _ in found)
    text = [f"{source} -> {target}: {count}" for (source, target), count in sorted(counts.items())]
    text += ["", *(f"{Path(source).name} {Path(target).name} {symbol}"
                   for source, target, symbol in sorted(found))]
    faults = [f"{source} binds {symbol} of {target}" for source, target, symbol in sorted(found)
              if not is_allowed(source, target, symbol)]
    libraries = {Path(source).name for source, _, _ in found if is_own(source)}
    for part in ("libkestrel.so", "embree", "tbb", "epoxy", "stdc++", "gcc_s"):
        if not any(part in name for name in libraries):
            faults.append(f"nothing was bound by {part}: was Kestrel loaded at all?")
    return "\n".join(text) + "\n", faults
