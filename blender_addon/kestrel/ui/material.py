# SPDX-License-Identifier: GPL-3.0-or-later
"""The Material tab."""

import bpy

from .common import KestrelPanel, draw_node_input


class KESTREL_MATERIAL_PT_slots(KestrelPanel, bpy.types.Panel):
    bl_label = ""
    bl_context = "material"
    bl_options = {"HIDE_HEADER"}
    needs_library = False

    @classmethod
    def shown(cls, context):
        return (context.material or context.object) and not (
            context.object and context.object.type in {"GPENCIL", "GREASEPENCIL"})

    def draw(self, context):
        layout, obj = self.layout, context.object
        if obj is None:
            layout.template_ID(context.space_data, "pin_id")
            return
        row = layout.row()
        row.template_list("MATERIAL_UL_matslots", "", obj, "material_slots", obj,
                          "active_material_index", rows=3 if len(obj.material_slots) < 2 else 5)
        column = row.column(align=True)
        column.operator("object.material_slot_add", icon="ADD", text="")
        column.operator("object.material_slot_remove", icon="REMOVE", text="")
        column.menu("MATERIAL_MT_context_menu", icon="DOWNARROW_HLT", text="")
        layout.template_ID(obj, "active_material", new="material.new")
        if obj.mode == "EDIT":
            row = layout.row(align=True)
            row.operator("object.material_slot_assign", text="Assign")
            row.operator("object.material_slot_select", text="Select")
            row.operator("object.material_slot_deselect", text="Deselect")


class KESTREL_MATERIAL_PT_surface(KestrelPanel, bpy.types.Panel):
    bl_label = "Surface"
    bl_context = "material"
    needs_library = False

    @classmethod
    def shown(cls, context):
        return context.material is not None and not context.material.grease_pencil

    def draw(self, context):
        layout, material = self.layout, context.material
        layout.use_property_split = True
        layout.prop(material, "use_nodes", icon="NODETREE")
        if material.use_nodes and material.node_tree:
            draw_node_input(layout, material.node_tree, None, "Surface")
        else:
            layout.prop(material, "diffuse_color", text="Base Color")
            layout.prop(material, "metallic")
            layout.prop(material, "roughness")


class KESTREL_MATERIAL_PT_settings(KestrelPanel, bpy.types.Panel):
    bl_label = "Settings"
    bl_context = "material"
    needs_library = False
    shown = KESTREL_MATERIAL_PT_surface.shown

    def draw(self, context):
        layout, material = self.layout, context.material
        layout.use_property_split = True
        layout.prop(material.kestrel, "casts_shadow")
        if getattr(material, "blend_method", "") == "CLIP":
            layout.prop(material, "alpha_threshold")


CLASSES = (
    KESTREL_MATERIAL_PT_slots,
    KESTREL_MATERIAL_PT_surface,
    KESTREL_MATERIAL_PT_settings,
)
