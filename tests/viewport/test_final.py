# SPDX-License-Identifier: GPL-3.0-or-later
"""F12 in a window: the picture shows as it forms, progress is told, Escape stops it at once."""

import time
from unittest import mock

import bpy
import numpy as np
from kestrel import display, session, viewport
from kestrel.final_render import FinalRender
from kestrel.native import capi
from kestrel.render_thread import RenderThread
from keyboard import Keyboard
from support import read_planes, rgba
from viewport_support import ViewportTest, psnr


class FinalTest(ViewportTest):
    size = (640, 360)  # of the picture
    keeps_sessions = False

    def setUp(self):
        super().setUp()
        preferences = bpy.context.preferences.view
        self.addCleanup(setattr, preferences, "render_display_type",
                        preferences.render_display_type)
        preferences.render_display_type = "NONE"
        settings = self.scene.render.image_settings
        settings.file_format, settings.color_mode = "OPEN_EXR", "RGBA"
        settings.color_depth = "32"
        self.keyboard, self.pressed = Keyboard(), 0.0
        self.addCleanup(self.keyboard.close)
        self.still_life()
        self.look()
        self.camera_of_view()
        self.scene.render.resolution_x, self.scene.render.resolution_y = self.size
        self.scene.kestrel.threads = 1  # one core is Blender's own
        self.view = self.area
        self.view.type = "TEXT_EDITOR"  # nothing that takes long to draw
        self.addCleanup(setattr, self.view, "type", "VIEW_3D")

    def start(self):
        """F12."""
        with bpy.context.temp_override(window=self.window):
            bpy.ops.render.render("INVOKE_DEFAULT")

    @staticmethod
    def over():
        return not bpy.app.is_job_running("RENDER")

    def stopped(self):
        """Whether Escape has ended the render. It is pressed until then: Blender forgets what comes
        before its render has begun."""
        if time.monotonic() - self.pressed > 0.5:
            self.pressed = time.monotonic()
            self.keyboard.press_escape()
        return self.over()

    def picture(self):
        """What the image editor shows now, height x width x 4."""
        path = self.folder / "shown.exr"
        bpy.data.images["Render Result"].save_render(str(path), scene=self.scene)
        return rgba(read_planes(path))

    def watch_display(self):
        """List that grows with every picture shown as it forms, height x width x 4."""
        pictures = []
        original = display.Display.copy

        def copy(display):
            original(display)
            pictures.append(display._writer.pixels.reshape(*self.size[::-1], 4)[::-1].copy())

        patch = mock.patch.object(display.Display, "copy", copy)
        patch.start()
        self.addCleanup(patch.stop)
        return pictures


class TilesTest(FinalTest):
    size = (1920, 1080)  # takes so long that something can be seen of it

    def test_tiles_show_as_they_get_done(self):
        """Every pixel is missing or final."""
        pictures = self.watch_display()
        for name, value in (("SHOW_EVERY_S", 0.0), ("SHOW_SHARE", 1.0)):
            patch = mock.patch.object(display, name, value)
            patch.start()
            self.addCleanup(patch.stop)
        self.scene.kestrel.samples = 1
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


class ProgressiveTest(FinalTest):
    def test_samples_add_up_until_escape(self):
        self.scene.kestrel.samples = 4096
        pictures = self.watch_display()
        begun = time.monotonic()
        self.start()
        yield lambda: len(pictures) >= 2
        self.assertLessEqual(len(pictures),
                             (time.monotonic() - begun) / display.SHOW_EVERY_S)
        early = self.picture()
        yield self.stopped
        left, stopped = self.picture(), pictures[-1]
        self.scene.kestrel.samples = 16
        self.start()
        yield self.over
        final = self.picture()
        print(f"early {psnr(early, final):.1f} dB, left {psnr(left, final):.1f} dB")
        self.assertGreater(psnr(early, final), 25.0)  # Blender has what was shown,
        np.testing.assert_array_equal(left, stopped)  # and keeps what there was at the end


class CancelTest(FinalTest):
    size = (320, 180)

    def test_fifty_times(self):
        """Escape at random moments: Blender goes on, and the next picture is as ever."""
        self.start()
        yield self.over
        expected = self.picture()
        random = np.random.default_rng(5)
        for _ in range(50):
            self.scene.kestrel.samples = 4096
            self.start()
            begun, wait = time.monotonic(), random.uniform(0.0, 0.15)
            yield lambda: time.monotonic() - begun >= wait
            yield self.stopped
        self.scene.kestrel.samples = self.samples
        self.assertEqual(session.count(), 0)
        self.start()
        yield self.over
        np.testing.assert_array_equal(self.picture(), expected)
        self.view.type = "VIEW_3D"
        self.render_shading()
        yield self.settled


class BesideTest(FinalTest):
    """A 3D view in Rendered shading, open all the while."""
    size = (640, 360)
    samples = 4096  # it is never done

    def watch_frames(self):
        """List of when the viewport began its frames, on time.monotonic()."""
        times = []
        original = RenderThread._frame

        def frame(thread, *arguments):
            times.append(time.monotonic())
            return original(thread, *arguments)

        patch = mock.patch.object(RenderThread, "_frame", frame)
        patch.start()
        self.addCleanup(patch.stop)
        return times

    def begin(self):
        self.scene.kestrel.threads = 0
        self.view.type = "VIEW_3D"
        self.render_shading()

    def waits(self):
        return self.viewport.status == "Waiting for the final render"

    def test_waits_for_the_render(self):
        self.begin()
        frames = self.watch_frames()
        yield lambda: len(frames) > 2
        self.scene.kestrel.samples = 64
        self.start()
        yield self.waits
        count, begun = len(frames), time.monotonic()
        yield lambda: time.monotonic() - begun > 0.3 or self.over()
        self.assertEqual(len(frames), count)
        yield self.over
        yield lambda: len(frames) > count + 2
        self.assertIn("Sample", self.viewport.status)

    def test_goes_on_after_escape(self):
        self.begin()
        frames = self.watch_frames()
        yield lambda: len(frames) > 2
        self.scene.kestrel.samples = 4096
        self.start()
        yield self.waits
        count = len(frames)
        yield self.stopped
        yield lambda: len(frames) > count + 2

    def test_goes_on_after_a_failure(self):
        self.begin()
        frames = self.watch_frames()
        yield lambda: len(frames) > 2
        with mock.patch.object(FinalRender, "_read",
                               side_effect=capi.KestrelError("Broken.")) as read:
            self.start()
            yield lambda: read.called and self.over()
        count = len(frames)
        yield lambda: len(frames) > count + 2

    def test_closes_while_it_waits(self):
        self.begin()
        frames = self.watch_frames()
        yield lambda: len(frames) > 2
        self.scene.kestrel.samples = 4096
        self.start()
        yield self.waits
        self.space.shading.type = "SOLID"
        yield lambda: not viewport.open_viewports()
        self.view.type = "TEXT_EDITOR"
        yield self.stopped
