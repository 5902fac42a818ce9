# SPDX-License-Identifier: GPL-3.0-or-later
"""The Object tab."""

import bpy

from .common import TablePanel


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


CLASSES = (
    KESTREL_OBJECT_PT_tracing,
)
