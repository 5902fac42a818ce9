# SPDX-License-Identifier: GPL-3.0-or-later
"""Enabling and disabling leave nothing behind; the settings are those of the parameter table."""

import gc
import threading
from pathlib import Path

import addon_utils
import bpy
from kestrel import properties, session
from kestrel.native import loader
from kestrel.sync.settings import BLENDERS_OWN
from support import SceneTest, diffuse

TIMES = 20
MEMORY_GROWTH_MAX = 6 << 20  # bytes in the second half of the times, each with a render


def registered_types():
    """Names of everything that Blender knows as a class, those of Kestrel's panels among them."""
    return set(dir(bpy.types))


def subclasses():
    """(base, name) of all Python classes that are alive and registered, with how many there are."""
    gc.collect()
    found = {}
    for base in ("Panel", "Menu", "Header", "Operator", "PropertyGroup", "AddonPreferences",
                 "RenderEngine", "UIList"):
        for cls in getattr(bpy.types, base).__subclasses__():
            if getattr(cls, "is_registered", True):
                key = (base, cls.__name__)
                found[key] = found.get(key, 0) + 1
    return found


def properties_of_types():
    """type: names of its properties, of those that own some of Kestrel's in the end or might."""
    return {kind: set(getattr(bpy.types, kind).bl_rna.properties.keys())
            for kind in ("Scene", "Object", "ViewLayer", "Material", "World", "Light", "Camera",
                         "Mesh", "Curve", "Collection", "Image", "RenderSettings", "NodeTree",
                         "WindowManager", "Preferences")}


def engines_of_panels():
    return {cls.__name__: frozenset(cls.COMPAT_ENGINES)
            for cls in bpy.types.Panel.__subclasses__() if hasattr(cls, "COMPAT_ENGINES")
            and getattr(cls, "is_registered", True)}


def menu_entries():
    """name of a menu, header or panel: the functions that add to it."""
    found = {}
    for name in dir(bpy.types):
        draw = getattr(getattr(bpy.types, name), "draw", None)
        functions = getattr(draw, "_draw_funcs", None)
        if functions is not None:
            found[name] = [f"{f.__module__}.{f.__qualname__}" for f in functions]
    return {name: functions for name, functions in found.items() if len(functions) > 1}


def handlers():
    return {name: [f"{f.__module__}.{f.__name__}" for f in getattr(bpy.app.handlers, name)]
            for name in dir(bpy.app.handlers)
            if isinstance(getattr(bpy.app.handlers, name), list)}


def has_translations():
    """Whether Kestrel's words are among Blender's, which takes an add-on's only once."""
    try:
        bpy.app.translations.register("kestrel", {})
    except ValueError:
        return True
    bpy.app.translations.unregister("kestrel")
    return False


def state():
    """Everything that registering changes."""
    return {"types": registered_types(), "classes": subclasses(), "menus": menu_entries(),
            "properties": properties_of_types(), "engines": engines_of_panels(),
            "handlers": handlers(), "sessions": session.count(),
            "threads": sorted(thread.name for thread in threading.enumerate()),
            "operators": set(dir(bpy.ops.kestrel)), "translations": has_translations()}


def difference(found, wanted):
    """What two parts of a state do not share, as the whole would fill pages."""
    if isinstance(wanted, dict):
        return sorted((key, found.get(key), wanted.get(key)) for key in {**found, **wanted}
                      if found.get(key) != wanted.get(key))
    return sorted(found ^ wanted) if isinstance(wanted, set) else [] if found == wanted else [
        (found, wanted)]


def resident_bytes():
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * 4096


class EnableTest(SceneTest):
    def render_something(self):
        self.camera()
        self.light("SUN", 3.0)
        self.plane(material=diffuse("White", (0.8, 0.8, 0.8)))
        self.render()

    def assert_state(self, wanted):
        found = state()
        for name, value in wanted.items():
            self.assertEqual(difference(found[name], value), [], name)

    def test_twenty_times(self):
        session.drop_all()
        state()  # Blender makes some classes of its own when they are first looked at
        enabled = state()
        self.assertEqual(sum("kestrel" in names for names in enabled["properties"].values()), 4)
        self.assertIn("KESTREL", enabled["engines"]["RENDER_PT_format"])
        self.addCleanup(addon_utils.enable, "kestrel")
        addon_utils.disable("kestrel")
        disabled = state()
        self.assertEqual([name for name in disabled["types"] if "KESTREL" in name.upper()], [])
        self.assertEqual([n for n, e in disabled["engines"].items() if "KESTREL" in e], [])
        self.assertNotIn("kestrel", set().union(*disabled["properties"].values()))
        self.assertEqual((enabled["translations"], disabled["translations"]), (True, False))
        self.assertIn("copy_system_report", enabled["operators"])
        self.assertEqual(disabled["operators"], set())
        self.assertNotIn("kestrel", repr(disabled["handlers"]) + repr(disabled["menus"]))
        memory, threads = [], []
        for _ in range(TIMES):
            addon_utils.enable("kestrel")
            self.setUp()
            self.render_something()
            session.drop_all()
            self.assert_state(enabled)
            addon_utils.disable("kestrel")
            self.assert_state(disabled)
            memory.append(resident_bytes())
            threads.append(len(list(Path("/proc/self/task").iterdir())))
        growth = memory[-1] - memory[TIMES // 2 - 1]
        print(f"memory of {TIMES} times: {[m >> 20 for m in memory]} MB, threads {threads}")
        self.assertLess(growth, MEMORY_GROWTH_MAX)
        self.assertLessEqual(threads[-1], max(threads[:TIMES // 2]))


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
            if row["name"] in BLENDERS_OWN:
                self.assertNotIn(row["name"], self.owner(row).bl_rna.properties)
                continue
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
        self.scene.view_layers[0].kestrel.passes = {"Lighting", "ObjectId"}
        path = str(self.folder / "saved.blend")
        bpy.ops.wm.save_as_mainfile(filepath=path)
        bpy.ops.wm.open_mainfile(filepath=path)
        self.assertEqual(bpy.context.scene.kestrel.samples, 7)
        self.assertEqual(bpy.data.objects["Thing"].kestrel.relevance, 4.0)
        self.assertEqual(bpy.context.view_layer.kestrel.passes, {"Lighting", "ObjectId"})

    def test_sessions_go_when_a_file_is_opened(self):
        self.camera()
        self.render()
        self.assertEqual(session.count(), 1)
        bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
        self.assertEqual(session.count(), 0)
