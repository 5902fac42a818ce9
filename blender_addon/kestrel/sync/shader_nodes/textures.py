# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes of Blender's Texture menu."""

import bpy

from ...native import capi
from ..nodes import EXTENSIONS, Texture

SKY = (0.30, 0.48, 0.80)  # stands for a sky
DISPLAY_GAMMA = 2.2       # about that of sRGB
DATA_SPACES = {"Non-Color", "Raw"}


BLENDER = str(min(max(bpy.app.version[0], 3), 5))  # whose textures these are


# ---- images ----------------------------------------------------------------------------------

def sampled(site, projection, vector, blend, extension):
    """RGBA of the node's image at a vector."""
    node = site.node
    if node.interpolation in ("Cubic", "Smart"):
        site.note("its image is interpolated linearly")
    texture = site.b.texture(Texture(node.image, node.interpolation == "Closest", extension))
    value = site.b.op("image", vector, blend, modes=(projection,), data=texture)
    if site.output.name == "Alpha":
        return site.b.component(value, "ALPHA")
    if node.type == "TEX_IMAGE" and has_coverage(node.image) and not node.outputs["Alpha"].is_linked:
        # Cycles takes the colours times their alpha then, before it decodes them.
        alpha = site.b.component(value, "ALPHA")
        decoded = alpha if node.image.is_float else site.b.math("POWER", alpha, DISPLAY_GAMMA)
        return site.b.multiply(value, decoded)
    return value


def has_coverage(picture):
    """Whether an image's alpha says how much of a texel is there."""
    return (picture.alpha_mode == "STRAIGHT" and picture.depth in (32, 64, 128) and
            picture.colorspace_settings.name not in DATA_SPACES)


def mirrored(b, vector):
    """Texture coordinates that run back and forth."""
    return b.combine(*(b.math("PINGPONG", b.component(vector, which), 1.0) for which in "XY"), 0.0)


def image(site):
    node, b = site.node, site.b
    if node.image is None:
        return b.constant(0.0)
    vector = site.vector(site.uv)
    extension = EXTENSIONS.get(node.extension)
    if extension is None:  # MIRROR
        extension = capi.EXTENSION_CLAMP
        if node.projection == "FLAT":
            vector = mirrored(b, vector)
        else:
            site.note("its image repeats instead of being mirrored")
            extension = capi.EXTENSION_REPEAT
    return sampled(site, node.projection, vector, node.projection_blend, extension)


def environment(site):
    node = site.node
    if node.image is None:
        return site.b.constant(0.0)
    vector = site.vector(lambda: site.c.input("POSITION"))
    return sampled(site, node.projection, vector, 0.0, capi.EXTENSION_REPEAT)


# ---- patterns --------------------------------------------------------------------------------

def checker(site):
    return site.b.op("checker", site.vector(site.generated), site.value("Color1"),
                     site.value("Color2"), site.value("Scale"),
                     modes=("COLOR" if site.output.name == "Color" else "FAC",))


def gradient(site):
    return site.b.op("gradient", site.vector(site.generated), modes=(site.node.gradient_type,))


def magic(site):
    color = site.b.op("magic", site.vector(site.generated), site.value("Scale"),
                      site.value("Distortion"), modes=(str(site.node.turbulence_depth), BLENDER))
    return color if site.output.name == "Color" else site.b.average(color)


def wave(site):
    node = site.node
    direction = node.bands_direction if node.wave_type == "BANDS" else node.rings_direction
    direction = "DIAGONAL" if direction == "SPHERICAL" else direction
    return site.b.op("wave", site.vector(site.generated), site.value("Scale"),
                     site.value("Distortion"), site.value("Detail"),
                     site.value("Detail Scale", default=1.0),
                     site.value("Detail Roughness", default=0.5),
                     site.value("Phase Offset", default=0.0),
                     modes=(node.wave_type, direction, node.wave_profile, BLENDER))


def brick(site):
    node, b = site.node, site.b
    pattern = (node.offset, float(node.offset_frequency), node.squash, float(node.squash_frequency))
    found = b.op("brick", site.vector(site.generated), site.value("Scale"),
                 site.value("Mortar Size"), site.value("Mortar Smooth"), site.value("Bias"),
                 site.value("Brick Width"), site.value("Row Height"), data=(pattern,))
    mortar = b.component(found, "Y")
    if site.output.name != "Color":
        return mortar
    bricks = b.mix(b.component(found, "X"), site.value("Color1"), site.value("Color2"))
    return b.mix(mortar, bricks, site.value("Mortar"))


def white_noise(site):
    return site.b.op("white_noise", site.value("Vector"), site.value("W"), modes=(
        site.node.noise_dimensions, "VALUE" if site.output.name == "Value" else "COLOR"))


# ---- noise -----------------------------------------------------------------------------------

def noise(site):
    node, b = site.node, site.b
    normalize = getattr(node, "normalize", True)
    offset_gain = b.combine(site.value("Offset", default=0.0), site.value("Gain", default=1.0), 0.0)
    return b.op("noise", site.vector(site.generated), site.value("W"), site.value("Scale"),
                site.value("Detail"), site.value("Roughness"),
                site.value("Lacunarity", default=2.0), site.value("Distortion"), offset_gain,
                modes=(node.noise_dimensions, getattr(node, "noise_type", "FBM"),
                       "YES" if normalize else "NO",
                       "COLOR" if site.output.name == "Color" else "FAC", BLENDER))


def musgrave(site):
    node = site.node
    return site.b.op("musgrave", site.vector(site.generated), *(site.value(name) for name in (
        "W", "Scale", "Detail", "Dimension", "Lacunarity", "Offset", "Gain")),
        modes=(node.musgrave_dimensions, node.musgrave_type))


def voronoi(site):
    node, b = site.node, site.b
    detail = b.combine(site.value("Detail", default=0.0), site.value("Roughness", default=0.5),
                       site.value("Lacunarity", default=2.0))
    output = site.output.name.upper()
    return b.op("voronoi", site.vector(site.generated), *(site.value(name) for name in (
        "W", "Scale", "Smoothness", "Exponent", "Randomness")), detail,
        modes=(node.voronoi_dimensions, node.distance, node.feature,
               "YES" if getattr(node, "normalize", False) else "NO",
               "DISTANCE" if output == "RADIUS" else output, BLENDER))


# ---- others ----------------------------------------------------------------------------------

def sky(site):
    site.note("a plain sky colour is used")
    return site.b.constant(*SKY)


def ies(site):
    site.note("it shines the same in all directions")
    return site.value("Strength")


def nothing(site):
    site.note("it gives 0")
    return site.b.constant(0.0)


VALUES = {
    "TEX_IMAGE": image,
    "TEX_ENVIRONMENT": environment,
    "TEX_CHECKER": checker,
    "TEX_GRADIENT": gradient,
    "TEX_MAGIC": magic,
    "TEX_WAVE": wave,
    "TEX_BRICK": brick,
    "TEX_WHITE_NOISE": white_noise,
    "TEX_NOISE": noise,
    "TEX_MUSGRAVE": musgrave,
    "TEX_VORONOI": voronoi,
    "TEX_SKY": sky,
    "TEX_IES": ies,
    "TEX_POINTDENSITY": nothing,
    "TEX_GABOR": nothing,
}
