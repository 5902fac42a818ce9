# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes of Blender's Converter menu."""

from .curves import color_ramp, curves

CHANNELS = {"Red": "X", "Green": "Y", "Blue": "Z", "R": "X", "G": "Y", "B": "Z", "H": "X",
            "S": "Y", "V": "Z", "X": "X", "Y": "Y", "Z": "Z"}


def math(site):
    node, b = site.node, site.b
    if not b.has_mode("math", 0, node.operation):
        site.note("its first value is used")
        return site.value(0)
    operands = [site.value(i) for i in range(len(node.inputs))]
    return b.math(node.operation, *operands, clamp=node.use_clamp)


def vector_math(site):
    node, b = site.node, site.b
    if not b.has_mode("vector_math", 0, node.operation):
        site.note("its first vector is used")
        return site.value(0)
    return b.vector_math(node.operation, *(site.value(i) for i in range(3)), site.value("Scale"))


def clamp(site):
    b = site.b
    value, low, high = (site.value(name) for name in ("Value", "Min", "Max"))
    if site.node.clamp_type == "RANGE":
        low, high = b.vector_math("MINIMUM", low, high), b.vector_math("MAXIMUM", low, high)
    return b.clamp(value, low, high)


def map_range(site):
    """By component, for numbers and vectors alike."""
    node, b = site.node, site.b
    vector = node.data_type == "FLOAT_VECTOR"

    def get(name):
        return site.value(f"{name.replace(' ', '_')}_FLOAT3" if vector else name)

    value = site.value("Vector" if vector else "Value")
    low, high, to_low, to_high = map(get, ("From Min", "From Max", "To Min", "To Max"))
    if low is high:
        return b.constant(0.0)
    share = b.divide(b.subtract(value, low), b.subtract(high, low))
    if node.interpolation_type == "STEPPED":
        steps = get("Steps")
        share = b.divide(b.vector_math("FLOOR", b.multiply(share, b.add(steps, 1.0))), steps)
    elif node.interpolation_type == "SMOOTHSTEP":
        share = smooth(b, b.clamp(share))
    elif node.interpolation_type == "SMOOTHERSTEP":
        share = smoother(b, b.clamp(share))
    result = b.add(to_low, b.multiply(share, b.subtract(to_high, to_low)))
    if node.clamp and node.interpolation_type in ("LINEAR", "STEPPED"):
        result = b.clamp(result, b.vector_math("MINIMUM", to_low, to_high),
                         b.vector_math("MAXIMUM", to_low, to_high))
    return result


def smooth(b, t):
    """3 t² - 2 t³."""
    return b.multiply(t, t, b.subtract(3.0, b.multiply(2.0, t)))


def smoother(b, t):
    """6 t⁵ - 15 t⁴ + 10 t³."""
    inner = b.add(b.multiply(t, b.subtract(b.multiply(t, 6.0), 15.0)), 10.0)
    return b.multiply(t, t, t, inner)


def ramp(site):
    value = color_ramp(site, site.value("Fac", "Factor"), site.node.color_ramp)
    return site.b.component(value, "ALPHA") if site.output.name == "Alpha" else value


def float_curve(site):
    value = site.value("Value")
    return site.b.mix(site.value("Factor", "Fac"), value,
                      curves(site, value, site.node.mapping, (0, 0, 0)))


def separate(site, space="RGB"):
    value = site.value(0)
    if space != "RGB":
        value = site.b.op("color_space", value, modes=(f"RGB_TO_{space}",))
    return site.b.component(value, "XYZ"[list(site.node.outputs).index(site.output)])


def combine(site, space="RGB"):
    value = site.b.combine(*(site.value(i) for i in range(3)))
    if space == "RGB":
        return value
    return site.b.op("color_space", value, modes=(f"{space}_TO_RGB",))


def rgb_to_bw(site):
    return site.b.luminance(site.value("Color"))


def blackbody(site):
    return site.b.op("blackbody", site.value("Temperature"))


def wavelength(site):
    return site.b.op("wavelength", site.value("Wavelength"))


def shader_to_rgb(site):
    site.note("it gives black")
    return site.b.constant(0.0)


VALUES = {
    "MATH": math,
    "VECT_MATH": vector_math,
    "CLAMP": clamp,
    "MAP_RANGE": map_range,
    "VALTORGB": ramp,
    "CURVE_FLOAT": float_curve,
    "SEPARATE_COLOR": lambda site: separate(site, site.node.mode),
    "SEPRGB": separate,
    "SEPXYZ": separate,
    "SEPHSV": lambda site: separate(site, "HSV"),
    "COMBINE_COLOR": lambda site: combine(site, site.node.mode),
    "COMBRGB": combine,
    "COMBXYZ": combine,
    "COMBHSV": lambda site: combine(site, "HSV"),
    "RGBTOBW": rgb_to_bw,
    "BLACKBODY": blackbody,
    "WAVELENGTH": wavelength,
    "SHADERTORGB": shader_to_rgb,
}
