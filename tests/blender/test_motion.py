# SPDX-License-Identifier: GPL-3.0-or-later
"""Depth of field, motion blur and the pass Vector, against exact geometry and Cycles."""

import bpy
import numpy as np
from mathutils import Matrix
from support import SceneTest, emission

WIDTH = 0.5  # of the bar, metres


class DepthOfFieldTest(SceneTest):
    size = (64, 32)

    def setUp(self):
        super().setUp()
        self.scene.kestrel.samples = 128
        self.scene.kestrel.pixel_filter, self.scene.kestrel.filter_width = "box", 1.0
        self.plane("Near", 8, emission("Near", (1, 0.5, 0)), Matrix.Translation((-4, 0, 1)))
        self.plane("Far", 8, emission("Far", (0, 0.5, 1)), Matrix.Translation((4, 0, -3)))

    def profile(self, picture):
        """The mean of each column away from the upper and lower edge."""
        return picture[8:-8, :, :3].mean(axis=0)

    def compare(self):
        mine, cycles = self.render(), self.render_cycles(128)
        blurred = np.ptp(np.diff(self.profile(mine)[:, 0]))
        self.assertLess(blurred, 0.3)  # no hard edge is left
        np.testing.assert_allclose(self.profile(mine), self.profile(cycles), atol=0.04)

    def test_blurs_like_cycles(self):
        for name, lens in (("perspective", {"lens": 50.0}), ("orthographic", {"ortho_scale": 4.0})):
            camera = self.camera((0, 0, 6), **lens).data
            camera.dof.use_dof, camera.dof.focus_distance = True, 3.0
            camera.dof.aperture_fstop = 0.02 if lens == {"lens": 50.0} else 1.0
            for blades, ratio in ((0, 1.0), (5, 1.0), (0, 2.0)):
                with self.subTest(name, blades=blades, ratio=ratio):
                    camera.dof.aperture_blades, camera.dof.aperture_ratio = blades, ratio
                    self.compare()

    def test_focus_object(self):
        camera = self.camera((0, 0, 6)).data
        camera.dof.use_dof, camera.dof.aperture_fstop = True, 0.02
        camera.dof.focus_distance = 3.5
        expected = self.render()
        camera.dof.focus_distance = 8.0
        camera.dof.focus_object = self.link("Focus", None, Matrix.Translation((1, 1, 2.5)))
        np.testing.assert_allclose(self.render(), expected, atol=1e-4)


class MotionTest(SceneTest):
    """A bar that moves one metre a frame to the right, at x = 0 in frame 10."""

    size = (64, 16)

    def setUp(self):
        super().setUp()
        kestrel = self.scene.kestrel
        kestrel.samples, kestrel.pixel_filter, kestrel.filter_width = 89, "box", 0.01
        self.scene.frame_set(10)
        self.scene.render.use_motion_blur = True
        self.scene.render.motion_blur_shutter = 0.5
        self.eye = self.camera((0, 0, 5), ortho_scale=2.0)

    def bar(self):
        h = WIDTH / 2
        return self.mesh("Bar", [(-h, -4, 0), (h, -4, 0), (h, 4, 0), (-h, 4, 0)], [(0, 1, 2, 3)],
                         emission("Glow", (1, 1, 1)))

    @staticmethod
    def animate(owner, path, at_frame):
        for frame in (0, 20):
            setattr(owner, path, at_frame(frame))
            owner.keyframe_insert(path, frame=frame)
        action = owner.id_data.animation_data.action
        curves = action.fcurves if hasattr(action, "fcurves") else [  # until 4.4
            curve for layer in action.layers for strip in layer.strips
            for bag in strip.channelbags for curve in bag.fcurves]
        for curve in curves:
            for key in curve.keyframe_points:
                key.interpolation = "LINEAR"

    def move(self, obj, direction=1.0):
        start = obj.location.copy()
        self.animate(obj, "location", lambda frame: (
            start.x + direction * (frame - 10), start.y, start.z))
        self.scene.frame_set(10)

    def position(self, name):
        owner = self.scene.render
        if not hasattr(owner, "motion_blur_position"):
            owner = self.scene.cycles
        owner.motion_blur_position = name

    def assert_trapezoid(self, middle=0.0, way=0.5):
        """Share of the time that the bar covers the centre of each column."""
        x = (np.arange(64) + 0.5) * 2.0 / 64 - 1.0 - middle
        enter, leave = (x - WIDTH / 2) / way + 0.5, (x + WIDTH / 2) / way + 0.5
        expected = np.clip(leave, 0, 1) - np.clip(enter, 0, 1)
        np.testing.assert_allclose(self.render()[8, :, 0], expected, atol=0.035)
        self.assertEqual((self.scene.frame_current, self.scene.frame_subframe), (10, 0.0))

    def test_object(self):
        self.move(self.bar())
        self.assert_trapezoid()

    def test_position_of_the_shutter(self):
        self.move(self.bar())
        for name, middle in (("START", 0.25), ("END", -0.25)):
            with self.subTest(name):
                self.position(name)
                self.assert_trapezoid(middle)

    def test_camera(self):
        self.bar()
        self.move(self.eye, -1.0)
        self.assert_trapezoid()

    def test_deformation(self):
        bar = self.bar()
        bar.shape_key_add(name="Basis")
        key = bar.shape_key_add(name="Moved")
        for point in key.data:
            point.co.x += 1.0
        key.slider_min, key.slider_max = -10.0, 10.0
        self.animate(key, "value", lambda frame: float(frame - 10))
        self.scene.frame_set(10)
        self.assert_trapezoid()
        self.scene.render.use_motion_blur = False
        self.assert_trapezoid(way=1e-6)

    def test_instances(self):
        collection = bpy.data.collections.new("Bars")
        bar = self.bar()
        self.scene.collection.objects.unlink(bar)
        collection.objects.link(bar)
        empty = self.link("Empty", None)
        empty.instance_type, empty.instance_collection = "COLLECTION", collection
        self.move(empty)
        self.assert_trapezoid()

    def test_still_scene_is_the_same_to_the_bit(self):
        self.bar()
        blurred = self.render()
        self.scene.render.use_motion_blur = False
        np.testing.assert_array_equal(blurred, self.render())

    def test_motion_ends(self):
        """Persistent sessions keep no motion of a frame in which things moved."""
        bar = self.bar()
        self.move(bar)
        self.render()
        bar.animation_data_clear()
        bar.location = (0, 0, 0)
        self.assert_trapezoid(way=1e-6)

    def test_vector_pass_is_that_of_cycles(self):
        self.scene.render.use_motion_blur = False
        self.scene.kestrel.samples = 1
        bpy.context.view_layer.use_pass_vector = True
        bar = self.bar()
        self.move(bar)
        self.animate(bar, "rotation_euler", lambda frame: (0, 0, 0.1 * (frame - 10)))
        self.scene.frame_set(10)
        mine = self.render_planes()
        self.scene.cycles.samples, self.scene.cycles.use_denoising = 1, False
        cycles = self.render_planes("CYCLES")
        name = next(key for key in mine if key.endswith("Vector.X"))[:-1]
        for channel in "XYZW":
            with self.subTest(channel):
                np.testing.assert_allclose(mine[name + channel][8, 26:38],
                                           cycles[name + channel][8, 26:38], atol=0.2)
        self.assertLess(mine[name + "X"][8, 32], -20.0)
