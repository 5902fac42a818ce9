# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes with their settings, and the function of tests/node_maths that should give the same.

Only what the running Blender has: cases differ between its versions.
"""

from dataclasses import dataclass, field

import bpy

BLENDER = min(bpy.app.version[0], 5)
COORDINATES = ((1, 1, 1), (0, 0, 0))
COLORS = ((0.3, 0.35, 0.3), (0.5, 0.45, 0.6))  # about -0.1 to 1.4

DIMENSIONS = (1, 2, 3, 4)
NOISES = ("FBM", "MULTIFRACTAL", "HYBRID_MULTIFRACTAL", "RIDGED_MULTIFRACTAL", "HETERO_TERRAIN")
METRICS = ("EUCLIDEAN", "MANHATTAN", "CHEBYCHEV", "MINKOWSKI")
FEATURES = ("F1", "F2", "SMOOTH_F1", "DISTANCE_TO_EDGE", "N_SPHERE_RADIUS")
GRADIENTS = ("LINEAR", "QUADRATIC", "EASING", "DIAGONAL", "SPHERICAL", "QUADRATIC_SPHERE", "RADIAL")
BLENDS = ("MIX", "DARKEN", "MULTIPLY", "BURN", "LIGHTEN", "SCREEN", "DODGE", "ADD", "OVERLAY",
          "SOFT_LIGHT", "LINEAR_LIGHT", "DIFFERENCE", "EXCLUSION", "SUBTRACT", "DIVIDE", "HUE",
          "SATURATION", "COLOR", "VALUE")


@dataclass
class Case:
    """One node. `place` maps the tile's coordinates, -2 to 2, to what goes into `linked`."""

    kind: str  # ShaderNode…
    function: tuple  # name and parameters, for node_values
    properties: dict = field(default_factory=dict)
    inputs: dict = field(default_factory=dict)
    output: str = ""  # identifier or name; else the first
    channels: str = "xyz"  # of the function's result; one is compared with all of the node's
    linked: str = "Vector"
    place: tuple = COORDINATES
    constant: bool = False  # the same value everywhere

    @property
    def name(self):
        return f"{self.kind[10:]} {' '.join(map(str, self.function))} {self.channels}"


def rows(names, *values):
    return [dict(zip(names.split(), row)) for row in values]


def noises():
    for settings in rows("Scale Detail Roughness Distortion",
                         (5, 2, 0.5, 0), (3.7, 4.3, 0.7, 1.5), (1.3, 9, 0.9, 0),
                         (20000, 0, 0.5, 0), (-2.5, 0.4, 0, 0.3)):
        for dimensions in DIMENSIONS:
            yield noise(dimensions, "FBM", True, settings)
    # Not the colour: a hundred from the origin Blender's own processors round octaves differently.
    for dimensions in DIMENSIONS:
        yield noise(dimensions, "FBM", True, {"Scale": 1.3, "Detail": 15, "Roughness": 0.9}, "Fac")
    if BLENDER < 4:
        return
    for kind in NOISES:
        for dimensions in DIMENSIONS:
            yield noise(dimensions, kind, kind != "FBM", {
                "Scale": 2.3, "Detail": 3.6, "Roughness": 0.6, "Lacunarity": 2.4, "Offset": 0.4,
                "Gain": 1.3, "Distortion": 0.2 * dimensions})
    yield noise(3, "FBM", True, {"Scale": 3, "Detail": 5.5, "Roughness": 1.4, "Lacunarity": 1.7})
    yield noise(3, "HYBRID_MULTIFRACTAL", False, {"Scale": 3, "Detail": 0, "Offset": -0.5})
    yield noise(2, "FBM", True, {"Scale": 700000, "Detail": 0})


def noise(dimensions, kind, normalize, settings, output="Color"):
    inputs = {"Detail": 2, "Roughness": 0.5, "Lacunarity": 2, "Offset": 0, "Gain": 1,
              "Distortion": 0, **settings}
    properties = {"noise_dimensions": f"{dimensions}D"}
    if BLENDER >= 4:
        properties.update(noise_type=kind, normalize=normalize)
    function = ("noise", dimensions, NOISES.index(kind), int(normalize), inputs["Scale"],
                *(inputs[name] for name in ("Detail", "Roughness", "Lacunarity", "Offset", "Gain",
                                            "Distortion")), BLENDER)
    return Case("ShaderNodeTexNoise", function, properties, inputs, output,
                "x" if output == "Fac" else "xyz")


def musgraves():
    if not hasattr(bpy.types, "ShaderNodeTexMusgrave"):
        return
    names = "Scale Detail Dimension Lacunarity Offset Gain"
    for settings in rows(names, (2.3, 3.6, 0.8, 2.2, 0.4, 1.3), (4, 0.5, 2, 2, 0, 1),
                         (1, 5, 0, 1.7, 0.7, 2)):
        for kind in NOISES:
            for dimensions in DIMENSIONS:
                yield Case("ShaderNodeTexMusgrave",
                           ("musgrave", dimensions, NOISES.index(kind), *settings.values()),
                           {"musgrave_dimensions": f"{dimensions}D", "musgrave_type": kind},
                           settings, channels="x")


def voronois():
    outputs = (("Distance", 0, "w"), ("Color", 0, "xyz"), ("Position", 5, "xyz"))
    for feature in FEATURES[:3]:
        for dimensions in DIMENSIONS:
            for output, more, channels in outputs:
                if output == "Position" and dimensions == 1:
                    output, channels = "W", "w"
                yield voronoi(dimensions, feature, "EUCLIDEAN", output, more, channels)
    for metric in METRICS[1:]:
        for feature in FEATURES[:3]:
            for dimensions in DIMENSIONS[1:]:
                yield voronoi(dimensions, feature, metric, *outputs[0])
    for dimensions in DIMENSIONS:
        yield voronoi(dimensions, "DISTANCE_TO_EDGE", "EUCLIDEAN", *outputs[0])
        yield voronoi(dimensions, "N_SPHERE_RADIUS", "EUCLIDEAN", "Radius", 0, "w")
    yield voronoi(3, "SMOOTH_F1", "EUCLIDEAN", *outputs[0], Smoothness=0)
    yield voronoi(3, "F1", "EUCLIDEAN", *outputs[0], Randomness=0)
    yield voronoi(4, "F1", "EUCLIDEAN", "W", 5, "w")
    if BLENDER < 4:
        return
    octaves = {"Scale": 2, "Detail": 2.4, "Roughness": 0.6, "Lacunarity": 2.2}
    for feature in FEATURES[:4]:
        for dimensions in DIMENSIONS:
            for normalize in (False, True):
                yield voronoi(dimensions, feature, "MANHATTAN", *outputs[0], normalize, **octaves)
        if feature != "DISTANCE_TO_EDGE":
            yield voronoi(2, feature, "EUCLIDEAN", *outputs[1], True, **octaves)
            yield voronoi(3, feature, "EUCLIDEAN", *outputs[2], True, **octaves)


def voronoi(dimensions, feature, metric, output, more, channels, normalize=False, **settings):
    inputs = {"Scale": 3.1, "Detail": 0, "Roughness": 0.5, "Lacunarity": 2, "Smoothness": 0.7,
              "Exponent": 0.8, "Randomness": 0.9, **settings}
    properties = {"voronoi_dimensions": f"{dimensions}D", "feature": feature, "distance": metric}
    if BLENDER >= 4:
        properties["normalize"] = normalize
    function = ("voronoi", dimensions, FEATURES.index(feature) + more, METRICS.index(metric),
                int(normalize), *(inputs[name] for name in (
                    "Scale", "Detail", "Roughness", "Lacunarity", "Smoothness", "Exponent",
                    "Randomness")), BLENDER)
    return Case("ShaderNodeTexVoronoi", function, properties, inputs, output, channels)


def waves():
    directions = ("X", "Y", "Z", "DIAGONAL"), ("X", "Y", "Z", "SPHERICAL")
    for kind, wave_type in enumerate(("BANDS", "RINGS")):
        for direction, name in enumerate(directions[kind]):
            for profile, profile_name in enumerate(("SIN", "SAW", "TRI")):
                distortion = 3 if direction == profile else 0
                values = (0.4, distortion, 2.5, 1.3, 0.6, 0.7)
                properties = {"wave_type": wave_type, "wave_profile": profile_name,
                              f"{wave_type.lower()}_direction": name}
                inputs = dict(zip(("Scale", "Distortion", "Detail", "Detail Scale",
                                   "Detail Roughness", "Phase Offset"), values))
                yield Case("ShaderNodeTexWave",
                           ("wave", kind, direction, profile, *values, BLENDER), properties,
                           inputs, channels="x")


def plain_textures():
    for dimensions in DIMENSIONS:
        for output, channels in (("Color", "xyz"), ("Value", "x")):
            yield Case("ShaderNodeTexWhiteNoise", ("white_noise", dimensions),
                       {"noise_dimensions": f"{dimensions}D"}, {}, output, channels)
    for depth in range(11):
        for scale, distortion in ((1.3, 1), (0.7, 2.5)):
            yield Case("ShaderNodeTexMagic", ("magic", depth, scale, distortion, BLENDER),
                       {"turbulence_depth": depth}, {"Scale": scale, "Distortion": distortion})
    yield Case("ShaderNodeTexMagic", ("magic", 0, 3, 0, BLENDER), {"turbulence_depth": 0},
               {"Scale": 3, "Distortion": 0})
    for index, kind in enumerate(GRADIENTS):
        yield Case("ShaderNodeTexGradient", ("gradient", index), {"gradient_type": kind},
                   channels="x", place=((0.6, 0.6, 0.6), (0.1, 0.1, 0)))
    for scale in (1, 3.3):
        yield Case("ShaderNodeTexChecker", ("checker", scale), {}, {"Scale": scale}, "Fac", "x")
    yield Case("ShaderNodeTexChecker", ("checker", 2), {}, {"Scale": 2}, "Fac", "x",
               place=((1, 1, 0), (0, 0, 0)))


def bricks():
    names = ("Scale", "Mortar Size", "Mortar Smooth", "Bias", "Brick Width", "Row Height")
    for values, offset, squash in (((4.7, 0.04, 0.1, 0, 0.5, 0.25), (0.5, 2), (1, 2)),
                                   ((3, 0.06, 0.7, -0.3, 0.6, 0.3), (0.3, 3), (1.6, 2)),
                                   ((4, 0.03, 0, 0.4, 0.4, 0.2), (0.8, 1), (0.5, 4))):
        for output, channels in (("Color", "x"), ("Fac", "y")):
            inputs = dict(zip(names, values))
            inputs.update({"Color1": (0, 0, 0, 1), "Color2": (1, 1, 1, 1)})
            if output == "Color":
                inputs["Mortar Size"] = 0
            yield Case("ShaderNodeTexBrick",
                       ("brick", *(inputs[name] for name in names), *offset, *squash),
                       {"offset": offset[0], "offset_frequency": offset[1],
                        "squash": squash[0], "squash_frequency": squash[1]},
                       inputs, output, channels)


def colors():
    options = {"linked": "Color", "place": COLORS}
    b = (0.7, 0.2, 0.4)
    kinds = {item.identifier for item in
             bpy.types.ShaderNodeMix.bl_rna.properties["blend_type"].enum_items}
    for index, kind in enumerate(BLENDS):
        for factor in (1, 0.6):
            if kind in kinds:
                yield Case("ShaderNodeMix", ("blend", index, factor, *b),
                           {"data_type": "RGBA", "blend_type": kind, "clamp_factor": False},
                           {"Factor_Float": factor, "B_Color": (*b, 1)}, "Result_Color",
                           linked="A_Color", place=COLORS)
    for index, mode in enumerate(("HSV", "HSL")):
        yield Case("ShaderNodeSeparateColor", ("color_space", 2 * index), {"mode": mode},
                   **options)
        yield Case("ShaderNodeCombineColor", ("color_space", 2 * index + 1), {"mode": mode},
                   linked="Red Green Blue", place=((0.25, 0.25, 0.2), (0.5, 0.5, 0.6)))
    for values in ((0.3, 1.4, 0.8), (0.9, 0.5, 1.5)):
        yield Case("ShaderNodeHueSaturation", ("hue_saturation", *values), {},
                   dict(zip(("Hue", "Saturation", "Value"), values)), **options)
    yield Case("ShaderNodeBrightContrast", ("bright_contrast", 0.1, 0.7), {},
               {"Bright": 0.1, "Contrast": 0.7}, **options)
    for gamma in (0, 0.45, 2.2):
        yield Case("ShaderNodeGamma", ("gamma", gamma), {}, {"Gamma": gamma},
                   constant=gamma == 0, **options)
    yield Case("ShaderNodeInvert", ("invert", 0.8), {}, {"Fac": 0.8}, **options)
    yield Case("ShaderNodeRGBToBW", ("luminance",), channels="x", **options)
    yield Case("ShaderNodeBlackbody", ("blackbody", 0, 1), linked="Temperature",
               place=((3500, 0, 0), (6500, 0, 0)))
    yield Case("ShaderNodeWavelength", ("wavelength", 0, 1), linked="Wavelength",
               place=((110, 0, 0), (580, 0, 0)))


def cases():
    makers = noises, musgraves, voronois, waves, plain_textures, bricks, colors
    return [case for maker in makers for case in maker()]
