# SPDX-License-Identifier: GPL-3.0-or-later
"""What a 3D view looks at: its camera, and which of its pixels are drawn.

Blender's own window matrix of the region says what it shows, whether in perspective, orthographic
or through the camera with its shift, zoom and offset.
"""

import math
from dataclasses import dataclass

from mathutils import Matrix

from ..native import capi
from .camera import aperture, crop, frame_size, rigid, set_aperture, window
from .object import columns

PINHOLE = (0.0, 1.0, 0, 0.0, 1.0)


@dataclass(frozen=True)
class View:
    """Views that compare equal give the same picture of a scene."""
    projection: int           # capi.PERSPECTIVE or ORTHOGRAPHIC
    world_from_camera: tuple  # 12 floats, column by column
    window: tuple             # (left, right, bottom, top) of the area, as capi.Camera has them
    clip: tuple               # (near, far), metres
    region: tuple             # (width, height), pixels
    area: tuple               # (left, bottom, right, top) of what is drawn, pixels of the region
    aperture: tuple           # as camera.aperture() has it

    @property
    def size(self):
        """(width, height) of the picture in pixels."""
        return self.area[2] - self.area[0], self.area[3] - self.area[1]

    def camera(self):
        item = capi.Camera()
        item.projection = self.projection
        item.world_from_camera[:] = self.world_from_camera
        item.left, item.right, item.bottom, item.top = self.window
        item.near_clip, item.far_clip = self.clip
        set_aperture(item, self.aperture)
        return item


def region_window(matrix):
    """(left, right, bottom, top) of a window matrix: on the plane z = -1 in perspective, in metres
    in orthographic views."""
    if matrix[3][3] == 0.0:
        x, y, center_x, center_y = matrix[0][0], matrix[1][1], matrix[0][2], matrix[1][2]
    else:
        x, y, center_x, center_y = matrix[0][0], matrix[1][1], -matrix[0][3], -matrix[1][3]
    return (center_x - 1.0) / x, (center_x + 1.0) / x, (center_y - 1.0) / y, (center_y + 1.0) / y


def view_camera(space, scene):
    """The object that the view's camera view looks through, or None."""
    return space.camera if space.use_local_camera else scene.camera


def clip_range(space, rv3d, camera):
    """(near, far), metres. Orthographic views that are no camera's also show what is behind the
    view's place."""
    if rv3d.view_perspective == "CAMERA" and camera and camera.type == "CAMERA":
        return camera.data.clip_start, camera.data.clip_end
    if rv3d.is_perspective:
        return space.clip_start, space.clip_end
    return -space.clip_end, space.clip_end


def view_aperture(rv3d, camera):
    """What is out of focus is blurred through a camera alone."""
    if rv3d.view_perspective == "CAMERA" and camera and camera.type == "CAMERA":
        return aperture(camera)
    return PINHOLE


def camera_frame(camera, render, shown, region):
    """(left, bottom, right, top) of a camera's picture in pixels of a region that shows the window
    `shown`; they may lie outside."""
    frame = window(camera.data, render, *frame_size(render))
    x, y = region[0] / (shown[1] - shown[0]), region[1] / (shown[3] - shown[2])
    return ((frame[0] - shown[0]) * x, (frame[2] - shown[2]) * y,
            (frame[1] - shown[0]) * x, (frame[3] - shown[2]) * y)


def border_area(outer, border, region):
    """Pixels (left, bottom, right, top) of the region within `border`, which is given in parts of
    the rectangle `outer`; at least one pixel."""
    width, height = outer[2] - outer[0], outer[3] - outer[1]
    left = min(max(math.floor(outer[0] + border[0] * width), 0), region[0] - 1)
    bottom = min(max(math.floor(outer[1] + border[1] * height), 0), region[1] - 1)
    return (left, bottom, min(max(math.ceil(outer[0] + border[2] * width), left + 1), region[0]),
            min(max(math.ceil(outer[1] + border[3] * height), bottom + 1), region[1]))


def drawn_area(space, rv3d, render, camera, shown, region):
    """Pixels (left, bottom, right, top) of the region that are drawn."""
    whole = (0, 0, *region)
    if rv3d.view_perspective == "CAMERA":
        if not render.use_border or not camera or camera.type != "CAMERA":
            return whole
        limits = (render.border_min_x, render.border_min_y, render.border_max_x,
                  render.border_max_y)
        return border_area(camera_frame(camera, render, shown, region), limits, region)
    if not space.use_render_border:
        return whole
    return border_area(whole, (space.render_border_min_x, space.render_border_min_y,
                               space.render_border_max_x, space.render_border_max_y), region)


def region_view(region, space, rv3d, depsgraph):
    """The View of a region of a 3D view; None where it has no pixels."""
    size = region.width, region.height
    if min(size) < 1:
        return None
    scene = depsgraph.scene_eval
    camera = view_camera(space, scene)
    camera = camera.evaluated_get(depsgraph) if camera else None
    matrix = rv3d.window_matrix
    shown = region_window(matrix)
    area = drawn_area(space, rv3d, scene.render, camera, shown, size)
    world_from_camera = rigid(rv3d.view_matrix.inverted())
    near, far = clip_range(space, rv3d, camera)
    if near < 0.0:
        world_from_camera = world_from_camera @ Matrix.Translation((0.0, 0.0, -near))
        near, far = 0.0, far - near
    return View(
        projection=capi.PERSPECTIVE if matrix[3][3] == 0.0 else capi.ORTHOGRAPHIC,
        world_from_camera=columns(world_from_camera), window=crop(shown, area, *size),
        clip=(near, far), region=size, area=area, aperture=view_aperture(rv3d, camera))
