# SPDX-License-Identifier: GPL-3.0-or-later
"""The ctypes declarations agree with kestrel.h, and a library that cannot be used is explained."""

import ctypes.util
import re
import tempfile
import unittest
from pathlib import Path

from kestrel.native import capi, loader
from support import ADDON, run_blender

HEADER = (ADDON.parent / "core/include/kestrel/kestrel.h").read_text()
CODE = re.sub(r"/\*.*?\*/", "", HEADER, flags=re.S)
TYPES = {"float": "c_float", "bool": "c_bool", "int32_t": "c_int", "uint32_t": "c_uint",
         "uint64_t": "c_ulong", "size_t": "c_ulong"}


def struct_fields(name):
    """[(field, ctypes name)] of a struct in the header, in order."""
    body = re.search(rf"typedef struct {name} {{(.*?)}} {name};", CODE, re.S).group(1)
    fields = []
    for line in filter(None, (line.strip() for line in body.split(";"))):
        base = re.sub(r"\bconst\b", "", line).split()[0]
        kind, names = re.match(r"(.*?)(\*?\s*\w[\w\[\], ]*)$", line).groups()
        for part in names.split(","):
            field = re.search(r"(\w+)(?:\[(\d+)\])?$", part.strip()).groups()
            is_pointer = "*" in line
            fields.append((field[0], base.rstrip("*"), is_pointer, int(field[1] or 1)))
    return fields


def ctypes_field(kind):
    """(element type's name, is a pointer, count) of a ctypes field."""
    if kind is ctypes.c_char_p:
        return "char", True, 1
    if issubclass(kind, ctypes._Pointer):
        return kind._type_.__name__, True, 1
    if issubclass(kind, ctypes.Array):
        return kind._type_.__name__, False, kind._length_
    return kind.__name__, False, 1


class HeaderTest(unittest.TestCase):
    def test_every_function_is_declared(self):
        declared = re.findall(r"KESTREL_API[^;(]*?(kestrel\w+)\(", CODE)
        self.assertGreater(len(declared), 30)
        self.assertEqual(sorted(capi.FUNCTIONS), sorted(declared))

    def test_functions_take_as_many_arguments(self):
        for name, (_, arguments) in capi.FUNCTIONS.items():
            listed = re.search(rf"\b{name}\(([^)]*)\)", CODE).group(1)
            count = 0 if listed.strip() == "void" else len(listed.split(","))
            self.assertEqual(len(arguments), count, name)

    def test_structs_have_the_same_fields(self):
        for struct in (capi.Mesh, capi.TextureOptions, capi.Material, capi.Light, capi.Object,
                       capi.Camera, capi.World):
            wanted = struct_fields(f"Kestrel{struct.__name__}")
            self.assertEqual([name for name, _ in struct._fields_], [f[0] for f in wanted])
            for (name, kind), (_, base, is_pointer, count) in zip(struct._fields_, wanted):
                found = ctypes_field(kind)
                self.assertEqual(found[1:], (is_pointer, count), f"{struct.__name__}.{name}")
                if not is_pointer:
                    self.assertEqual(found[0], TYPES[base], f"{struct.__name__}.{name}")

    def test_constants(self):
        values = {**dict(re.findall(r"KESTREL_(\w+) = (\d+)", CODE)),
                  **dict(re.findall(r"#define KESTREL_(\w+) (\d+)", CODE))}
        prefixes = ("ERROR_", "LOG_", "EXTENSION_", "ALPHA_", "LIGHT_", "KIND_", "WORLD_")
        names = [name for name in dir(capi) if name.startswith(prefixes)] + [
            "ABI_VERSION", "PERSPECTIVE", "ORTHOGRAPHIC"]
        for name in names:
            self.assertEqual(getattr(capi, name), int(values[name]), name)


class LibraryTest(unittest.TestCase):
    def test_is_loaded(self):
        self.assertEqual(loader.error(), "")
        self.assertRegex(loader.library().version(), r"^\d+\.\d+\.\d+$")

    def test_errors_carry_the_librarys_text(self):
        scene = capi.Scene(loader.library())
        self.addCleanup(scene.release)
        with self.assertRaisesRegex(capi.KestrelError, "no_such_setting"):
            scene.set_setting("no_such_setting", "1")

    def test_released_scene_is_an_error(self):
        scene = capi.Scene(loader.library())
        scene.release()
        scene.release()
        with self.assertRaisesRegex(capi.KestrelError, "freed"):
            scene.commit()


class MissingLibraryTest(unittest.TestCase):
    """The add-on stays enabled and says what is wrong."""

    SCRIPT = ("import bpy; from kestrel.ui import render; from kestrel.native import loader; "
              "s = bpy.context.scene; s.render.engine = 'KESTREL'; "
              "print('PANEL', render.KESTREL_RENDER_PT_library.shown(None)); "
              "print('REASON', loader.error()); bpy.ops.render.render()")

    def output(self, library):
        with tempfile.TemporaryDirectory() as folder:
            done = run_blender(folder, "--python-expr", self.SCRIPT, library=library)
        return done.stdout + done.stderr

    def test_no_file(self):
        output = self.output("/nowhere/libkestrel.so")
        self.assertIn("PANEL True", output)
        self.assertRegex(output, "REASON There is no Kestrel library at /nowhere/libkestrel.so. "
                                 "Install the add-on")
        self.assertIn("Error: There is no Kestrel library", output)

    def test_another_library(self):
        libm = next(Path(folder, "libm.so.6") for folder in
                    ("/lib/x86_64-linux-gnu", "/lib/aarch64-linux-gnu", "/lib64", "/usr/lib")
                    if Path(folder, "libm.so.6").exists())
        self.assertRegex(self.output(str(libm)), "REASON .* speaks interface version 0")

    def test_not_a_library(self):
        with tempfile.NamedTemporaryFile(suffix=".so") as file:
            file.write(b"not a library")
            file.flush()
            self.assertRegex(self.output(file.name), "REASON .* could not be loaded: .*Install")
