# SPDX-License-Identifier: GPL-3.0-or-later
"""Images: by path where the library can read files itself, else as pixels.

The library's image plug-in reads plain and packed files. Painted, generated and rendered images,
and every image where the plug-in is missing, go over as Blender's pixels: 8-bit images as stored,
float images scene-linear.
"""

import os

import bpy
import numpy as np

from .. import compat
from ..native import capi, loader
from ..session import digest

LINEAR_SPACES = {"Non-Color", "Raw", "Linear", "Linear Rec.709", "Linear BT.709", "scene_linear"}


def file_path(image):
    """Absolute path of an image's file; of tiled images the first tile's."""
    path = bpy.path.abspath(image.filepath, library=image.library)
    return path.replace("<UDIM>", "1001").replace("<UVTILE>", "u1_v1")


def is_srgb(image):
    """Whether 8-bit texels are taken for sRGB-encoded."""
    return image.colorspace_settings.name not in LINEAR_SPACES


def shortcomings(image):
    """Texts: what is not done with an image as Blender does it."""
    space = image.colorspace_settings.name
    if is_srgb(image) and space != "sRGB":
        yield f"colour space '{space}' is not supported; it is read as sRGB"
    if image.source in {"SEQUENCE", "MOVIE", "TILED"}:
        yield (f"{image.source.lower()} images are not supported; only its first picture is used")


def pixels(image):
    """(height, width, 4) of an image, row 0 at the bottom: uint8 as stored, or float32. None where
    the image has no pixels (its file is missing)."""
    was_loaded = image.has_data
    width, height = image.size
    if width == 0 or height == 0:
        return None
    values = np.empty(width * height * image.channels, np.float32)
    image.pixels.foreach_get(values)
    values = values.reshape(height, width, image.channels)
    if not was_loaded and image.source == "FILE" and not image.is_dirty:
        image.buffers_free()  # give back the memory that only this reading took
    if image.channels != 4:
        rgba = np.ones((height, width, 4), np.float32)
        count = min(image.channels, 3)
        rgba[..., :3] = values[..., :1] if count < 3 else values[..., :3]
        values = rgba
    if image.is_float:
        return values
    values *= 255.0  # bytes over 255: whole numbers again, up to rounding
    values += 0.5
    return values.astype(np.uint8)


def _as_file(export, image, ident, options, extra):
    """Hand over a path or the packed bytes; False where pixels must do."""
    if image.is_dirty or image.source not in {"FILE", "SEQUENCE", "TILED"}:
        return False
    scene = export.scene
    if image.packed_file:
        if not loader.image_plugin_available():
            return False
        data = image.packed_file.data
        export.put(capi.KIND_TEXTURE, ident, ("packed", digest(data), extra),
                   lambda: scene.set_texture_memory(ident, data, options))
        return True
    path = file_path(image)
    there = os.path.isfile(path)
    if there and not loader.image_plugin_available():
        return False
    stat = os.stat(path) if there else None
    state = (stat.st_mtime_ns, stat.st_size) if stat else None
    export.put(capi.KIND_TEXTURE, ident, ("file", path, state, extra),
               lambda: scene.set_texture_file(ident, path, options))
    return True


def _as_pixels(export, image, ident, options, extra):
    values = pixels(image)
    if values is None:  # the library draws it magenta and says so
        path = file_path(image) or image.name
        export.put(capi.KIND_TEXTURE, ident, ("file", path, None, extra),
                   lambda: export.scene.set_texture_file(ident, path, options))
        return
    export.put(capi.KIND_TEXTURE, ident, ("pixels", digest(values), extra),
               lambda: export.scene.set_texture_pixels(ident, values, options))


def original(image):
    """The image in the file; pixels and packed data are there and not in evaluated copies."""
    return image.original if image is not None and image.is_evaluated else image


def _resized(values, height, width):
    """Nearest texels at another size."""
    rows = np.arange(height) * values.shape[0] // height
    columns = np.arange(width) * values.shape[1] // width
    return values[rows[:, None], columns]


def masked_pixels(image, mask):
    """Pixels of `image` (white for None) with the alpha of a nodes.Mask; uint8 or float32."""
    source = pixels(original(mask.image))
    if source is None:
        return None
    alpha = source[..., 3] if mask.from_alpha else source[..., :3].mean(axis=-1)
    if source.dtype == np.uint8:
        alpha = alpha / np.float32(255.0)
    alpha = 1.0 - alpha if mask.inverted else alpha
    base = np.full((*alpha.shape, 4), 255, np.uint8) if image is None else pixels(image)
    if base is None:
        return None
    if base.dtype == np.uint8:
        alpha = np.rint(alpha * 255.0)
    size = np.maximum(base.shape[:2], alpha.shape[:2])
    result = np.ascontiguousarray(_resized(base, *size))
    result[..., 3] = _resized(alpha, *size)
    return result


def _as_masked(export, image, mask, ident, options, extra):
    values = masked_pixels(image, mask)
    if values is None:
        export.warn(f"Image '{mask.image.name}': it could not be read, so it cuts no holes.")
        return False
    export.put(capi.KIND_TEXTURE, ident, ("pixels", digest(values), extra),
               lambda: export.scene.set_texture_pixels(ident, values, options))
    return True


def sync_texture(export, texture):
    """Id of an image, sampled this way, in the core."""
    image, mask = original(texture.image), texture.mask
    shown = image or original(mask.image)
    srgb = image is not None and is_srgb(image)
    extra = (srgb, texture.nearest, texture.extension)
    key = f"{image and compat.datablock_key(image)}/{extra}"
    if mask:
        source = compat.datablock_key(original(mask.image))
        key += f"/{source}/{mask.from_alpha}/{mask.inverted}"
    if key not in export.textures:
        for text in shortcomings(shown):
            export.warn(f"Image '{shown.name}': {text}.")
        options = capi.TextureOptions(capi.encode(shown.name), *extra)
        ident = export.new_id(capi.KIND_TEXTURE, key)
        if not (mask and _as_masked(export, image, mask, ident, options, extra)):
            if not _as_file(export, shown, ident, options, extra):
                _as_pixels(export, shown, ident, options, extra)
        export.textures[key] = ident
    return export.textures[key]


def _linear_sample(image):
    """float64 (h, w, 3) of an image, linear, thinned out evenly to about 512 texels a side; None
    where it has no pixels."""
    values = pixels(image)
    if values is None:
        return None
    step = max(1, min(values.shape[:2]) // 512)
    colors = values[step // 2::step, step // 2::step, :3].astype(np.float64)
    if values.dtype == np.uint8:
        colors /= 255.0
        if is_srgb(image):
            colors = np.where(colors <= 0.04045, colors / 12.92, ((colors + 0.055) / 1.055) ** 2.4)
    return colors


def mean_color(image):
    """Mean of an image's texels, linear; white where it has none."""
    colors = _linear_sample(original(image))
    return (1.0, 1.0, 1.0) if colors is None else tuple(map(float, colors.mean(axis=(0, 1))))


def mean_radiance(image):
    """Mean of an equirectangular image over the sphere: rows weighted by their solid angle; black
    where it has no texels."""
    colors = _linear_sample(original(image))
    if colors is None:
        return 0.0, 0.0, 0.0
    latitude = (np.arange(len(colors)) + 0.5) / len(colors) * np.pi
    weights = np.sin(latitude)
    return tuple(map(float, (colors.mean(axis=1) * weights[:, None]).sum(axis=0) / weights.sum()))


def cached_mean(export, texture, mean):
    """mean(image), worked out again only when what the texture shows has changed."""
    ident = sync_texture(export, texture)
    key = (mean.__name__, ident, export.session.sent[capi.KIND_TEXTURE, ident])
    means = export.session.means
    if key not in means:
        means[key] = mean(texture.image)
    return means[key]
