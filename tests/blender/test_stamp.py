# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures say how they were made."""

import re

import exr
from kestrel import stamp
from kestrel.native import loader
from mathutils import Matrix
from support import SceneTest


class StampTest(SceneTest):
    def header(self, file_format="OPEN_EXR_MULTILAYER"):
        """Kestrel's fields of a rendered picture's file, by name without their layer."""
        self.render_planes(file_format=file_format)
        attributes, _ = exr.read_header((self.folder / "KESTREL.exr").read_bytes())
        found = {}
        for name, value in attributes.items():
            match = re.fullmatch(rf"kestrel\.{re.escape(self.layer)}\.(\w+)", name)
            if match:
                found[match[1]] = value.decode()
        return found

    @property
    def layer(self):
        return self.scene.view_layers[0].name

    def setUp(self):
        super().setUp()
        self.camera()
        self.light("SUN", 1.0)
        for index, x in enumerate((-1, 0, 1)):
            self.cube(f"Cube {index}", 0.5, None, Matrix.Translation((x, 0, 0)))
        self.scene.objects["Cube 1"].kestrel.shadows = "never"
        self.scene.objects["Cube 1"].kestrel.reflections = "never"
        self.scene.objects["Cube 1"].kestrel.refractions = "never"
        self.scene.kestrel.samples = 3
        self.scene.kestrel.primary = "rays"

    def test_fields(self):
        for file_format in ("OPEN_EXR_MULTILAYER", "OPEN_EXR"):
            with self.subTest(file_format):
                fields = self.header(file_format)
                self.assertEqual(fields["version"], loader.library().version())
                self.assertEqual(fields["samples"], "3")
                self.assertEqual(fields["primary"], "rays")
                self.assertEqual(fields["budget"], "unlimited")
                self.assertEqual(fields["selection"].split(":")[0], "2 of 3 objects")
                self.assertEqual(set(fields["selection"].split(": ")[1].split(", ")),
                                 {"Cube 0", "Cube 2"})
                self.assertRegex(fields["rays"], rf"primary {3 * 32 * 32}, shadow \d+")
                for name in ("total", "synchronization", "render", "update", "raster",
                             "heuristic", "trace", "blend"):
                    self.assertRegex(fields[f"{name}_time"], r"^\d+\.\d{3} s$")
                times = {name: float(fields[f"{name}_time"].split()[0])
                         for name in ("total", "synchronization", "render")}
                self.assertGreaterEqual(times["total"] + 0.002,
                                        times["synchronization"] + times["render"])

    def test_many_names_are_cut_short(self):
        objects = [{"name": f"O{i}", "area_px": 5, "effects": ["shadows"], "relevance": i}
                   for i in range(stamp.NAMES + 5)]
        text = stamp.selection(objects + [{"name": "x", "area_px": 0, "effects": ["shadows"],
                                           "relevance": 0.0}])
        self.assertTrue(text.startswith(f"{stamp.NAMES + 5} of {stamp.NAMES + 5} objects: O24, "))
        self.assertTrue(text.endswith(", O5, ..."))
        self.assertEqual(stamp.selection([]), "0 of 0 objects")
