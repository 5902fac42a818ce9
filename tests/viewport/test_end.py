# SPDX-License-Identifier: GPL-3.0-or-later
"""Nothing is left of a viewport, whatever it was doing."""

import addon_utils
import bpy
from kestrel import session, viewport
from viewport_support import ViewportTest


class EndTest(ViewportTest):
    samples = 4096  # never done

    def begin(self):
        self.still_life()
        self.look()
        self.render_shading()

    def started(self):
        return bool(viewport.open_viewports()) and self.viewport.picture is not None

    def check_gone(self, thread):
        self.assertEqual(session.count(), 0)
        self.assertEqual(viewport.open_viewports(), [])
        self.assertFalse(thread.is_alive())

    def test_other_shading(self):
        for _ in range(3):
            self.begin()
            yield self.started
            thread = self.viewport._thread
            self.space.shading.type = "SOLID"
            yield lambda: not viewport.open_viewports()
            self.check_gone(thread)

    def test_another_file(self):
        self.begin()
        yield self.started
        thread = self.viewport._thread
        bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
        self.check_gone(thread)

    def test_add_on_disabled(self):
        self.begin()
        yield self.started
        thread = self.viewport._thread
        addon_utils.disable("kestrel")
        self.addCleanup(addon_utils.enable, "kestrel")
        self.check_gone(thread)
        yield None
