# SPDX-License-Identifier: GPL-3.0-or-later
"""The View Layer tab."""

import bpy

from .common import KestrelPanel


class KESTREL_VIEW_LAYER_PT_passes(KestrelPanel, bpy.types.Panel):
    bl_label = "Passes"
    bl_context = "view_layer"
    needs_library = False

    def draw(self, context):
        layout = self.layout
        layer = context.view_layer
        layout.use_property_split = True
        layout.use_property_decorate = False
        column = layout.column(heading="Data", align=True)
        column.prop(layer, "use_pass_z", text="Depth")
        column.prop(layer, "use_pass_position")
        column.prop(layer, "use_pass_normal")
        column.prop(layer, "use_pass_emit", text="Emission")
        layout.use_property_split = False
        layout.label(text="Kestrel")
        layout.column(align=True).prop(layer.kestrel, "passes")


class KESTREL_VIEW_LAYER_PT_override(KestrelPanel, bpy.types.Panel):
    bl_label = "Override"
    bl_context = "view_layer"
    bl_options = {"DEFAULT_CLOSED"}
    needs_library = False

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.prop(context.view_layer, "material_override")
        layout.prop(context.view_layer, "samples")


CLASSES = (
    KESTREL_VIEW_LAYER_PT_passes,
    KESTREL_VIEW_LAYER_PT_override,
)
