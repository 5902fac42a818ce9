# SPDX-License-Identifier: GPL-3.0-or-later
"""The Object tab."""

import bpy

from .common import TablePanel


class KESTREL_OBJECT_PT_tracing(TablePanel, bpy.types.Panel):
    bl_label = "Ray Tracing"
    bl_context = "object"
    names = ("relevance", "cost", "shadows", "reflections", "refractions")

    @staticmethod
    def owner(context):
        return context.object

    @classmethod
    def shown(cls, context):
        return context.object is not None and context.object.type not in {"LIGHT", "CAMERA"}


CLASSES = (
    KESTREL_OBJECT_PT_tracing,
)
