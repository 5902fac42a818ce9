# SPDX-License-Identifier: GPL-3.0-or-later
"""F12 in a window: the picture shows as it forms, progress is told, Escape stops it at once."""

import time
from unittest import mock

import bpy
import numpy as np
from kestrel import final_render
from keyboard import Keyboard
from support import read_planes, rgba
from viewport_support import ViewportTest, psnr


class FinalTest(ViewportTest):
    size = (640, 360)  # of the picture

    def setUp(self):
        super().setUp()
        preferences = bpy.context.preferences.view
        self.addCleanup(setattr, preferences, "render_display_type",
                        preferences.render_display_type)
        preferences.render_display_type = "NONE"
        settings = self.scene.render.image_settings
        settings.file_format, settings.color_mode = "OPEN_EXR", "RGBA"
        settings.color_depth = "32"
        self.keyboard = Keyboard()
        self.addCleanup(self.keyboard.close)
        self.still_life()
        self.look()
        self.camera_of_view()
        self.scene.render.resolution_x, self.scene.render.resolution_y = self.size

    def start(self):
        """F12."""
        with self.context():
            bpy.ops.render.render("INVOKE_DEFAULT")

    @staticmethod
    def over():
        return not bpy.app.is_job_running("RENDER")

    def picture(self):
        """What the image editor shows now, height x width x 4."""
        path = self.folder / "shown.exr"
        bpy.data.images["Render Result"].save_render(str(path), scene=self.scene)
        return rgba(read_planes(path))

    def watch_display(self):
        """List that grows with every picture shown as it forms, height x width x 4."""
        pictures = []
        original = final_render.Display.copy

        def copy(display):
            original(display)
            pictures.append(display._writer.pixels.reshape(*self.size[::-1], 4)[::-1].copy())

        patch = mock.patch.object(final_render.Display, "copy", copy)
        patch.start()
        self.addCleanup(patch.stop)
        return pictures


class ProgressiveTest(FinalTest):
    def test_tiles_show_as_they_get_done(self):
        """Every pixel is missing or final."""
        pictures = self.watch_display()
        for name, value in (("SHOW_EVERY_S", 0.0), ("SHOW_SHARE", 1.0)):
            patch = mock.patch.object(final_render, name, value)
            patch.start()
            self.addCleanup(patch.stop)
        self.scene.kestrel.samples = 1
        self.scene.kestrel.threads = 1
        self.start()
        yield self.over
        final = self.picture()
        self.assertEqual(final[..., 3].min(), 1.0)
        partial = [p for p in pictures if 0.0 < p[..., 3].mean() < 1.0]
        self.assertGreater(len(partial), 0)
        for picture in partial:
            there = picture[..., 3] > 0.0
            np.testing.assert_array_equal(picture[there], final[there])
            self.assertEqual(np.abs(picture[~there]).max(), 0.0)

    def test_samples_add_up_until_escape(self):
        self.scene.kestrel.samples = 4096
        pictures = self.watch_display()
        begun = time.monotonic()
        self.start()
        yield lambda: len(pictures) >= 2
        self.assertLessEqual(len(pictures),
                             (time.monotonic() - begun) / final_render.SHOW_EVERY_S)
        early = self.picture()
        self.keyboard.press_escape()
        yield self.over
        left, stopped = self.picture(), pictures[-1]
        self.scene.kestrel.samples = 16
        self.start()
        yield self.over
        final = self.picture()
        print(f"early {psnr(early, final):.1f} dB, left {psnr(left, final):.1f} dB")
        self.assertGreater(psnr(early, final), 25.0)  # Blender has what was shown,
        np.testing.assert_array_equal(left, stopped)  # and keeps what there was at the end
