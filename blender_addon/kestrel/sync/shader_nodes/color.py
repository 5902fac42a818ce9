# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes of Blender's Color menu."""

from .curves import curves


def faded(site, factor, before, after):
    return site.b.mix(factor, before, after)


def mix_color(site, blend_type, operands, clamp_factor, clamp_result):
    return site.b.op("mix_color", *operands, modes=(
        blend_type, "YES" if clamp_factor else "NO", "YES" if clamp_result else "NO"))


def mix_rgb(site):
    """MixRGB, until 3.3 and in files from then."""
    operands = [site.value(i) for i in range(3)]
    return mix_color(site, site.node.blend_type, operands, True, site.node.use_clamp)


def mix(site):
    node, b = site.node, site.b
    kind = {"RGBA": "Color", "FLOAT": "Float", "VECTOR": "Vector"}.get(node.data_type)
    if kind is None:  # ROTATION
        site.note("the first of the two is used")
        return site.value("A_Rotation")
    several = kind == "Vector" and node.factor_mode == "NON_UNIFORM"
    factor = site.value("Factor_Vector" if several else "Factor_Float")
    first, second = site.value(f"A_{kind}"), site.value(f"B_{kind}")
    if kind == "Color":
        return mix_color(site, node.blend_type, (factor, first, second), node.clamp_factor,
                         node.clamp_result)
    return b.op("mix", factor, first, second, modes=("YES" if node.clamp_factor else "NO",))


def invert(site):
    color = site.value("Color")
    return faded(site, site.value("Fac", "Factor"), color, site.b.invert(color))


def hue_saturation(site):
    color = site.value("Color")
    turned = site.b.op("hue_saturation", color, site.value("Hue"), site.value("Saturation"),
                       site.value("Value"))
    return site.b.vector_math("MAXIMUM", faded(site, site.value("Fac", "Factor"), color, turned), 0.0)


def bright_contrast(site):
    return site.b.op("bright_contrast", site.value("Color"), site.value("Bright"),
                     site.value("Contrast"))


def gamma(site):
    return site.b.op("gamma", site.value("Color"), site.value("Gamma"))


def rgb_curves(site):
    color = site.value("Color")
    return faded(site, site.value("Fac", "Factor"), color,
                 curves(site, color, site.node.mapping, (0, 1, 2), first=3))


def light_falloff(site):
    site.note("light does not fall off along its path")
    return site.value("Strength")


VALUES = {
    "MIX_RGB": mix_rgb,
    "MIX": mix,
    "INVERT": invert,
    "HUE_SAT": hue_saturation,
    "BRIGHTCONTRAST": bright_contrast,
    "GAMMA": gamma,
    "CURVE_RGB": rgb_curves,
    "LIGHT_FALLOFF": light_falloff,
}
