# SPDX-License-Identifier: GPL-3.0-or-later
"""The dynamic symbols of a 64-bit little-endian ELF file, and renaming them in place.

A new name has the old one's length and the old one's GNU hash (h * 33 + c for each character c), so
that no table of the file has to be rebuilt. Files with the older DT_HASH table are refused: their
hash is another one.
"""

import re
import struct
from dataclasses import dataclass
from pathlib import Path

DYNSYM, OLD_HASH, VERNEED, VERSYM = 11, 5, 0x6FFFFFFE, 0x6FFFFFFF
UNDEFINED, ABSOLUTE = 0, 0xFFF1
LOCAL = 0
HIDDEN_VERSION = 0x8000  # flag beside a symbol's version
HEADER, SECTION, SYMBOL = "<16sHHIQQQIHHHHHH", "<IIQQQQIIQQ", "<IBBHQQ"


class ElfError(Exception):
    """A file that cannot be read or renamed, with the reason."""


@dataclass
class Symbol:
    name_at: int   # offset of the name in the file
    name: str
    bind: int
    section: int   # UNDEFINED, ABSOLUTE or a section's number
    version: str   # that it needs, "GLIBC_2.34"; empty where it is defined or needs none

    @property
    def defined(self):
        return self.section != UNDEFINED


def gnu_hash(name):
    value = 5381
    for byte in name.encode("latin-1"):
        value = (value * 33 + byte) & 0xFFFFFFFF
    return value


def private_name(name):
    """A name of the same length and GNU hash: at the first letter followed by a small letter, the
    former goes up by 1 and the latter down by 33 (`rtc` becomes `sSc`, `3tbb` becomes `3uAb`). Where
    there is no such pair, the other way round at the first two capitals (`_ZTIa`, `_YuIa`)."""
    for step, firsts, seconds in ((1, "A-Ya-y", "b-z"), (-1, "B-Zb-z", "A-Y")):
        pair = re.search(f"[{firsts}][{seconds}]", name)
        if pair:
            made = "".join(map(chr, (ord(pair[0][0]) + step, ord(pair[0][1]) - 33 * step)))
            return name[:pair.start()] + made + name[pair.end():]
    raise ElfError(f"no name with the hash of {name}")


class Elf:
    def __init__(self, path):
        self.path = Path(path)
        self.data = bytearray(self.path.read_bytes())
        if self.data[:6] != b"\x7fELF\x02\x01":
            raise ElfError(f"{path} is no 64-bit little-endian ELF file")
        header = struct.unpack_from(HEADER, self.data)
        offset, size, count = header[6], header[11], header[12]
        self._sections = [struct.unpack_from(SECTION, self.data, offset + size * index)
                          for index in range(count)]

    def _of_kind(self, kind):
        return next((section for section in self._sections if section[1] == kind), None)

    def _text(self, at):
        return self.data[at:self.data.index(0, at)].decode("latin-1")

    def symbols(self):
        """The dynamic symbols, without the empty first one."""
        table, versions = self._of_kind(DYNSYM), self._of_kind(VERSYM)
        names, needed = self._sections[table[6]][4], self._needed_versions()
        found = []
        for index in range(1, table[5] // table[9]):
            name, info, _, section, _, _ = struct.unpack_from(SYMBOL, self.data,
                                                              table[4] + index * table[9])
            version = 0
            if versions:
                version, = struct.unpack_from("<H", self.data, versions[4] + 2 * index)
            found.append(Symbol(names + name, self._text(names + name), info >> 4, section,
                                needed.get(version & ~HIDDEN_VERSION, "")))
        return found

    def _needed_versions(self):
        """{number in this file: name of a version that it needs}."""
        section, found = self._of_kind(VERNEED), {}
        if section is None:
            return found
        at, names = section[4], self._sections[section[6]][4]
        for _ in range(section[7]):
            _, parts, _, part, following = struct.unpack_from("<HHIII", self.data, at)
            part += at
            for _ in range(parts):
                _, _, number, name, step = struct.unpack_from("<IHHII", self.data, part)
                found[number] = self._text(names + name)
                part += step
            at += following
        return found

    def needed_versions(self):
        return set(self._needed_versions().values())

    def exports(self):
        """Names that others can bind to, without those that stand for a version."""
        return {symbol.name for symbol in self.symbols()
                if symbol.defined and symbol.bind != LOCAL and symbol.section != ABSOLUTE}

    def rename(self, names):
        """Rename symbols, {old: new}. Raises ElfError where a change would reach other names too, as
        the linker lets a name be the end of a longer one."""
        if self._of_kind(OLD_HASH):
            raise ElfError(f"{self.path} has a DT_HASH table")
        before = self.symbols()
        for symbol in before:
            new = names.get(symbol.name)
            if new:
                if len(new) != len(symbol.name) or gnu_hash(new) != gnu_hash(symbol.name):
                    raise ElfError(f"{new} has not the length and the hash of {symbol.name}")
                self.data[symbol.name_at:symbol.name_at + len(new)] = new.encode("latin-1")
        for old, new in zip(before, self.symbols()):
            if new.name != names.get(old.name, old.name) or new.version != old.version:
                raise ElfError(f"{self.path}: {old.name} would become {new.name}")

    def replace_text(self, old, new):
        """Change a whole string of the file, wherever it stands; both of the same length."""
        found = b"\0" + old.encode() + b"\0"
        if len(old) != len(new) or found not in self.data:
            raise ElfError(f"{self.path}: no text {old} that could become {new}")
        self.data = self.data.replace(found, b"\0" + new.encode() + b"\0")

    def has_text(self, text):
        return b"\0" + text.encode() + b"\0" in self.data

    def write(self, path):
        Path(path).write_bytes(self.data)
