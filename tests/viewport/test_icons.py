# SPDX-License-Identifier: GPL-3.0-or-later
"""Preview icons are Kestrel's, and neither they nor Material Preview disturb anything."""

import time
from unittest import mock

import bpy
import numpy as np
from kestrel import engine, session, viewport
from support import shader_material
from viewport_support import ViewportTest

ICON_S = 3.0  # generous; some 0.15 s on two idle cores


def icon(datablock):
    """Height x width x 4 of a datablock's preview, first row on top; None until there is one."""
    preview = datablock.preview
    if preview is None or 0 in preview.image_size:
        return None
    width, height = preview.image_size
    pixels = np.array(preview.image_pixels_float, np.float32).reshape(height, width, 4)[::-1]
    return pixels if pixels.any() else None


class IconTest(ViewportTest):
    def setUp(self):
        super().setUp()
        self.times = []  # seconds of each icon of Kestrel's
        original = engine.KestrelRenderEngine.update, engine.KestrelRenderEngine.render
        begin = []

        def update(engine_, data, depsgraph):
            begin.append((time.perf_counter(), engine_.is_preview))
            original[0](engine_, data, depsgraph)

        def render(engine_, depsgraph):
            original[1](engine_, depsgraph)
            started, is_preview = begin[-1]
            if is_preview:
                self.times.append(time.perf_counter() - started)

        for name, made in (("update", update), ("render", render)):
            patch = mock.patch.object(engine.KestrelRenderEngine, name, made)
            patch.start()
            self.addCleanup(patch.stop)

    def ask(self, datablock):
        """Have Blender make an icon, which takes it two seconds to begin."""
        datablock.preview_ensure()
        with bpy.context.temp_override(window=self.window, id=datablock):
            bpy.ops.ed.lib_id_generate_preview()

    def test_material_light_and_world(self):
        red = shader_material("Red", "ShaderNodeBsdfDiffuse", Color=(0.8, 0.02, 0.02))
        lamp = bpy.data.lights.new("Lamp", "POINT")
        world, _ = self.world((0.0, 0.3, 0.0))
        for datablock in (red, lamp, world):
            self.ask(datablock)
            yield lambda: icon(datablock) is not None
        print(f"icons in {', '.join(f'{s:.2f}' for s in self.times)} s")
        self.assertEqual(len(self.times), 3)
        self.assertLess(max(self.times), ICON_S)
        self.assertEqual(session.count(), 0)
        center = icon(red)[48:80, 48:80].mean(axis=(0, 1))
        self.assertGreater(center[0], 2.5 * max(center[1], center[2]))
        self.assertLess(icon(red)[:4, :4, 3].max(), 0.01)  # no floor, no background
        self.assertGreater(center[3], 0.99)
        self.assertGreater(icon(lamp)[..., :3].max(), 0.1)
        sky = icon(world)[64, 64]
        self.assertGreater(sky[1], 2.0 * max(sky[0], sky[2]))

    def test_leaves_a_viewport_alone(self):
        red = self.still_life()
        self.look()
        self.scene.kestrel.viewport_samples = 4096
        self.render_shading()
        yield lambda: bool(self.viewport.picture)
        view, before = self.viewport, self.viewport._session.edits
        self.ask(red.active_material)
        yield lambda: icon(red.active_material) is not None
        samples = view.picture.samples
        yield lambda: view.picture.samples > samples
        self.assertIs(self.viewport, view)
        self.assertEqual(view._session.edits, before)
        self.assertEqual(session.count(), 1)
        self.assertEqual(len(self.times), 1)

    def test_python_may_write_afterwards(self):
        """Also where an icon begins while a view is being drawn."""
        red = self.still_life()
        self.look()
        self.scene.kestrel.viewport_samples = 4096
        original = viewport.Viewport.draw

        def draw_slowly(*arguments):
            original(*arguments)
            time.sleep(0.02)
        patch = mock.patch.object(viewport.Viewport, "draw", draw_slowly)
        patch.start()
        self.addCleanup(patch.stop)
        self.render_shading()
        yield lambda: bool(self.viewport.picture)
        for _ in range(3):
            self.ask(red.active_material)
            done = len(self.times) + 1
            yield lambda: (self.area.tag_redraw(), len(self.times) == done)[1]
            yield None
            self.scene["written"] = True

    def test_material_preview_shows_eevee(self):
        material = bpy.data.materials.new("Red")
        material.use_nodes, material.diffuse_color = False, (0.8, 0.02, 0.02, 1.0)
        self.cube("Red", 3.0, material)
        self.look()
        self.space.shading.type = "MATERIAL"
        yield self.shows_red
        self.assertEqual(session.count(), 0)  # Kestrel had no part in it

    def shows_red(self):
        """Whether the window does, in some hundred pixels at least."""
        path = self.folder / "screen.png"
        self.area.tag_redraw()
        with self.context():
            bpy.ops.screen.screenshot(filepath=str(path))
        image = bpy.data.images.load(str(path))
        shown = np.array(image.pixels, np.float32).reshape(image.size[1], image.size[0], -1)
        bpy.data.images.remove(image)
        return (shown[..., 0] > 1.5 * shown[..., 1]).sum() > 500
