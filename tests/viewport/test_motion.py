# SPDX-License-Identifier: GPL-3.0-or-later
"""While something changes the viewport follows, and Blender is never kept waiting."""

import os
from pathlib import Path

import addon_utils
import bpy
import numpy as np
from kestrel import session, viewport
from kestrel.pixel_size import COARSEST, RETRY_S, PixelSize
from mathutils import Matrix
from viewport_support import ViewportTest, psnr

ORBIT_STEPS = 100
RESIZES = 20


def resident_mib():
    """Memory of this process that is in use, MiB."""
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 2 ** 20


class MotionTest(ViewportTest):
    def test_orbiting(self):
        self.still_life()
        self.look()
        self.render_shading()
        yield self.settled
        meshes = self.count_calls("set_mesh")
        seconds = self.time_draws()
        pictures = set()
        for step in range(ORBIT_STEPS):
            self.look(azimuth_deg=30.0 + 3.6 * step)
            self.area.tag_redraw()
            before = len(seconds)
            yield lambda: len(seconds) > before
            pictures.add(id(self.viewport.picture.view))
        p95 = 1e3 * float(np.percentile(seconds, 95.0))
        print(f"view_draw while orbiting: p95 {p95:.1f} ms, {len(seconds)} draws, "
              f"{len(pictures)} pictures")
        self.assertLess(p95, 30.0)
        self.assertGreater(len(pictures), ORBIT_STEPS // 20)
        yield self.settled
        self.assertEqual(meshes.call_count, 0)
        self.camera_of_view()
        self.assertGreaterEqual(psnr(self.pixels(), self.render()), 35.0)

    def test_moved_object_shows_up(self):
        red = self.still_life()
        self.look()
        self.render_shading()
        yield self.settled
        before = self.pixels()
        meshes, transforms = (self.count_calls(n) for n in ("set_mesh", "set_object_transform"))
        red.location.x += 0.5
        yield lambda: psnr(self.pixels(), before) < 30.0 if (
            self.viewport.picture.width == self.size[0]) else False
        yield self.settled
        self.assertEqual((meshes.call_count, transforms.call_count), (0, 1))
        self.camera_of_view()
        self.assertGreaterEqual(psnr(self.pixels(), self.render()), 35.0)

    def test_changed_mesh_shows_up(self):
        red = self.still_life()
        self.look()
        self.render_shading()
        yield self.settled
        meshes = self.count_calls("set_mesh")
        red.data.transform(Matrix.Diagonal((1, 1, 1.5, 1)))
        red.data.update()
        yield lambda: meshes.call_count == 1 and self.settled()
        red.modifiers.new("Bevel", "BEVEL").width = 0.2
        yield lambda: meshes.call_count == 2 and self.settled()
        self.camera_of_view()
        self.assertGreaterEqual(psnr(self.pixels(), self.render()), 35.0)

    def test_nothing_new_nothing_done(self):
        red = self.still_life()
        self.look()
        self.render_shading()
        yield self.settled
        picture, edits = self.viewport.picture, self.viewport._session.edits
        seconds = self.time_draws()
        self.window.view_layer.objects.active = red
        red.select_set(True)
        self.area.tag_redraw()
        yield lambda: len(seconds) > 0
        self.assertEqual(self.viewport._session.edits, edits)
        self.assertIs(self.viewport.picture, picture)
        self.assertTrue(self.settled())

    def test_resized_without_leak_or_another_export(self):
        self.still_life()
        self.look()
        self.scene.kestrel.viewport_samples = 2
        system = bpy.context.preferences.system
        system.use_region_overlap = False  # then the sidebar takes its width from the view
        self.addCleanup(setattr, system, "use_region_overlap", True)
        self.render_shading()
        yield self.settled
        first, objects = self.viewport, self.count_calls("set_object")
        used = []
        for turn in range(RESIZES):
            width = self.region.width
            self.space.show_region_ui = not self.space.show_region_ui
            yield lambda: self.region.width != width
            yield lambda: self.settled() and self.viewport.picture.width == self.region.width
            used.append(resident_mib())
        self.assertIs(self.viewport, first)
        self.assertEqual(objects.call_count, 0)
        self.assertEqual(session.count(), 1)
        # One picture has about 8 MiB; the first resizes fill caches.
        print(f"resident memory: {used[5]:.0f} MiB, after {RESIZES - 6} resizes {used[-1]:.0f}")
        self.assertLess(used[-1] - used[5], 30.0)

    def test_two_views_at_once(self):
        self.still_life()
        self.look()
        self.scene.kestrel.viewport_samples = 1
        self.render_shading()
        yield self.settled
        with self.context():
            bpy.ops.screen.area_split(direction="VERTICAL", factor=0.5)
        yield lambda: len(viewport.open_viewports()) == 2 and self.settled()
        views = [item.picture.view for item in viewport.open_viewports()]
        self.assertTrue(all(400 < view.region[0] < 500 for view in views))
        self.assertEqual(session.count(), 2)


class EndTest(ViewportTest):
    """Nothing is left of a viewport, whatever it was doing."""

    samples = 4096  # never done

    def begin(self):
        self.still_life()
        self.look()
        self.render_shading()

    def started(self):
        return bool(viewport.open_viewports()) and self.viewport.picture is not None

    def check_gone(self, thread):
        self.assertEqual(session.count(), 0)
        self.assertEqual(viewport.open_viewports(), [])
        self.assertFalse(thread.is_alive())

    def test_other_shading(self):
        for _ in range(3):
            self.begin()
            yield self.started
            thread = self.viewport._thread
            self.space.shading.type = "SOLID"
            yield lambda: not viewport.open_viewports()
            self.check_gone(thread)

    def test_another_file(self):
        self.begin()
        yield self.started
        thread = self.viewport._thread
        bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
        self.check_gone(thread)

    def test_add_on_disabled(self):
        self.begin()
        yield self.started
        thread = self.viewport._thread
        addon_utils.disable("kestrel")
        self.addCleanup(addon_utils.enable, "kestrel")
        self.check_gone(thread)
        yield None


class PixelSizeTest(ViewportTest):
    """The automatic pixel size, with made-up times."""

    def setUp(self):
        pass

    def follow(self, ms_of_size, frames=50):
        size = PixelSize()
        values = []
        for frame in range(frames):
            values.append(size.value)
            size.learn(ms_of_size(size.value), 20.0, 40.0, 0.04 * frame)
        return values

    def test_fast_scenes_are_sharp(self):
        self.assertEqual(self.follow(lambda size: 5.0 + 15.0 / size ** 2)[-1], 1)

    def test_budget_does_not_keep_it_coarse(self):
        self.assertEqual(self.follow(lambda size: 20.0 + 10.0 / size ** 2)[-1], 1)

    def test_slow_scenes_stay_in_time(self):
        values = self.follow(lambda size: 320.0 / size ** 2)
        self.assertEqual(values[-1], 4)
        slow = sum(320.0 / v ** 2 > 40.0 for v in values)
        self.assertLessEqual(slow, 50 * 0.04 / RETRY_S + 1)

    def test_very_slow_scenes_are_as_coarse_as_allowed(self):
        self.assertEqual(self.follow(lambda size: 1e5 / size ** 2)[-1], COARSEST)
