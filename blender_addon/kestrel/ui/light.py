# SPDX-License-Identifier: GPL-3.0-or-later
"""The Data tab of lights."""

import bpy

from .common import KestrelPanel


class KESTREL_LIGHT_PT_light(KestrelPanel, bpy.types.Panel):
    bl_label = "Light"
    bl_context = "data"
    needs_library = False

    @classmethod
    def shown(cls, context):
        return context.light is not None

    def draw(self, context):
        layout, light = self.layout, context.light
        layout.row().prop(light, "type", expand=True)
        layout.use_property_split = True
        layout.prop(light, "color")
        layout.prop(light, "energy", text="Strength" if light.type == "SUN" else "Power")
        layout.prop(light, "specular_factor", text="Specular")
        if light.type == "SPOT":
            layout.prop(light, "spot_size")
            layout.prop(light, "spot_blend", slider=True)
        if hasattr(light, "use_shadow"):
            layout.prop(light, "use_shadow")


CLASSES = (
    KESTREL_LIGHT_PT_light,
)
