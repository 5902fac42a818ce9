# SPDX-License-Identifier: GPL-3.0-or-later
"""What the viewport's tests share: a scene in a 3D view that fills the window."""

import math
import time
from unittest import mock

import bpy
import numpy as np
from kestrel import engine, viewport
from kestrel.native import capi
from mathutils import Quaternion, Vector
from support import SceneTest, diffuse, shader_material


class ViewportTest(SceneTest):
    """The window's only area is a 3D view without overlays; Rendered shading is off."""

    size = (960, 540)
    samples = 8

    def setUp(self):
        super().setUp()
        self.scene.kestrel.viewport_samples = self.scene.kestrel.samples = self.samples
        self.fill_window()
        self.addCleanup(self.close)

    # ---- the window ----

    @property
    def window(self):
        return bpy.context.window_manager.windows[0]

    @property
    def area(self):
        return next(a for a in self.window.screen.areas if a.type == "VIEW_3D")

    @property
    def region(self):
        return next(r for r in self.area.regions if r.type == "WINDOW")

    @property
    def space(self):
        return self.area.spaces.active

    @property
    def rv3d(self):
        return self.space.region_3d

    def context(self):
        return bpy.context.temp_override(window=self.window, area=self.area, region=self.region)

    def fill_window(self):
        """Let the 3D view take the whole window."""
        area = next(a for a in self.window.screen.areas if a.type == "VIEW_3D")
        with bpy.context.temp_override(window=self.window, area=area):
            bpy.ops.screen.screen_full_area(use_hide_panels=True)
        self.space.overlay.show_overlays = False
        self.space.show_gizmo = False

    def close(self):
        """Leave Rendered shading in every 3D view."""
        for area in self.window.screen.areas:
            if area.type == "VIEW_3D":
                area.spaces.active.shading.type = "SOLID"

    def look(self, distance=8.0, azimuth_deg=30.0, target=(0, 0, 0.5)):
        """Look at a point from above and the side, in perspective."""
        self.rv3d.view_perspective = "PERSP"
        self.rv3d.view_location, self.rv3d.view_distance = Vector(target), distance
        self.rv3d.view_rotation = (Quaternion((0, 0, 1), math.radians(azimuth_deg)) @
                                   Quaternion((1, 0, 0), math.radians(65.0)))

    def render_shading(self):
        self.space.shading.type = "RENDERED"

    # ---- the viewport ----

    @property
    def viewport(self):
        """The only one that is open."""
        found, = viewport.open_viewports()
        return found

    def settled(self):
        """Whether all 3D views have finished their pictures."""
        found = viewport.open_viewports()
        for item in found:
            if item.error:
                raise AssertionError(item.error)
        return bool(found) and all(item.settled for item in found)

    def pixels(self):
        """Height x width x 4 of the viewport's picture, first row on top."""
        picture = self.viewport.picture
        return picture.pixels.reshape(picture.height, picture.width, 4)[::-1].copy()

    def camera_of_view(self):
        """A camera that sees what the view in perspective does, at the region's size."""
        camera = self.camera()
        camera.matrix_world = self.rv3d.view_matrix.inverted()
        camera.data.lens = self.space.lens / 2.0  # views show twice the angle of a 36 mm sensor
        camera.data.clip_start = self.space.clip_start
        camera.data.clip_end = self.space.clip_end
        render = self.scene.render
        render.resolution_x, render.resolution_y = self.region.width, self.region.height
        return camera

    # ---- scenes ----

    def still_life(self):
        """A floor, a red cube, a mirror and a light."""
        self.world((0.2, 0.25, 0.3))
        self.light("SUN", 3.0, (3, -2, 5))
        self.plane("Floor", 8.0, diffuse("Grey", (0.6, 0.6, 0.6)))
        red = self.cube("Red", 1.0, diffuse("Red", (0.8, 0.1, 0.05)))
        red.location = (0.9, -0.6, 0.5)
        mirror = self.cube("Mirror", 1.4, shader_material(
            "Mirror", "ShaderNodeBsdfGlossy", Color=(0.9, 0.9, 0.9), Roughness=0.0))
        mirror.location = (-0.9, 0.4, 0.7)
        return red

    def count_calls(self, name):
        """A mock that counts how often this method of capi.Scene is called from now on."""
        original = getattr(capi.Scene, name)
        patch = mock.patch.object(capi.Scene, name, autospec=True, side_effect=original)
        counter = patch.start()
        self.addCleanup(patch.stop)
        return counter

    def time_draws(self):
        """A list to which every view_draw() from now on appends its seconds."""
        seconds = []
        original = engine.KestrelRenderEngine.view_draw

        def timed(self_, context, depsgraph):
            begin = time.perf_counter()
            original(self_, context, depsgraph)
            seconds.append(time.perf_counter() - begin)

        patch = mock.patch.object(engine.KestrelRenderEngine, "view_draw", timed)
        patch.start()
        self.addCleanup(patch.stop)
        return seconds


def psnr(a, b):
    """Peak signal to noise ratio of two pictures' colours, dB, for a peak of 1."""
    error = float(np.mean((a[..., :3].astype(np.float64) - b[..., :3]) ** 2))
    return math.inf if error == 0.0 else -10.0 * math.log10(error)
