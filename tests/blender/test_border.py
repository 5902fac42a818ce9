# SPDX-License-Identifier: GPL-3.0-or-later
"""Render Region: what is rendered is, bit for bit, that part of the whole picture."""

import numpy as np
from kestrel import passes
from mathutils import Matrix
from support import SceneTest, diffuse, shader_material, turned


class BorderTest(SceneTest):
    size = (70, 50)

    def setUp(self):
        super().setUp()
        self.scene.kestrel.primary = "rays"
        self.scene.kestrel.samples = 2
        self.world((0.2, 0.3, 0.4))
        self.light("SUN", 2.0, (1, 0.5, 2))
        self.plane("Floor", 9, diffuse("Floor", (0.5, 0.6, 0.7)))
        mirror = shader_material("Mirror", "ShaderNodeBsdfGlossy", Roughness=0.0)
        self.cube("Cube", 1.5, mirror, Matrix.Translation((0.4, 0.2, 1)) @ turned(30))
        self.camera((3, -6, 4), (0, 0, 0.5), shift_x=0.1, shift_y=-0.05)
        render = self.scene.render
        render.resolution_percentage, render.pixel_aspect_x = 90, 1.25

    def check(self, border, planes_of):
        """Whole against part, with and without Crop to Render Region."""
        render = self.scene.render
        render.use_border = False
        whole = planes_of()
        height, width = next(iter(whole.values())).shape
        self.assertEqual((width, height), (63, 45))
        render.use_border = True
        (render.border_min_x, render.border_min_y,
         render.border_max_x, render.border_max_y) = border
        left, bottom, right, top = np.int32(
            np.float32(border) * np.float32((width, height, width, height)))
        rows, columns = slice(height - top, height - bottom), slice(left, right)
        render.use_crop_to_border = True
        for name, values in planes_of().items():
            np.testing.assert_array_equal(values, whole[name][rows, columns], name)
        render.use_crop_to_border = False
        for name, values in planes_of().items():
            self.assertEqual(values.shape, (height, width))
            np.testing.assert_array_equal(values[rows, columns], whole[name][rows, columns], name)

    def test_combined(self):
        for border in ((0.25, 0.5, 0.75, 1.0), (0.7, 0.3, 0.9, 0.6), (0.0, 0.1, 1.0, 0.15)):
            with self.subTest(border=border):
                self.check(border, lambda: self.render_planes(file_format="OPEN_EXR"))

    def test_every_pass_of_every_view_layer(self):
        self.scene.view_layers.new("Second")
        for layer in self.scene.view_layers:
            for item in passes.PASSES:
                if item.toggle:
                    setattr(layer, item.toggle, True)
            layer.kestrel.passes = {item.name for item in passes.OPTIONAL}
        self.check((0.3, 0.2, 0.8, 0.7), self.render_planes)
