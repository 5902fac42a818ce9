# SPDX-License-Identifier: GPL-3.0-or-later
"""The dynamic symbols of a 64-bit little-endian ELF file, and renaming them in place.

A new name has the old one's length and the old one's GNU hash (h * 33 + c for each character c), so
that no table of the file has to be rebuilt. Names of symbol versions are hashed in their own
records, which are rewritten. Files with the older DT_HASH table are refused: their hash differs.
"""

import struct
from dataclasses import dataclass
from pathlib import Path

DYNSYM, OLD_HASH, VERDEF, VERNEED, VERSYM = 11, 5, 0x6FFFFFFD, 0x6FFFFFFE, 0x6FFFFFFF
UNDEFINED, ABSOLUTE = 0, 0xFFF1
LOCAL, GLOBAL, WEAK, UNIQUE = 0, 1, 2, 10
BASE_VERSION = 1  # flag of the version that names the file itself
HEADER, SECTION, SYMBOL = "<16sHHIQQQIHHHHHH", "<IIQQQQIIQQ", "<IBBHQQ"


class ElfError(Exception):
    """A file that cannot be read or renamed, with the reason."""


@dataclass
class Symbol:
    at: int        # offset of the record in the file
    name_at: int   # offset of the name in the file
    name: str
    bind: int
    section: int   # UNDEFINED, ABSOLUTE or a section's number

    @property
    def defined(self):
        return self.section != UNDEFINED


@dataclass
class Version:
    hash_at: int   # offset of its hash in the file; 0 for a parent, which has none
    name_at: int
    name: str
    defined: bool  # by this file, else needed by it
    base: bool


def gnu_hash(name):
    value = 5381
    for byte in name.encode("latin-1"):
        value = (value * 33 + byte) & 0xFFFFFFFF
    return value


def version_hash(name):
    """The hash of System V's ABI, which version records keep."""
    value = 0
    for byte in name.encode("latin-1"):
        value = (value << 4) + byte
        high = value & 0xF0000000
        value = (value ^ (high >> 24)) & ~high
    return value


def private_name(name):
    """A name of the same length and GNU hash: at the first letter followed by a small letter, the
    former goes up by 1 and the latter down by 33 (`rtc` becomes `sSc`, `3tbb` becomes `3uAb`)."""
    for index, (first, second) in enumerate(zip(name, name[1:])):
        if first.isalpha() and first not in "zZ" and "b" <= second <= "z":
            made = name[:index] + chr(ord(first) + 1) + chr(ord(second) - 33) + name[index + 2:]
            if gnu_hash(made) != gnu_hash(name):
                raise ElfError(f"the hash of {name} changed with {made}")
            return made
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
        table = self._of_kind(DYNSYM)
        names = self._sections[table[6]][4]
        found = []
        for at in range(table[4] + table[9], table[4] + table[5], table[9]):
            name, info, _, section, _, _ = struct.unpack_from(SYMBOL, self.data, at)
            found.append(Symbol(at, names + name, self._text(names + name), info >> 4, section))
        return found

    def versions(self):
        """Every version that the file defines or needs."""
        return [*self._defined_versions(), *self._needed_versions()]

    def _records(self, kind):
        """(offset of the section's first record, how many, offset of its strings)."""
        section = self._of_kind(kind)
        return (section[4], section[7], self._sections[section[6]][4]) if section else (0, 0, 0)

    def _defined_versions(self):
        at, count, names = self._records(VERDEF)
        for _ in range(count):
            _, flags, _, parts, _, part, following = struct.unpack_from("<HHHHIII", self.data, at)
            part += at
            for index in range(parts):
                name, step = struct.unpack_from("<II", self.data, part)
                yield Version(0 if index else at + 8, names + name, self._text(names + name), True,
                              bool(flags & BASE_VERSION))
                part += step
            at += following

    def _needed_versions(self):
        at, count, names = self._records(VERNEED)
        for _ in range(count):
            _, parts, _, part, following = struct.unpack_from("<HHIII", self.data, at)
            part += at
            for _ in range(parts):
                _, _, _, name, step = struct.unpack_from("<IHHII", self.data, part)
                yield Version(part, names + name, self._text(names + name), False, False)
                part += step
            at += following

    def exports(self):
        """Names that others can bind to, without those that stand for a version."""
        return {symbol.name for symbol in self.symbols()
                if symbol.defined and symbol.bind != LOCAL and symbol.section != ABSOLUTE}

    def is_versioned(self):
        return any(version.defined and not version.base for version in self.versions())

    def rename(self, new_names, new_versions):
        """Both are {old: new} of the same lengths. Raises ElfError where a change would reach other
        names too, as the linker lets a name be the end of a longer one."""
        if self._of_kind(OLD_HASH):
            raise ElfError(f"{self.path} has a DT_HASH table")
        symbols, versions = self.symbols(), self.versions()
        changes = {item.name_at: new_names[item.name] for item in symbols if item.name in new_names}
        changes |= {item.name_at: new_versions[item.name] for item in versions
                    if item.name in new_versions}
        for at, name in changes.items():
            self.data[at:at + len(name)] = name.encode("latin-1")
        for item in versions:
            if item.hash_at and item.name in new_versions:
                struct.pack_into("<I", self.data, item.hash_at,
                                 version_hash(new_versions[item.name]))
        self._check(symbols, self.symbols(), {**new_versions, **new_names})
        self._check(versions, self.versions(), new_versions)

    def _check(self, before, after, wanted):
        for old, new in zip(before, after, strict=True):
            if new.name != wanted.get(old.name, old.name):
                raise ElfError(f"{self.path}: {old.name} would become {new.name}")

    def unshare_unique(self):
        """Symbols that the loader makes one of in a process, whatever library they come from, become
        ordinary ones."""
        for symbol in self.symbols():
            if symbol.bind == UNIQUE:
                self.data[symbol.at + 4] = self.data[symbol.at + 4] & 0xF | GLOBAL << 4

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
