# SPDX-License-Identifier: GPL-3.0-or-later
"""Background rendering as a farm does it, and what the artist is told when something is wrong."""

import contextlib
import io
import threading
import time
import unittest.mock

import bpy
import numpy as np
from kestrel import final_render, session, sync
from kestrel.native import capi
from mathutils import Matrix
from support import SceneTest, emission, rgba, read_planes, run_blender


class AnimationTest(SceneTest):
    def save(self):
        """A glowing plane that is left in frame 1, in the middle in 2 and right in 3."""
        self.camera((0, 0, 9), ortho_scale=4.0)
        plane = self.plane("Plane", 1, emission("Glow", (1, 1, 1)))
        for frame, x in ((1, -1.4), (2, 0.0), (3, 1.4)):
            plane.location.x = x
            plane.keyframe_insert("location", frame=frame)
        self.scene.frame_start, self.scene.frame_end = 1, 3
        settings = self.scene.render.image_settings
        settings.file_format, settings.color_depth, settings.exr_codec = "OPEN_EXR", "32", "ZIP"
        path = str(self.folder / "scene.blend")
        bpy.ops.wm.save_as_mainfile(filepath=path)
        return path

    def check(self, frame, column):
        picture = rgba(read_planes(self.folder / f"out_{frame:04}.exr"))
        lit = np.nonzero(picture[16, :, 0] > 0.5)[0]
        self.assertAlmostEqual(lit.mean(), column, delta=1.0)

    def test_three_frames(self):
        done = run_blender(self.folder, self.save(), "-E", "KESTREL", "-o",
                           str(self.folder / "out_####"), "-a")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        for frame, column in ((1, 4.3), (2, 15.5), (3, 26.7)):
            self.check(frame, column)

    def test_one_frame(self):
        done = run_blender(self.folder, self.save(), "-E", "KESTREL", "-o",
                           str(self.folder / "out_####"), "-f", "2")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.check(2, 15.5)
        self.assertFalse((self.folder / "out_0001.exr").exists())


class ErrorTest(SceneTest):
    def output_of_a_failing_render(self):
        said = io.StringIO()
        with contextlib.redirect_stdout(said), self.assertRaises(RuntimeError) as caught:
            bpy.ops.render.render()
        return said.getvalue() + str(caught.exception)

    def test_no_camera(self):
        self.plane()
        self.assertIn("no camera", self.output_of_a_failing_render())  # Blender says it itself
        target = session.acquire("no camera")
        self.addCleanup(session.drop, "no camera")
        with self.assertRaisesRegex(capi.KestrelError, "no camera. Add one with Add > Camera"):
            sync.export_depsgraph(target, bpy.context.evaluated_depsgraph_get(), None, print)

    def test_camera_that_is_no_camera(self):
        self.scene.camera = self.link("Empty", None)
        self.assertIn("'Empty' is the scene's camera but no camera object",
                      self.output_of_a_failing_render())

    def test_picture_that_is_too_large(self):
        self.camera()
        with unittest.mock.patch.object(final_render, "system_memory", return_value=20000):
            said = self.output_of_a_failing_render()
        self.assertRegex(said, "A picture of 32 x 32 pixels with 1 passes takes .* of memory; .* "
                               "Lower the resolution in Output properties")

    def test_mistakes_of_our_own_are_reported(self):
        """Also while Blender's instances are being walked, which must not outlive the call."""
        self.camera()
        self.plane()
        self.light("SUN", 1.0)
        with unittest.mock.patch("kestrel.sync.object.sync_light", side_effect=TypeError("oops")):
            said = self.output_of_a_failing_render()
        self.assertIn("kestrel: error: Kestrel made a mistake (TypeError: oops)", said)
        self.assertIn("Traceback", said)
        self.assertGreater(self.render().max(), 0.1)

    def test_render_works_after_an_error(self):
        self.scene.camera = self.link("Empty", None)
        self.output_of_a_failing_render()
        self.camera()
        self.world((0.5, 0.5, 0.5))
        self.assert_color(self.render(), 0.5)

    def test_warnings_are_said_once(self):
        self.camera()
        self.light("AREA", 10.0)
        said = io.StringIO()
        with contextlib.redirect_stdout(said):
            self.render()
            self.render()
        text = "kestrel: warning: Light 'Area': area lights are drawn"
        self.assertEqual(said.getvalue().count(text), 1)


class CancelTest(SceneTest):
    size = (400, 400)

    def test_soon_and_usable_afterwards(self):
        self.camera()
        self.cube("Cube", 2, emission("Glow", (1, 1, 1)), Matrix.Rotation(0.5, 4, "X"))
        self.scene.kestrel.samples = 4096
        depsgraph = bpy.context.evaluated_depsgraph_get()
        target = session.acquire("cancel test")
        self.addCleanup(session.drop, "cancel test")
        picture = sync.export_depsgraph(target, depsgraph,
                                        self.scene.camera.evaluated_get(depsgraph), print)
        frame = final_render.Frame(target, picture)
        frame.start()
        time.sleep(0.3)
        began = time.monotonic()
        frame.cancel()
        frame.join(30)
        self.assertLess(time.monotonic() - began, 1.0)
        self.assertIsInstance(frame.error, capi.Cancelled)
        target.scene.set_setting("samples", "1")
        target.scene.commit()
        again = final_render.Frame(target, picture)
        again.start()
        again.join()
        self.assertIsNone(again.error)
        self.assertEqual(again.fraction <= 1.0, True)

    def final_render(self, breaks_after):
        """A FinalRender and an engine in whose update() Escape is pressed at some look."""
        fake = unittest.mock.Mock(is_preview=False, camera_override=None)
        looks = iter([False] * breaks_after)
        fake.test_break.side_effect = lambda: next(looks, True)
        return final_render.FinalRender(), fake

    def test_while_the_scene_is_read(self):
        """Between any two items; the next render sends the rest."""
        self.camera()
        for x in range(5):
            self.cube(f"Cube {x}", 0.5, emission(f"Glow {x}", (1, 1, x / 4)),
                      Matrix.Translation((x - 2, 0, 0)))
        expected = self.render()
        depsgraph = bpy.context.evaluated_depsgraph_get()
        key = final_render.session_key(self.scene, self.scene.view_layers[0])
        with unittest.mock.patch.object(final_render, "POLL_S", 0.0):
            for count in range(0, 15, 2):
                session.drop(key)
                final, fake = self.final_render(count)
                final.update(fake, depsgraph)
                fake.report.assert_not_called()
                final.render(fake, depsgraph)
                fake.begin_result.assert_not_called()
                self.assertLessEqual(len(session.acquire(key).sent), count)
        np.testing.assert_array_equal(self.render(), expected)

    def test_library_that_is_busy(self):
        """Blender does not wait for what cannot be interrupted; it is freed afterwards."""
        self.camera()
        self.world((1, 1, 1))
        depsgraph = bpy.context.evaluated_depsgraph_get()
        go_on = threading.Event()
        self.addCleanup(go_on.set)
        commit = session.Session.commit

        def slow(target):
            commit(target)
            go_on.wait(20.0)

        final, fake = self.final_render(5)
        with unittest.mock.patch.object(session.Session, "commit", slow):
            begun = time.monotonic()
            final.update(fake, depsgraph)
            self.assertLess(time.monotonic() - begun, 2.0)
        self.assertEqual(session.count(), 0)
        self.assert_color(self.render(), 1.0)
        go_on.set()

    def test_dropping_a_session_ends_its_frame(self):
        self.camera()
        self.scene.kestrel.samples = 4096
        depsgraph = bpy.context.evaluated_depsgraph_get()
        target = session.acquire("drop test")
        picture = sync.export_depsgraph(target, depsgraph,
                                        self.scene.camera.evaluated_get(depsgraph), print)
        frame = final_render.Frame(target, picture)
        frame.start()
        time.sleep(0.1)
        session.drop("drop test")
        frame.join(30)
        self.assertFalse(frame.is_alive())
        self.assertNotIn("Kestrel frame", [t.name for t in threading.enumerate()])
