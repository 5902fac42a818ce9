# SPDX-License-Identifier: GPL-3.0-or-later
"""The View Layer tab."""

import bpy

from .. import passes
from .common import KestrelPanel

DENOISING = ("DenoisingNormal", "DenoisingAlbedo")


class ViewLayerPanel(KestrelPanel):
    bl_context = "view_layer"
    needs_library = False


class KESTREL_VIEW_LAYER_PT_passes(ViewLayerPanel, bpy.types.Panel):
    bl_label = "Passes"

    def draw(self, context):
        pass


class PassesPanel(ViewLayerPanel):
    """A panel of switches within Passes, laid out as Cycles' are."""
    bl_parent_id = "KESTREL_VIEW_LAYER_PT_passes"

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        self.draw_switches(layout, context.view_layer)


class KESTREL_VIEW_LAYER_PT_passes_data(PassesPanel, bpy.types.Panel):
    bl_label = "Data"

    def draw_switches(self, layout, view_layer):
        column = layout.column(heading="Include", align=True)
        column.prop(view_layer, "use_pass_z")
        column.prop(view_layer, "use_pass_mist")
        column.prop(view_layer, "use_pass_position")
        column.prop(view_layer, "use_pass_normal")
        vector = column.column()
        vector.active = not view_layer.id_data.render.use_motion_blur
        vector.prop(view_layer, "use_pass_vector")
        column.prop(view_layer, "use_pass_uv")
        column = layout.column(heading="Indexes", align=True)
        column.prop(view_layer, "use_pass_object_index")
        column.prop(view_layer, "use_pass_material_index")
        # Buttons of an enumeration would each repeat their name as a label of their own.
        split = layout.split(factor=0.4)
        label = split.row()
        label.alignment = "RIGHT"
        label.label(text="Denoising Data")
        buttons = split.row(align=True)
        buttons.use_property_split = False
        for name, text in zip(DENOISING, ("Normal", "Albedo")):
            buttons.prop_enum(view_layer.kestrel, "passes", name, text=text)


class KESTREL_VIEW_LAYER_PT_passes_light(PassesPanel, bpy.types.Panel):
    bl_label = "Light"

    def draw_switches(self, layout, view_layer):
        layout.column(heading="Diffuse").prop(view_layer, "use_pass_diffuse_color", text="Color")
        column = layout.column(heading="Other", align=True)
        column.prop(view_layer, "use_pass_emit", text="Emission")
        column.prop(view_layer, "use_pass_shadow")


class KESTREL_VIEW_LAYER_PT_passes_cryptomatte(PassesPanel, bpy.types.Panel):
    bl_label = "Cryptomatte"

    def draw_switches(self, layout, view_layer):
        kinds = ("object", "material", "asset")
        column = layout.column(heading="Include", align=True)
        for kind in kinds:
            column.prop(view_layer, f"use_pass_cryptomatte_{kind}", text=kind.title())
        column = layout.column()
        column.active = any(getattr(view_layer, f"use_pass_cryptomatte_{kind}") for kind in kinds)
        column.prop(view_layer, "pass_cryptomatte_depth", text="Levels")


class KESTREL_VIEW_LAYER_PT_passes_kestrel(PassesPanel, bpy.types.Panel):
    bl_label = "Kestrel"

    def draw_switches(self, layout, view_layer):
        layout.use_property_split = False
        column = layout.column(align=True)
        for item in passes.OPTIONAL:
            if item.name not in DENOISING:
                column.prop_enum(view_layer.kestrel, "passes", item.name)


class KESTREL_VIEW_LAYER_PT_override(ViewLayerPanel, bpy.types.Panel):
    bl_label = "Override"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.prop(context.view_layer, "material_override")
        layout.prop(context.view_layer, "samples")


CLASSES = (
    KESTREL_VIEW_LAYER_PT_passes,
    KESTREL_VIEW_LAYER_PT_passes_data,
    KESTREL_VIEW_LAYER_PT_passes_light,
    KESTREL_VIEW_LAYER_PT_passes_cryptomatte,
    KESTREL_VIEW_LAYER_PT_passes_kestrel,
    KESTREL_VIEW_LAYER_PT_override,
)
