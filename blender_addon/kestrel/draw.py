# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws a picture into a 3D view. Main thread only."""

import gpu
from gpu_extras.batch import batch_for_shader


def upload(picture):
    """A texture of a picture; there is no way to replace an old one's texels."""
    data = gpu.types.Buffer("FLOAT", picture.pixels.size, picture.pixels.reshape(-1))
    return gpu.types.GPUTexture((picture.width, picture.height), format="RGBA32F", data=data)


def rectangle(area, region, now):
    """Corners (left, bottom, right, top) of an area of a region that had another size then."""
    x, y = now[0] / region[0], now[1] / region[1]
    return area[0] * x, area[1] * y, area[2] * x, area[3] * y


def quad(shader, left, bottom, right, top):
    return batch_for_shader(shader, "TRI_STRIP", {
        "pos": ((left, bottom, 0), (right, bottom, 0), (left, top, 0), (right, top, 0)),
        "texCoord": ((0, 0), (1, 0), (0, 1), (1, 1))})


class Painter:
    """Holds the texture of the picture that was drawn last."""

    def __init__(self):
        self._picture = None
        self._texture = None

    def draw(self, engine, scene, picture, region):
        """Draw into the bound view of `region` pixels (width, height); scene-linear colours, which
        Blender then brings to the display."""
        if self._picture is not picture:
            self._picture, self._texture = picture, upload(picture)
        shader = gpu.shader.from_builtin("IMAGE")
        gpu.state.blend_set("ALPHA_PREMULT")
        engine.bind_display_space_shader(scene)
        shader.bind()
        shader.uniform_sampler("image", self._texture)
        quad(shader, *rectangle(picture.view.area, picture.view.region, region)).draw(shader)
        engine.unbind_display_space_shader()
        gpu.state.blend_set("NONE")
