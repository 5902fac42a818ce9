# SPDX-License-Identifier: GPL-3.0-or-later
"""Images: whichever way they go over, the texels are the same."""

import unittest.mock

import bpy
import numpy as np
from kestrel.native import loader
from support import SceneTest, image, textured

MAGENTA = (1, 0, 1)


class ImageTest(SceneTest):
    size = (16, 16)

    def setUp(self):
        super().setUp()
        self.camera((0, 0, 9), ortho_scale=2.0)
        self.pixels = np.random.default_rng(7).integers(0, 256, (16, 16, 4)) / 255.0
        self.pixels[..., 3] = 1.0

    def show(self, picture, **settings):
        """The image, texel by texel, first row on top."""
        for obj in [o for o in bpy.data.objects if o.type == "MESH"]:
            bpy.data.objects.remove(obj)
        material, _ = textured("Show", picture, interpolation="Closest", **settings)
        self.plane("Plane", 2, material)
        return self.render()[..., :3]

    def saved(self, suffix="PNG", **settings):
        picture = image("Saved", self.pixels, **settings)
        path = str(self.folder / f"saved.{suffix.lower()}")
        picture.filepath_raw, picture.file_format = path, suffix
        picture.save()
        bpy.data.images.remove(picture)
        return bpy.data.images.load(path)

    def expected(self, srgb):
        values = self.pixels[::-1, :, :3]
        if not srgb:
            return values
        return np.where(values <= 0.04045, values / 12.92, ((values + 0.055) / 1.055) ** 2.4)

    def test_generated(self):
        self.assert_color(self.show(image("Made", self.pixels)), self.expected(True), 2e-3)
        self.assert_color(self.show(image("Data", self.pixels, non_color=True)),
                          self.expected(False), 2e-3)

    def test_generated_float(self):
        values = self.pixels * 4.0
        made = image("Float", values, is_float=True, non_color=True)
        self.assert_color(self.show(made), values[::-1, :, :3], 2e-3)

    def test_file(self):
        picture = self.saved()
        self.assert_color(self.show(picture), self.expected(True), 2e-3)
        picture.colorspace_settings.name = "Non-Color"
        self.assert_color(self.show(picture), self.expected(False), 2e-3)

    def test_packed(self):
        picture = self.saved()
        picture.pack()
        (self.folder / "saved.png").unlink()
        self.assert_color(self.show(picture), self.expected(True), 2e-3)

    def test_painted_since_it_was_saved(self):
        picture = self.saved()
        self.pixels = self.pixels[::-1].copy()
        picture.pixels.foreach_set(np.float32(self.pixels).ravel())
        picture.update()
        self.assertTrue(picture.is_dirty)
        self.assert_color(self.show(picture), self.expected(True), 2e-3)

    def test_pixels_and_files_give_the_same(self):
        for suffix, settings in (("PNG", {}), ("OPEN_EXR", {"is_float": True})):
            with self.subTest(suffix):
                picture = self.saved(suffix, **settings)
                by_file = self.show(picture)
                bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
                self.setUp()
                picture = self.saved(suffix, **settings)
                with unittest.mock.patch.object(loader, "image_plugin_available",
                                                return_value=False):
                    np.testing.assert_array_equal(self.show(picture), by_file)

    def test_missing_file_is_magenta(self):
        made = bpy.data.images.new("Gone", 4, 4)
        made.source, made.filepath = "FILE", str(self.folder / "gone.png")
        self.assert_color(self.show(made), MAGENTA)

    def test_changed_file_is_read_again(self):
        self.saved()
        self.show(bpy.data.images.load(str(self.folder / "saved.png"), check_existing=True))
        self.pixels = self.pixels[::-1].copy()
        picture = self.saved()
        self.assert_color(self.show(picture), self.expected(True), 2e-3)
