# SPDX-License-Identifier: GPL-3.0-or-later
"""What the camera sees: window, orientation, border."""

import itertools

import bpy
import numpy as np
from kestrel.sync import camera as sync_camera
from mathutils import Matrix
from support import SceneTest, emission, look_at


def blender_window(camera, scene):
    """(left, right, bottom, top) by Blender itself."""
    corners = camera.data.view_frame(scene=scene)
    scale = 1.0 if camera.data.type == "ORTHO" else -1.0 / corners[0].z
    xs, ys = [c.x * scale for c in corners], [c.y * scale for c in corners]
    return min(xs), max(xs), min(ys), max(ys)


class WindowTest(SceneTest):
    def test_is_blenders(self):
        """Every sensor fit, wide and tall pictures, shifts, pixel aspects, both projections."""
        render = self.scene.render
        camera = self.camera(lens=35.0, sensor_width=30.0, sensor_height=17.0)
        cases = itertools.product(("AUTO", "HORIZONTAL", "VERTICAL"), ((640, 360), (300, 500)),
                                  ((0, 0), (0.3, -0.2)), ((1, 1), (2, 1), (1, 1.5)),
                                  ("PERSP", "ORTHO"))
        for fit, size, shift, aspect, kind in cases:
            with self.subTest(fit=fit, size=size, shift=shift, aspect=aspect, kind=kind):
                data = camera.data
                data.type, data.sensor_fit = kind, fit
                data.shift_x, data.shift_y = shift
                render.resolution_x, render.resolution_y = size
                render.pixel_aspect_x, render.pixel_aspect_y = aspect
                width, height = sync_camera.frame_size(render)
                np.testing.assert_allclose(
                    sync_camera.window(data, render, width, height),
                    blender_window(camera, self.scene), rtol=1e-5, atol=1e-6)

    def test_projects_like_blenders_matrix(self):
        camera = self.camera(lens=24.0, shift_x=0.1, shift_y=0.25)
        width, height = 200, 120
        self.scene.render.resolution_x, self.scene.render.resolution_y = width, height
        matrix = camera.calc_matrix_camera(bpy.context.evaluated_depsgraph_get(), x=width,
                                           y=height)
        left, right, bottom, top = sync_camera.window(camera.data, self.scene.render, width,
                                                      height)
        for x, y in ((left, bottom), (right, top)):
            clip = matrix @ Matrix.Translation((x, y, -1.0)).translation.to_4d()
            np.testing.assert_allclose((abs(clip.x / clip.w), abs(clip.y / clip.w)), (1, 1),
                                       rtol=1e-4)


class PictureTest(SceneTest):
    def colored_cubes(self):
        self.cube("Red", 1, emission("Red", (1, 0, 0)), Matrix.Translation((-1.5, 0, 0)))
        self.cube("Blue", 1, emission("Blue", (0, 0, 1)), Matrix.Translation((1.5, 0, 0)))
        self.cube("Green", 1, emission("Green", (0, 1, 0)), Matrix.Translation((0, 0, 1.5)))

    def test_orientation(self):
        self.colored_cubes()
        self.camera((0, -8, 0))
        picture = self.render()
        self.assert_color(picture[16, 5], (1, 0, 0))   # left
        self.assert_color(picture[16, 26], (0, 0, 1))  # right
        self.assert_color(picture[5, 16], (0, 1, 0))   # top
        self.assert_color(picture[26, 16], (0, 0, 0))

    def test_silhouettes_are_those_of_cycles(self):
        self.colored_cubes()
        for settings in ({"lens": 30.0, "shift_x": 0.15}, {"ortho_scale": 6.0, "shift_y": 0.1}):
            with self.subTest(**settings):
                self.camera((3, -8, 2), **settings)
                mine, cycles = self.render(), self.render_cycles(64)
                # Cycles averages over the pixel: compare where it is sure.
                sure = np.isin(cycles[..., :3], (0.0, 1.0)).all(axis=-1)
                self.assertGreater(sure.mean(), 0.7)
                self.assert_color(mine[sure], cycles[sure][:, :3])

    def test_scale_of_the_camera_does_not_matter(self):
        self.colored_cubes()
        camera = self.camera((0, -8, 0))
        before = self.render()
        camera.matrix_world = look_at((0, -8, 0), (0, 0, 0)) @ Matrix.Scale(3.0, 4)
        np.testing.assert_array_equal(self.render(), before)

    def test_clipping(self):
        self.plane("Near", 20, emission("Red", (1, 0, 0)), Matrix.Translation((0, 0, 4)))
        self.plane("Far", 20, emission("Green", (0, 1, 0)))
        self.camera((0, 0, 5), clip_start=2.0)
        self.assert_color(self.render()[16, 16], (0, 1, 0))

    def test_border_is_a_part_of_the_whole(self):
        self.colored_cubes()
        self.camera((0, -8, 0))
        whole = self.render()
        render = self.scene.render
        render.use_border, render.use_crop_to_border = True, True
        render.border_min_x, render.border_max_x = 0.25, 0.75
        render.border_min_y, render.border_max_y = 0.5, 1.0
        np.testing.assert_allclose(self.render(), whole[:16, 8:24], atol=1e-6)

    def test_border_without_crop_keeps_the_size(self):
        self.colored_cubes()
        self.camera((0, -8, 0))
        whole = self.render()
        render = self.scene.render
        render.use_border, render.use_crop_to_border = True, False
        render.border_min_x, render.border_max_x = 0.25, 0.75
        render.border_min_y, render.border_max_y = 0.5, 1.0
        part = self.render()
        self.assertEqual(part.shape, whole.shape)
        np.testing.assert_allclose(part[:16, 8:24], whole[:16, 8:24], atol=1e-6)
        self.assert_color(part[16:], 0)

    def test_resolution_percentage(self):
        self.camera()
        self.scene.render.resolution_percentage = 50
        self.assertEqual(self.render().shape[:2], (16, 16))
