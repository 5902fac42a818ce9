# SPDX-License-Identifier: GPL-3.0-or-later
"""The World tab."""

import bpy

from .. import compat
from .common import KestrelPanel, draw_node_input, draw_use_nodes


class KESTREL_WORLD_PT_context(KestrelPanel, bpy.types.Panel):
    bl_label = ""
    bl_context = "world"
    bl_options = {"HIDE_HEADER"}
    needs_library = False

    def draw(self, context):
        self.layout.template_ID(context.scene, "world", new="world.new")


class WorldPanel(KestrelPanel):
    bl_context = "world"
    needs_library = False

    @classmethod
    def shown(cls, context):
        return context.world is not None


class KESTREL_WORLD_PT_preview(WorldPanel, bpy.types.Panel):
    bl_label = "Preview"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        self.layout.template_preview(context.world)


class KESTREL_WORLD_PT_surface(WorldPanel, bpy.types.Panel):
    bl_label = "Surface"

    def draw(self, context):
        layout, world = self.layout, context.world
        layout.use_property_split = True
        draw_use_nodes(layout, world)
        if compat.uses_nodes(world):
            draw_node_input(layout, world.node_tree, "OUTPUT_WORLD", "Surface")
        else:
            layout.prop(world, "color")


class KESTREL_WORLD_PT_mist(WorldPanel, bpy.types.Panel):
    bl_label = "Mist Pass"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def shown(cls, context):
        return context.world is not None and any(
            layer.use_pass_mist for layer in context.scene.view_layers)

    def draw(self, context):
        layout, mist = self.layout, context.world.mist_settings
        layout.use_property_split = True
        layout.prop(mist, "start")
        layout.prop(mist, "depth")
        layout.prop(mist, "falloff")


CLASSES = (
    KESTREL_WORLD_PT_context,
    KESTREL_WORLD_PT_preview,
    KESTREL_WORLD_PT_surface,
    KESTREL_WORLD_PT_mist,
)
