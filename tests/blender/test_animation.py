# SPDX-License-Identifier: GPL-3.0-or-later
"""Animations: every frame is what it is alone, only what moves is sent again, memory goes back."""

from unittest import mock

import bpy
import numpy as np
from kestrel import session
from kestrel.native import capi
from mathutils import Matrix
from support import SceneTest, diffuse, read_planes, rgba, run_blender


class AnimationTest(SceneTest):
    size = (48, 32)
    keeps_sessions = False

    def setUp(self):
        super().setUp()
        scene = self.scene
        scene.kestrel.primary = "rays"
        scene.kestrel.samples = 2
        scene.frame_start, scene.frame_end = 1, 20
        self.world((0.2, 0.3, 0.4))
        self.light("SUN", 2.0, (1, 0.5, 2))
        self.plane("Floor", 9, diffuse("Floor", (0.5, 0.6, 0.7)))
        moving = self.cube("Moving", 1, diffuse("Red", (0.8, 0.1, 0.1)))
        for frame, x in ((1, -2.0), (20, 2.0)):
            moving.location = (x, 0, 1)
            moving.keyframe_insert("location", frame=frame)
        for frame, place in ((1, (0, -7, 3)), (11, (3, -6, 4))):
            marker = scene.timeline_markers.new(f"F{frame}", frame=frame)
            marker.camera = self.camera(place, (0, 0, 0.5))
        scene.frame_set(1)
        settings = scene.render.image_settings
        settings.file_format, settings.color_mode = "OPEN_EXR", "RGBA"
        settings.color_depth, settings.exr_codec = "32", "ZIP"
        scene.render.filepath = str(self.folder / "out_####")

    def frame(self, number):
        return rgba(read_planes(self.folder / f"out_{number:04}.exr"))

    def test_twenty_files_in_background(self):
        path = str(self.folder / "scene.blend")
        bpy.ops.wm.save_as_mainfile(filepath=path)
        done = run_blender(self.folder, path, "-E", "KESTREL", "-a")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertEqual(len(list(self.folder.glob("out_*.exr"))), 20)
        self.scene.render.filepath = str(self.folder / "alone.exr")
        for number in (1, 11, 20):
            self.scene.frame_set(number)
            np.testing.assert_array_equal(self.frame(number), self.render(), f"frame {number}")
        self.assertGreater(np.abs(self.frame(10) - self.frame(11)).max(), 0.1)  # another camera

    def test_only_what_moves_is_sent(self):
        names = ("set_mesh", "set_material", "set_objects", "set_object_transforms")
        calls = {}
        for name in names:
            patch = mock.patch.object(capi.Scene, name, autospec=True,
                                      side_effect=getattr(capi.Scene, name))
            calls[name] = patch.start()
            self.addCleanup(patch.stop)
        bpy.ops.render.render(animation=True)
        self.assertEqual({name: call.call_count for name, call in calls.items()},
                         {"set_mesh": 2, "set_material": 2, "set_objects": 2,
                          "set_object_transforms": 19})
        self.assertEqual(session.count(), 0)

    def test_frame_step(self):
        self.scene.frame_step = 7
        bpy.ops.render.render(animation=True)
        self.assertEqual(sorted(path.stem for path in self.folder.glob("out_*.exr")),
                         ["out_0001", "out_0008", "out_0015"])

    def test_time_remapping(self):
        """Frame 20 shows what happens at 10 without."""
        self.scene.frame_set(10)
        expected = self.render()
        self.scene.render.frame_map_old, self.scene.render.frame_map_new = 100, 200
        self.scene.timeline_markers.clear()
        self.scene.camera = next(o for o in self.scene.objects if o.type == "CAMERA")
        self.scene.frame_set(20)
        np.testing.assert_allclose(self.render(), expected, atol=1e-5)


class PersistentDataTest(SceneTest):
    keeps_sessions = False

    def setUp(self):
        super().setUp()
        self.camera()
        self.cube("Cube", 1, None, Matrix.Rotation(0.5, 4, "X"))
        self.world((0.5, 0.5, 0.5))

    def test_off_gives_memory_back(self):
        self.scene.view_layers.new("Second")
        self.render()
        self.assertEqual(session.count(), 0)
        self.scene.camera = self.link("Empty", None)
        with self.assertRaises(RuntimeError):
            bpy.ops.render.render()
        self.assertEqual(session.count(), 0)

    def test_on_keeps_it_for_the_next_picture(self):
        self.scene.render.use_persistent_data = True
        first = self.render()
        self.assertEqual(session.count(), 1)
        with mock.patch.object(capi.Scene, "set_mesh", side_effect=AssertionError("sent again")):
            np.testing.assert_array_equal(self.render(), first)
        bpy.data.objects["Cube"].location.x = 0.5
        moved = self.render()
        self.assertGreater(np.abs(moved - first).max(), 0.05)
        self.scene.render.use_persistent_data = False
        np.testing.assert_array_equal(self.render(), moved)
        self.assertEqual(session.count(), 0)
