# SPDX-License-Identifier: GPL-3.0-or-later
"""The Material tab."""

import bpy

from .. import compat
from .common import KestrelPanel, draw_node_input, draw_use_nodes


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
        row = layout.row()
        row.template_ID(obj, "active_material", new="material.new")
        slot = context.material_slot
        if slot is not None:
            row.prop(slot, "link", icon_only=True,
                     icon="MESH_DATA" if slot.link == "DATA" else "OBJECT_DATA")
        if obj.mode == "EDIT":
            row = layout.row(align=True)
            row.operator("object.material_slot_assign", text="Assign")
            row.operator("object.material_slot_select", text="Select")
            row.operator("object.material_slot_deselect", text="Deselect")


class MaterialPanel(KestrelPanel):
    bl_context = "material"
    needs_library = False

    @classmethod
    def shown(cls, context):
        return context.material is not None and not context.material.grease_pencil


class KESTREL_MATERIAL_PT_preview(MaterialPanel, bpy.types.Panel):
    bl_label = "Preview"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        self.layout.template_preview(context.material)


class KESTREL_MATERIAL_PT_surface(MaterialPanel, bpy.types.Panel):
    bl_label = "Surface"

    def draw(self, context):
        layout, material = self.layout, context.material
        layout.use_property_split = True
        draw_use_nodes(layout, material)
        if compat.uses_nodes(material):
            draw_node_input(layout, material.node_tree, None, "Surface")
        else:
            layout.prop(material, "diffuse_color", text="Base Color")
            layout.prop(material, "metallic")
            layout.prop(material, "roughness")


class KESTREL_MATERIAL_PT_settings(MaterialPanel, bpy.types.Panel):
    bl_label = "Settings"

    def draw(self, context):
        layout, material = self.layout, context.material
        layout.use_property_split = True
        layout.prop(material.kestrel, "casts_shadow")
        if getattr(material, "blend_method", "") == "CLIP":
            layout.prop(material, "alpha_threshold")


CLASSES = (
    KESTREL_MATERIAL_PT_slots,
    KESTREL_MATERIAL_PT_preview,
    KESTREL_MATERIAL_PT_surface,
    KESTREL_MATERIAL_PT_settings,
)
