# SPDX-License-Identifier: GPL-3.0-or-later
"""The camera: Blender's lens, sensor and shift as the window of the plane z = -1."""

from typing import NamedTuple

import numpy as np

from ..native import capi
from .object import columns

NEAREST_FOCUS_M = 1e-5


class Picture(NamedTuple):
    """What is rendered of a picture of width x height pixels."""
    width: int
    height: int
    area: tuple  # left, bottom, right, top, pixels

    @property
    def size(self):
        """(width, height) of what is rendered."""
        left, bottom, right, top = self.area
        return right - left, top - bottom


def frame_size(render):
    """(width, height) of the whole picture in pixels, before any border."""
    scale = render.resolution_percentage / 100.0
    return (max(1, int(render.resolution_x * scale)), max(1, int(render.resolution_y * scale)))


def border(render, width, height):
    """Pixels (left, bottom, right, top) that are rendered."""
    if not render.use_border:
        return 0, 0, width, height
    def pixel(share, side):
        return int(np.float32(share) * np.float32(side))  # rounded as Blender does

    left = min(pixel(render.border_min_x, width), width - 1)
    bottom = min(pixel(render.border_min_y, height), height - 1)
    return (left, bottom, max(pixel(render.border_max_x, width), left + 1),
            max(pixel(render.border_max_y, height), bottom + 1))


def window(camera, render, width, height):
    """(left, right, bottom, top) of the whole picture: on the plane z = -1 for perspective, in
    metres for orthographic. The sensor fits the wider side unless it is told which."""
    aspect_x, aspect_y = render.pixel_aspect_x * width, render.pixel_aspect_y * height
    horizontal = camera.sensor_fit == "HORIZONTAL" or (
        camera.sensor_fit == "AUTO" and aspect_x >= aspect_y)
    sensor = camera.sensor_height if camera.sensor_fit == "VERTICAL" else camera.sensor_width
    extent = camera.ortho_scale if camera.type == "ORTHO" else sensor / camera.lens
    unit = extent / (aspect_x if horizontal else aspect_y)
    half_x, half_y = 0.5 * aspect_x * unit, 0.5 * aspect_y * unit
    shift_x, shift_y = camera.shift_x * extent, camera.shift_y * extent
    return shift_x - half_x, shift_x + half_x, shift_y - half_y, shift_y + half_y


def crop(whole, area, width, height):
    """The part of a window that shows these pixels."""
    left, right, bottom, top = whole
    x, y = (right - left) / width, (top - bottom) / height
    return (left + area[0] * x, left + area[2] * x, bottom + area[1] * y, bottom + area[3] * y)


def rigid(matrix):
    """The matrix without its scale."""
    location, rotation, _ = matrix.decompose()
    result = rotation.to_matrix().to_4x4()
    result.translation = location
    return result


def focus_distance(obj):
    """Metres along the view from an evaluated camera to what it focuses on."""
    dof = obj.data.dof
    target = dof.focus_object
    if target is None:
        return max(dof.focus_distance, NEAREST_FOCUS_M)
    place = target.matrix_world
    bone = target.pose.bones.get(dof.focus_subtarget) if target.pose else None
    if bone is not None:
        place = place @ bone.matrix
    depth = (rigid(obj.matrix_world).inverted() @ place.translation).z
    return max(abs(depth), NEAREST_FOCUS_M)


def aperture(obj):
    """The part of capi.Camera that blurs what is out of focus: radius (0: nothing), focus distance,
    blades, rotation and ratio."""
    data, dof = obj.data, obj.data.dof
    if not dof.use_dof:
        return 0.0, 1.0, 0, 0.0, 1.0
    focal_length = 1.0 if data.type == "ORTHO" else 1e-3 * data.lens
    return (focal_length / (2.0 * max(dof.aperture_fstop, 1e-5)), focus_distance(obj),
            dof.aperture_blades, dof.aperture_rotation, dof.aperture_ratio)


def set_aperture(item, values):
    (item.aperture_radius, item.focus_distance, item.aperture_blades, item.aperture_rotation,
     item.aperture_ratio) = values


def sync_camera(export, obj, render):
    """Send the camera, which sees the whole picture; returns the Picture."""
    item, picture = camera_item(export, obj, render)
    export.scene.set_camera(item)
    return picture


def camera_item(export, obj, render):
    """(capi.Camera, Picture) of an evaluated object or None."""
    if obj is None:
        raise capi.KestrelError(
            "The scene has no camera. Add one with Add > Camera, or make one the scene's camera "
            "in Scene properties.")
    if obj.type != "CAMERA":
        raise capi.KestrelError(
            f"'{obj.name}' is the scene's camera but no camera object, which Kestrel cannot look "
            "through. Choose a camera object in Scene properties.")
    data = obj.data
    if data.type not in {"PERSP", "ORTHO"}:
        export.warn(f"Camera '{obj.name}': panoramic lenses are not supported; it is drawn in "
                    "perspective.")
    width, height = frame_size(render)
    item = capi.Camera()
    item.projection = capi.ORTHOGRAPHIC if data.type == "ORTHO" else capi.PERSPECTIVE
    item.world_from_camera[:] = columns(rigid(obj.matrix_world))
    item.left, item.right, item.bottom, item.top = window(data, render, width, height)
    item.near_clip, item.far_clip = data.clip_start, data.clip_end
    set_aperture(item, aperture(obj))
    return item, Picture(width, height, border(render, width, height))
