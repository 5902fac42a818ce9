# SPDX-License-Identifier: GPL-3.0-or-later
"""A view's camera puts every point where Blender itself draws it."""

import bpy
from bpy_extras.view3d_utils import location_3d_to_region_2d
from kestrel import session, viewport
from kestrel.native import capi
from kestrel.sync.view import region_view
from mathutils import Matrix, Vector
from viewport_support import ViewportTest, psnr

POINTS = [Vector((x, y, z)) for x in (-1.0, 0.3, 1.0) for y in (-1.0, 1.0) for z in (0.0, 1.2)]


def world_from_camera(view):
    columns = [view.world_from_camera[i:i + 3] for i in range(0, 12, 3)]
    return Matrix([(*(column[row] for column in columns),) for row in range(3)] + [(0, 0, 0, 1)])


def region_position(view, point):
    """Where the core draws a point, in pixels of the region."""
    x, y, z = world_from_camera(view).inverted() @ point
    if view.projection == capi.PERSPECTIVE:
        x, y = x / -z, y / -z
    left, right, bottom, top = view.window
    width, height = view.size
    return Vector((view.area[0] + (x - left) / (right - left) * width,
                   view.area[1] + (y - bottom) / (top - bottom) * height))


class ViewTest(ViewportTest):
    def view(self, region=None, rv3d=None):
        depsgraph = bpy.context.evaluated_depsgraph_get()
        return region_view(region or self.region, self.space, rv3d or self.rv3d, depsgraph)

    def check(self, view, region=None, rv3d=None):
        for point in POINTS:
            wanted = location_3d_to_region_2d(region or self.region, rv3d or self.rv3d, point)
            self.assertLess((region_position(view, point) - wanted).length, 0.02)

    def look_through(self, **settings):
        camera = self.camera((4, -6, 3), (0, 0, 0.5), **settings)
        self.rv3d.view_perspective = "CAMERA"
        return camera

    def test_perspective(self):
        self.look()
        yield None
        yield None
        view = self.view()
        self.assertEqual(view.projection, capi.PERSPECTIVE)
        self.assertEqual(view.area, (0, 0, *self.size))
        self.check(view)

    def test_orthographic(self):
        self.look()
        self.rv3d.view_perspective = "ORTHO"
        yield None
        yield None
        view = self.view()
        self.assertEqual(view.projection, capi.ORTHOGRAPHIC)
        self.check(view)
        behind = self.rv3d.view_matrix.inverted() @ Vector((0, 0, 100))
        depth = -(world_from_camera(view).inverted() @ behind).z
        self.assertTrue(0.0 <= view.clip[0] < depth < view.clip[1])

    def test_camera(self):
        for settings in ({}, {"shift_x": 0.2, "shift_y": -0.1}, {"sensor_fit": "VERTICAL"},
                         {"ortho_scale": 4.0, "shift_x": 0.1}):
            camera = self.look_through(**settings)
            self.scene.render.resolution_x, self.scene.render.resolution_y = 400, 300
            for zoom, offset in ((0.0, (0, 0)), (20.0, (0.1, -0.2))):
                self.rv3d.view_camera_zoom, self.rv3d.view_camera_offset = zoom, offset
                yield None
                yield None
                view = self.view()
                self.check(view)
                self.assertEqual(view.clip, (camera.data.clip_start, camera.data.clip_end))

    def test_border_within_the_camera_frame(self):
        camera = self.look_through(shift_x=0.1)
        render = self.scene.render
        render.use_border = True
        render.border_min_x, render.border_max_x = 0.25, 0.75
        render.border_min_y, render.border_max_y = 0.5, 0.9
        yield None
        yield None
        view = self.view()
        self.check(view)
        corners = [camera.matrix_world @ c for c in camera.data.view_frame(scene=self.scene)]
        corners = [location_3d_to_region_2d(self.region, self.rv3d, c) for c in corners]
        left, right = min(c.x for c in corners), max(c.x for c in corners)
        bottom, top = min(c.y for c in corners), max(c.y for c in corners)
        wanted = (left + 0.25 * (right - left), bottom + 0.5 * (top - bottom),
                  left + 0.75 * (right - left), bottom + 0.9 * (top - bottom))
        for actual, expected in zip(view.area, wanted):
            self.assertLess(abs(actual - expected), 1.01)

    def test_border_of_the_view(self):
        self.still_life()
        self.look()
        self.render_shading()
        yield self.settled
        whole = self.pixels()
        self.space.use_render_border = True
        self.space.render_border_min_x, self.space.render_border_max_x = 0.25, 0.75
        self.space.render_border_min_y, self.space.render_border_max_y = 0.25, 0.5
        self.area.tag_redraw()
        yield lambda: self.settled() and self.viewport.picture.width < 500
        self.assertEqual(self.viewport.picture.view.area, (240, 135, 720, 270))
        self.assertGreater(psnr(self.pixels(), whole[270:405, 240:720]), 50.0)

    def test_quad_view(self):
        self.still_life()
        self.look()
        self.scene.kestrel.viewport_samples = 1
        with self.context():
            bpy.ops.screen.region_quadview()
        self.render_shading()
        yield lambda: len(viewport.open_viewports()) == 4 and self.settled()
        regions = [r for r in self.area.regions if r.type == "WINDOW"]
        for region, rv3d in zip(regions, self.space.region_quadviews):
            self.check(self.view(region, rv3d), region, rv3d)
        self.assertEqual(sum(v.picture.view.projection == capi.PERSPECTIVE
                             for v in viewport.open_viewports()), 1)
        with self.context():
            bpy.ops.screen.region_quadview()
        yield lambda: len(viewport.open_viewports()) == 1 and self.settled()

    def test_two_views_at_once(self):
        self.still_life()
        self.look()
        self.scene.kestrel.viewport_samples = 1
        with self.context():
            bpy.ops.screen.back_to_previous()
        yield None
        next(a for a in self.window.screen.areas if a.type != "VIEW_3D").type = "VIEW_3D"
        areas = [a for a in self.window.screen.areas if a.type == "VIEW_3D"]
        for area in areas:
            area.spaces.active.shading.type = "RENDERED"
        yield lambda: len(viewport.open_viewports()) == 2 and self.settled()
        sizes = [item.picture.view.region for item in viewport.open_viewports()]
        regions = [next((r.width, r.height) for r in area.regions if r.type == "WINDOW")
                   for area in areas]
        self.assertCountEqual(sizes, regions)
        self.assertEqual(session.count(), 2)
