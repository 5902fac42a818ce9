# SPDX-License-Identifier: GPL-3.0-or-later
"""The Object tab."""

import bpy

from .common import KestrelPanel, TablePanel


class KESTREL_OBJECT_PT_tracing(TablePanel, bpy.types.Panel):
    bl_label = "Ray Tracing"
    bl_context = "object"

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        self.draw_rows(layout.column(), context, ("relevance", "cost"))
        self.draw_rows(layout.column(align=True), context,
                       ("shadows", "reflections", "refractions"))

    @staticmethod
    def owner(context):
        return context.object

    @classmethod
    def shown(cls, context):
        return context.object is not None and context.object.type not in {"LIGHT", "CAMERA"}


class KESTREL_OBJECT_PT_ray_visibility(KestrelPanel, bpy.types.Panel):
    bl_label = "Ray Visibility"
    bl_context = "object"
    bl_parent_id = "OBJECT_PT_visibility"
    shown = KESTREL_OBJECT_PT_tracing.shown

    def draw(self, context):
        layout, obj = self.layout, context.object
        layout.use_property_split = True
        column = layout.column()
        column.prop(obj, "visible_camera", text="Camera")
        column.prop(obj, "visible_shadow", text="Shadow")
        column.prop(obj, "visible_glossy", text="Glossy")
        column.prop(obj, "visible_transmission", text="Transmission")


CLASSES = (
    KESTREL_OBJECT_PT_tracing,
    KESTREL_OBJECT_PT_ray_visibility,
)
