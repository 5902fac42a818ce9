# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's own Properties editor draws every tab with Kestrel's panels and takes nothing amiss."""

from unittest import mock

import addon_utils
import bpy
from kestrel import log, preferences, ui
from kestrel.native import loader
from viewport_support import ViewportTest

TABS = ("RENDER", "OUTPUT", "VIEW_LAYER", "SCENE", "WORLD", "OBJECT", "MATERIAL", "DATA")
METHODS = ("draw", "draw_header", "draw_header_preset")


class PanelTest(ViewportTest):
    def setUp(self):
        super().setUp()
        self.drawn, self.faults = set(), []
        for panel in (*ui.CLASSES, preferences.KestrelPreferences):
            for name in METHODS:
                if not issubclass(panel, bpy.types.Operator) and hasattr(panel, name):
                    patch = mock.patch.object(panel, name, self.watched(panel, name))
                    patch.start()
                    self.addCleanup(patch.stop)
        area = self.area
        area.type = "PROPERTIES"
        self.addCleanup(setattr, area, "type", "VIEW_3D")
        self.properties = area

    def watched(self, panel, name):
        original = getattr(panel, name)

        def method(self_, context):
            self.drawn.add(panel.__name__)
            try:
                original(self_, context)
            except Exception as error:
                self.faults.append(f"{panel.__name__}.{name}: {error!r}")
        return method

    def show(self, tab, obj):
        self.window.view_layer.objects.active = obj
        try:
            self.properties.spaces.active.context = tab
        except TypeError:  # an object of this kind has no such tab
            return False
        self.properties.tag_redraw()
        return True

    def test_every_tab(self):
        red = self.still_life()
        objects = [red, self.camera(), *(self.light(kind, 1.0) for kind in ("SPOT", "AREA"))]
        yield None  # Blender works out which tabs there are when it draws
        for obj in objects:
            for tab in TABS if obj is red else ("OBJECT", "DATA"):
                if self.show(tab, obj):
                    yield None
                    yield None
        self.assertEqual(self.faults, [])
        for name in ("RENDER_PT_sampling_viewport", "RENDER_PT_tracing", "OBJECT_PT_tracing",
                     "MATERIAL_PT_surface", "LIGHT_PT_light", "LIGHT_PT_beam_shape",
                     "WORLD_PT_surface", "VIEW_LAYER_PT_passes"):
            self.assertIn(f"KESTREL_{name}", self.drawn)

    def test_report_log_and_preferences(self):
        with bpy.context.temp_override(window=self.window, area=self.properties):
            bpy.ops.kestrel.copy_system_report()
        text = bpy.context.window_manager.clipboard
        self.assertTrue(text.startswith("Kestrel system report"), text[:40])
        self.assertIn("draws with ", text)
        log.warning("something odd")
        with bpy.context.temp_override(window=self.window, area=self.properties):
            bpy.ops.screen.back_to_previous()
        yield None
        with bpy.context.temp_override(window=self.window):
            bpy.ops.kestrel.open_log()
        area = bpy.context.window_manager.windows[-1].screen.areas[0]
        self.assertTrue(area.spaces.active.text.as_string().endswith("warning: something odd"))
        self.close_newest_window()
        addon_utils.modules()
        with bpy.context.temp_override(window=self.window):
            bpy.ops.preferences.addon_show(module="kestrel")
        yield lambda: "KestrelPreferences" in self.drawn
        self.close_newest_window()
        self.assertEqual(self.faults, [])

    def close_newest_window(self):
        with bpy.context.temp_override(window=bpy.context.window_manager.windows[-1]):
            bpy.ops.wm.window_close()

    def test_without_a_library(self):
        yield None
        with mock.patch.object(loader, "_library", None), \
                mock.patch.object(loader, "_error", "There is no library. Install it."):
            self.assertTrue(self.show("RENDER", None))
            yield lambda: "KESTREL_RENDER_PT_library" in self.drawn
        self.assertNotIn("KESTREL_RENDER_PT_tracing", self.drawn)
        self.assertEqual(self.faults, [])
