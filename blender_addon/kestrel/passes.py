# SPDX-License-Identifier: GPL-3.0-or-later
"""The one table of passes: it drives registering, adding and writing.

A pass that Blender has a switch for follows that switch and keeps Blender's name and meaning; the
others are chosen in view_layer.kestrel.passes.
"""

from dataclasses import dataclass

import numpy as np

SOCKET_TYPES = {"RGBA": "COLOR", "RGB": "COLOR", "XYZ": "VECTOR", "XYZW": "VECTOR"}


@dataclass(frozen=True)
class Pass:
    name: str           # in Kestrel
    channels: str       # in Kestrel and in Blender
    help: str
    toggle: str = ""    # of bpy.types.ViewLayer; "": view_layer.kestrel.passes
    blender: str = ""   # Blender's name where it differs

    @property
    def blender_name(self):
        return self.blender or self.name

    def enabled(self, view_layer):
        if self.name == "Combined":
            return True
        if self.toggle:
            return getattr(view_layer, self.toggle)
        return self.name in view_layer.kestrel.passes


# Files hold the switches by position: new passes of Kestrel's own go to the end.
PASSES = (
    Pass("Combined", "RGBA", "The finished picture"),
    Pass("Depth", "Z", "Distance from the camera along its view", "use_pass_z"),
    Pass("Position", "XYZ", "Point of the surface in world space", "use_pass_position"),
    Pass("Normal", "XYZ", "Surface normal in world space, after normal maps", "use_pass_normal"),
    Pass("Vector", "XYZW", "Pixels moved since the frame before, and until the next one; nothing "
         "with motion blur", "use_pass_vector"),
    Pass("Emission", "RGB", "Light that the surface gives off", "use_pass_emit", "Emit"),
    Pass("Ambient", "RGB", "Share of the ambient light that the surface reflects"),
    Pass("Diffuse", "RGBA", "Diffuse colour; alpha is the surface's coverage"),
    Pass("Specular", "RGBA", "Colour of highlights; alpha is the exponent, 0 to 1 for 1 to 255"),
    Pass("Optical", "RGB", "Reflectivity, index of refraction and opacity"),
    Pass("Lighting", "RGB", "Light on the surface without shadows, reflections and refractions"),
    Pass("Shadow", "RGB", "One less the light that is blocked"),
    Pass("Reflection", "RGB", "What the surface mirrors"),
    Pass("Refraction", "RGB", "What shines through the surface"),
    Pass("HeuristicMask", "X", "1 where the object was chosen for ray tracing"),
    Pass("ObjectId", "X", "Number of the object, 0 where there is none"),
    Pass("MaterialId", "X", "Number of the material"),
    Pass("ReversedDepth", "Z", "Depth as it is rasterised: 1 at the near clip, 0 at the far one"),
)
BY_BLENDER_NAME = {item.blender_name: item for item in PASSES}
OPTIONAL = tuple(item for item in PASSES if item.name != "Combined" and not item.toggle)


def enabled(view_layer):
    return [item for item in PASSES if item.enabled(view_layer)]


def register(engine, scene, view_layer):
    """Tell Blender, the compositor above all, which passes a view layer will have."""
    for item in enabled(view_layer):
        engine.register_pass(scene, view_layer, item.blender_name, len(item.channels),
                             item.channels, SOCKET_TYPES.get(item.channels, "VALUE"))


def add(engine, view_layer):
    """Add the passes that Blender does not make by itself to the result."""
    for item in enabled(view_layer):
        if item.name != "Combined":
            engine.add_pass(item.blender_name, len(item.channels), item.channels,
                            layer=view_layer.name)


def reader(renderer, width, height):
    """A function from one of Blender's passes to its pixels, for compat.write_passes()."""
    def pixels_of(blender_pass):
        item = BY_BLENDER_NAME.get(blender_pass.name)
        if item is None:  # a switch of Blender's that Kestrel has nothing for
            return np.zeros((width * height, blender_pass.channels), np.float32)
        return renderer.read_pass(item.name, width, height)
    return pixels_of
