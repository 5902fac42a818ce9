# SPDX-License-Identifier: GPL-3.0-or-later
"""The one table of passes: it drives registering, adding and writing.

A pass that Blender has a switch for follows that switch and keeps Blender's name and meaning; the
others are chosen in view_layer.kestrel.passes.
"""

from dataclasses import dataclass

import numpy as np

from . import compat

SOCKET_TYPES = {"RGBA": "COLOR", "RGB": "COLOR", "rgba": "COLOR", "XYZ": "VECTOR", "UVA": "VECTOR"}
MATTE_LEVELS = 16  # Blender's limit; two in a pass


@dataclass(frozen=True)
class Pass:
    name: str           # in the library
    channels: str       # in Blender, and in the library, which may have more
    help: str
    toggle: str = ""    # of bpy.types.ViewLayer; "": view_layer.kestrel.passes
    blender: str = ""   # Blender's name before 5.0 where it differs
    matte: str = ""     # the Cryptomatte layer that it is a part of
    depth: int = 0      # its passes before this one

    @property
    def blender_name(self):
        return self.blender or self.name

    def enabled(self, view_layer):
        if self.name == "Combined":
            return True
        if self.matte and self.depth >= matte_passes(view_layer):
            return False
        if self.toggle:
            return getattr(view_layer, self.toggle)
        return self.name in view_layer.kestrel.passes


def matte_passes(view_layer):
    """How many passes the levels of a Cryptomatte layer take."""
    return (min(MATTE_LEVELS, view_layer.pass_cryptomatte_depth) + 1) // 2


def mattes(kind):
    """The passes of a Cryptomatte layer."""
    return tuple(
        Pass(f"Crypto{kind}{depth:02}", "rgba", "Names and shares of what a pixel shows",
             f"use_pass_cryptomatte_{kind.lower()}", matte=f"Crypto{kind}", depth=depth)
        for depth in range(MATTE_LEVELS // 2))


# Files hold the switches by position: new passes of Kestrel's own go to the end.
PASSES = (
    Pass("Combined", "RGBA", "The finished picture"),
    Pass("Depth", "Z", "Distance from the camera along its view", "use_pass_z"),
    Pass("Mist", "Z", "0 near the camera, 1 far away, as the world's mist says", "use_pass_mist"),
    Pass("Position", "XYZ", "Point of the surface in world space", "use_pass_position"),
    Pass("Normal", "XYZ", "Surface normal in world space, after normal maps", "use_pass_normal"),
    Pass("UV", "UVA", "UV map that the surface is rendered with", "use_pass_uv"),
    Pass("ObjectIndex", "X", "Pass index of the object", "use_pass_object_index", "IndexOB"),
    Pass("MaterialIndex", "X", "Pass index of the material", "use_pass_material_index", "IndexMA"),
    Pass("Diffuse", "RGB", "Diffuse colour", "use_pass_diffuse_color", "DiffCol"),
    Pass("Emission", "RGB", "Light that the surface gives off", "use_pass_emit", "Emit"),
    Pass("Ambient", "RGB", "Share of the ambient light that the surface reflects"),
    Pass("Specular", "RGBA", "Colour of highlights; alpha is the exponent, 0 to 1 for 1 to 255"),
    Pass("Optical", "RGB", "Reflectivity, index of refraction and opacity"),
    Pass("Lighting", "RGB", "Light on the surface without shadows, reflections and refractions"),
    Pass("Shadow", "RGB", "One less the light that is blocked", "use_pass_shadow"),
    Pass("Reflection", "RGB", "What the surface mirrors"),
    Pass("Refraction", "RGB", "What shines through the surface"),
    Pass("HeuristicMask", "X", "1 where the object was chosen for ray tracing"),
    Pass("ObjectId", "X", "Number of the object, 0 where there is none"),
    Pass("MaterialId", "X", "Number of the material"),
    Pass("ReversedDepth", "Z", "Depth as it is rasterised: 1 at the near clip, 0 at the far one"),
    Pass("DenoisingNormal", "XYZ", "Surface normal for the compositor's Denoise node, in the "
         "camera's space", blender="Denoising Normal"),
    Pass("DenoisingAlbedo", "RGB", "Surface colour for the compositor's Denoise node",
         blender="Denoising Albedo"),
    *mattes("Object"), *mattes("Material"), *mattes("Asset"),
)
BY_BLENDER_NAME = {name: item for item in PASSES
                   for name in (item.blender_name, compat.NEW_PASS_NAMES.get(item.blender_name))
                   if name}
OPTIONAL = tuple(item for item in PASSES if item.name != "Combined" and not item.toggle)


def enabled(view_layer):
    return [item for item in PASSES if item.enabled(view_layer)]


def register(engine, scene, view_layer):
    """Tell Blender, the compositor above all, which passes a view layer will have."""
    for item in enabled(view_layer):
        engine.register_pass(scene, view_layer, compat.pass_name(scene, item.blender_name),
                             len(item.channels), item.channels,
                             SOCKET_TYPES.get(item.channels, "VALUE"))


def add(engine, view_layer):
    """Add the passes that Blender does not make by itself to the result."""
    for item in enabled(view_layer):
        if item.name != "Combined":
            engine.add_pass(compat.pass_name(view_layer.id_data, item.blender_name),
                            len(item.channels), item.channels, layer=view_layer.name)


def stamp(engine, renderer, view_layer):
    """Tell Blender, and with it the files that it writes, what Cryptomatte's ids mean."""
    result = engine.get_result()
    for layer in dict.fromkeys(item.matte for item in enabled(view_layer) if item.matte):
        name = f"{view_layer.name}.{layer}"
        key = f"cryptomatte/{renderer.library.cryptomatte_hash(name):08x}"[:-1]
        for field, value in (("name", name), ("hash", "MurmurHash3_32"),
                             ("conversion", "uint32_to_float32"),
                             ("manifest", renderer.cryptomatte_manifest(layer))):
            result.stamp_data_add_field(f"{key}/{field}", value)


def reader(renderer, width, height):
    """A function from one of Blender's passes to its pixels, for compat.write_passes()."""
    def pixels_of(blender_pass):
        item = BY_BLENDER_NAME.get(blender_pass.name)
        if item is None:  # a switch of Blender's that Kestrel has nothing for
            return np.zeros((width * height, blender_pass.channels), np.float32)
        return renderer.read_pass(item.name, width, height)[:, :len(item.channels)]
    return pixels_of
