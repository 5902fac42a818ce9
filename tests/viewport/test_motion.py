# SPDX-License-Identifier: GPL-3.0-or-later
"""While something changes the viewport follows, and Blender is never kept waiting."""

import os
from pathlib import Path

import bpy
import numpy as np
from kestrel import session
from mathutils import Matrix
from viewport_support import ViewportTest, psnr

ORBIT_STEPS = 100
RESIZES = 40  # while the resident memory of Blender itself comes and goes by 100 MiB


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
        meshes, transforms = (self.count_calls(n) for n in ("set_mesh", "set_object_transforms"))
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
        self.scene.kestrel.viewport_samples = 1
        system = bpy.context.preferences.system
        system.use_region_overlap = False  # then the sidebar takes its width from the view
        self.addCleanup(setattr, system, "use_region_overlap", True)
        self.render_shading()
        yield self.settled
        first, objects = self.viewport, self.count_calls("set_objects")
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
        quarter = RESIZES // 4
        first_mib, last_mib = (float(np.median(part)) for part in (used[:quarter], used[-quarter:]))
        picture_mib = self.viewport.picture.pixels.nbytes / 2 ** 20
        print(f"resident memory: {first_mib:.0f} MiB in the first {quarter} of {RESIZES} resizes, "
              f"{last_mib:.0f} in the last; a picture has {picture_mib:.1f}")
        self.assertLess(last_mib - first_mib, 0.5 * picture_mib * (RESIZES - quarter))
