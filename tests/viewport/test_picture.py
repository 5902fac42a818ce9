# SPDX-License-Identifier: GPL-3.0-or-later
"""Rendered shading shows the scene, and in the end just what F12 does."""

from unittest import mock

import bpy
import numpy as np
from kestrel import engine, session, viewport
from kestrel.native import capi
from viewport_support import ViewportTest, psnr


def load(path):
    """Height x width x 4 of an image file as it is stored, first row on top."""
    image = bpy.data.images.load(str(path))
    image.colorspace_settings.name = "Non-Color"
    values = np.empty(image.size[0] * image.size[1] * image.channels, np.float32)
    image.pixels.foreach_get(values)
    values = values.reshape(image.size[1], image.size[0], image.channels)[::-1]
    bpy.data.images.remove(image)
    return values


class PictureTest(ViewportTest):
    def told(self):
        """List of what is written into the 3D view from now on."""
        texts = []
        patch = mock.patch.object(engine.KestrelRenderEngine, "_write",
                                  lambda _self, text: texts.append(text))
        patch.start()
        self.addCleanup(patch.stop)
        return texts

    def test_converges_to_the_final_picture(self):
        self.still_life()
        self.look()
        self.render_shading()
        yield self.settled
        self.assertEqual((self.viewport.picture.width, self.viewport.picture.height), self.size)
        shown = self.pixels()
        self.assertGreater(shown[..., :3].std(), 0.1)  # there is something to see
        self.camera_of_view()
        final = self.render()
        print(f"viewport to F12: {psnr(shown, final):.1f} dB")
        self.assertGreaterEqual(psnr(shown, final), 35.0)
        # As F12 with a single sample: the samples do add up.
        self.scene.kestrel.samples = 1
        self.assertGreater(psnr(shown, final), psnr(shown, self.render()) + 6.0)

    def test_screen_shows_the_final_picture(self):
        self.still_life()
        self.look()
        self.render_shading()
        yield self.settled
        yield None
        yield None
        path = self.folder / "screen.png"
        with self.context():
            bpy.ops.screen.screenshot(filepath=str(path))
        shown = load(path)
        self.camera_of_view()
        self.scene.render.image_settings.file_format = "PNG"
        self.scene.render.filepath = str(self.folder / "final.png")
        bpy.ops.render.render(write_still=True)
        final = load(self.folder / "final.png")
        print(f"screen to F12 after the view transform: {psnr(shown, final):.1f} dB")
        self.assertGreaterEqual(psnr(shown, final), 35.0)

    def test_shows_the_status(self):
        self.still_life()
        self.look()
        self.render_shading()
        yield self.settled
        self.assertRegex(self.viewport.status, rf"^Sample {self.samples}/{self.samples} \| \d+ ms$")

    def test_sample_count_can_be_raised(self):
        self.still_life()
        self.render_shading()
        yield self.settled
        self.scene.kestrel.viewport_samples = 11
        yield lambda: self.settled() and self.viewport.picture.samples == 11

    def test_an_error_is_told_and_mended(self):
        self.still_life()
        world = self.scene.world
        told = self.told()
        self.render_shading()
        yield self.settled
        broken = self.viewport
        broken._session.scene.release()
        self.scene.world = None
        yield lambda: "The scene was freed. Start the render again." in told
        self.scene.world = world
        yield lambda: self.viewport is not broken and self.settled()
        yield lambda: told[-1].startswith("Sample 8/8")
        self.assertEqual(session.count(), 1)

    def test_without_a_library(self):
        told = self.told()
        reason = "There is no library. Install it."
        with mock.patch.object(session.loader, "require", side_effect=capi.KestrelError(reason)):
            self.render_shading()
            yield lambda: reason in told
        self.assertEqual(session.count(), 0)

    def test_a_mistake_is_no_exception_for_blender(self):
        told = self.told()
        with mock.patch.object(viewport, "region_view", side_effect=RuntimeError("oops")):
            self.render_shading()
            yield lambda: any("RuntimeError: oops" in text for text in told)
