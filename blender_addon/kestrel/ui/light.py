# SPDX-License-Identifier: GPL-3.0-or-later
"""The Data tab of lights."""

import bpy

from .. import compat
from .common import KestrelPanel, draw_node_input, draw_use_nodes


class LightPanel(KestrelPanel):
    bl_context = "data"
    needs_library = False

    @classmethod
    def shown(cls, context):
        return context.light is not None


class KESTREL_LIGHT_PT_preview(LightPanel, bpy.types.Panel):
    bl_label = "Preview"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        self.layout.template_preview(context.light)


class KESTREL_LIGHT_PT_light(LightPanel, bpy.types.Panel):
    bl_label = "Light"

    def draw(self, context):
        layout, light = self.layout, context.light
        layout.row().prop(light, "type", expand=True)
        layout.use_property_split = True
        column = layout.column()
        if hasattr(light, "use_temperature"):
            row = column.column(align=True, heading="Temperature").row(align=True)
            row.prop(light, "use_temperature", text="")
            sub = row.row()
            sub.active = light.use_temperature
            sub.prop(light, "temperature", text="")
        column.prop(light, "color")
        column = layout.column()
        column.prop(light, "energy", text="Strength" if light.type == "SUN" else "Power")
        if hasattr(light, "exposure"):
            column.prop(light, "exposure")
        column.prop(light, "specular_factor", text="Specular")
        if hasattr(light, "use_shadow"):
            layout.column(heading="Shadow").prop(light, "use_shadow", text="Cast Shadow")


class KESTREL_LIGHT_PT_beam_shape(LightPanel, bpy.types.Panel):
    bl_label = "Beam Shape"
    bl_parent_id = "KESTREL_LIGHT_PT_light"

    @classmethod
    def shown(cls, context):
        return context.light is not None and context.light.type == "SPOT"

    def draw(self, context):
        layout, light = self.layout, context.light
        layout.use_property_split = True
        column = layout.column()
        column.prop(light, "spot_size", text="Angle")
        column.prop(light, "spot_blend", text="Blend", slider=True)
        column.prop(light, "show_cone")


class KESTREL_LIGHT_PT_nodes(LightPanel, bpy.types.Panel):
    bl_label = "Nodes"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout, light = self.layout, context.light
        layout.use_property_split = True
        draw_use_nodes(layout, light)
        if compat.uses_nodes(light):
            draw_node_input(layout, light.node_tree, "OUTPUT_LIGHT", "Surface")


CLASSES = (
    KESTREL_LIGHT_PT_preview,
    KESTREL_LIGHT_PT_light,
    KESTREL_LIGHT_PT_beam_shape,
    KESTREL_LIGHT_PT_nodes,
)
