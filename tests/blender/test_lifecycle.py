# SPDX-License-Identifier: GPL-3.0-or-later
"""Enabling and disabling leave nothing behind; the settings are those of the parameter table."""

import unittest

import addon_utils
import bpy
from kestrel import properties, session
from kestrel.native import loader
from support import SceneTest


def state():
    """Everything that registering changes."""
    return {
        "engines": sorted(c.__name__ for c in bpy.types.RenderEngine.__subclasses__()
                          if c.is_registered),
        "panels": sorted(name for name in dir(bpy.types) if "KESTREL" in name.upper()),
        "shared": sorted(p.__name__ for p in bpy.types.Panel.__subclasses__()
                         if "KESTREL" in getattr(p, "COMPAT_ENGINES", ())
                         and not p.__name__.startswith("KESTREL")),
        "handlers": {name: len(getattr(bpy.app.handlers, name)) for name in dir(bpy.app.handlers)
                     if isinstance(getattr(bpy.app.handlers, name), list)},
        "properties": sorted(t.__name__ for t in (bpy.types.Scene, bpy.types.Object,
                                                  bpy.types.ViewLayer, bpy.types.Material)
                             if hasattr(t, "kestrel")),
        "sessions": session.count(),
    }


class EnableTest(unittest.TestCase):
    def test_five_times(self):
        session.drop_all()
        enabled = state()
        self.assertEqual(len(enabled["properties"]), 4)
        self.assertIn("RENDER_PT_format", enabled["shared"])
        self.addCleanup(addon_utils.enable, "kestrel")
        addon_utils.disable("kestrel")
        disabled = state()
        self.assertEqual(disabled["properties"], [])
        self.assertEqual(disabled["shared"], [])
        self.assertEqual(disabled["panels"], [])
        for _ in range(5):
            addon_utils.enable("kestrel")
            self.assertEqual(state(), enabled)
            addon_utils.disable("kestrel")
            self.assertEqual(state(), disabled)


class PropertiesTest(SceneTest):
    def owner(self, row):
        if row["scope"] == "scene":
            return self.scene.kestrel
        if "Thing" not in bpy.data.objects:
            self.link("Thing", None)
        return bpy.data.objects["Thing"].kestrel

    def test_match_the_table(self):
        table = loader.parameter_table()
        self.assertGreater(len(table), 10)
        for row in table:
            with self.subTest(row["name"]):
                made = self.owner(row).bl_rna.properties[row["name"]]
                self.assertEqual(made.description, row["help"])
                if row["type"] == "enum":
                    self.assertEqual([item.identifier for item in made.enum_items], row["items"])
                    self.assertEqual(made.default, row["default"])
                elif row["type"] in ("int", "float"):
                    self.assertAlmostEqual(made.default, float(row["default"]), 5)
                    self.assertAlmostEqual(made.hard_min, row["min"], 5)
                    self.assertAlmostEqual(made.hard_max, row["max"], 5)

    def test_labels(self):
        self.assertEqual(properties.label("budget_ms", "ms"), "Budget (ms)")
        self.assertEqual(properties.label("environment_ior"), "Environment IOR")
        self.assertEqual(properties.label("filter_width", "px"), "Filter Width")

    def test_settings_reach_the_core(self):
        self.camera()
        self.scene.kestrel.max_depth = 3
        self.scene.kestrel.selection = "none"
        self.scene.kestrel.budget_ms = 12.5
        self.scene.kestrel.ambient = (0.25, 0.5, 0.75)
        self.world((0.5, 0.25, 0.0), 2.0)
        self.render()
        core = next(iter(session._sessions.values())).scene
        self.assertEqual(core.get_setting("max_depth"), "3")
        self.assertEqual(core.get_setting("selection"), "none")
        self.assertEqual(core.get_setting("budget_ms"), "12.5")
        self.assertEqual([float(c) for c in core.get_setting("ambient").split()],
                         [1.25, 1.0, 0.75])

    def test_survive_saving(self):
        self.scene.kestrel.samples = 7
        self.owner({"scope": "object"}).relevance = 4.0
        self.scene.view_layers[0].kestrel.passes = {"Shadow", "ObjectId"}
        path = str(self.folder / "saved.blend")
        bpy.ops.wm.save_as_mainfile(filepath=path)
        bpy.ops.wm.open_mainfile(filepath=path)
        self.assertEqual(bpy.context.scene.kestrel.samples, 7)
        self.assertEqual(bpy.data.objects["Thing"].kestrel.relevance, 4.0)
        self.assertEqual(bpy.context.view_layer.kestrel.passes, {"Shadow", "ObjectId"})

    def test_sessions_go_when_a_file_is_opened(self):
        self.camera()
        self.render()
        self.assertEqual(session.count(), 1)
        bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
        self.assertEqual(session.count(), 0)
