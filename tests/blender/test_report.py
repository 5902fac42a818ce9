# SPDX-License-Identifier: GPL-3.0-or-later
"""The system report and the log hold what helps to understand a fault."""

import types
from pathlib import Path
from unittest import mock

import bpy
import fake_layout
from kestrel import log, operators, preferences, report
from kestrel.native import loader
from support import SceneTest


class ReportTest(SceneTest):
    def test_says_what_matters(self):
        self.scene.kestrel.budget_ms = 12.5
        self.camera()
        self.cube()
        self.cube("Other")
        log.warning("something odd")
        text = report.text(self.scene)
        for part in (f"Library: {loader.library().version()}", '"embree"', bpy.app.version_string,
                     "2 MESH", "1 CAMERA", "engine KESTREL", "32 x 32 at 100 %",
                     "budget_ms = 12.5\n", "max_depth = 10 (default)", "warning: something odd"):
            self.assertIn(part, text)

    def test_without_a_library(self):
        with mock.patch.object(loader, "_library", None), \
                mock.patch.object(loader, "_error", "It is gone. Install it."):
            self.assertIn("Library: none. It is gone. Install it.", report.text(self.scene))

    def test_does_not_name_the_user(self):
        home = str(Path.home())
        self.assertEqual(report.without_home(Path(home) / "a/b.so"), "~/a/b.so")
        self.assertEqual(report.without_home(Path("/opt/b.so")), "/opt/b.so")

    def test_is_copied(self):
        window_manager = types.SimpleNamespace(clipboard="")
        context = types.SimpleNamespace(window_manager=window_manager, scene=self.scene)
        said = []
        operator = types.SimpleNamespace(report=lambda kind, text: said.append(text))
        operators.KESTREL_OT_copy_system_report.execute(operator, context)
        self.assertTrue(window_manager.clipboard.startswith("Kestrel system report\n"))
        self.assertIn("clipboard", said[0])
        self.assertEqual(bpy.ops.kestrel.copy_system_report(), {"FINISHED"})

    def test_log_is_a_text(self):
        log.warning("first")
        log.warning("second")
        for _ in range(2):
            self.assertEqual(bpy.ops.kestrel.open_log(), {"FINISHED"})
        lines = bpy.data.texts[operators.LOG_NAME].as_string().splitlines()
        self.assertEqual(lines[-2:], ["warning: first", "warning: second"])
        self.assertEqual(len(bpy.data.texts), 1)

    def test_preferences_name_library_and_device(self):
        words = fake_layout.draw(preferences.KestrelPreferences, None)
        self.assertIn(loader.library().version(), words)
        self.assertIn(loader.device_text(), words)
        self.assertTrue(any("Embree" in word for word in words))
