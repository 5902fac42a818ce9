# SPDX-License-Identifier: GPL-3.0-or-later
"""The World tab."""

import bpy

from .common import KestrelPanel, draw_node_input


class KESTREL_WORLD_PT_context(KestrelPanel, bpy.types.Panel):
    bl_label = ""
    bl_context = "world"
    bl_options = {"HIDE_HEADER"}
    needs_library = False

    def draw(self, context):
        self.layout.template_ID(context.scene, "world", new="world.new")


class KESTREL_WORLD_PT_surface(KestrelPanel, bpy.types.Panel):
    bl_label = "Surface"
    bl_context = "world"
    needs_library = False

    @classmethod
    def shown(cls, context):
        return context.world is not None

    def draw(self, context):
        layout, world = self.layout, context.world
        layout.use_property_split = True
        layout.prop(world, "use_nodes", icon="NODETREE")
        if world.use_nodes and world.node_tree:
            draw_node_input(layout, world.node_tree, "OUTPUT_WORLD", "Surface")
        else:
            layout.prop(world, "color")


CLASSES = (
    KESTREL_WORLD_PT_context,
    KESTREL_WORLD_PT_surface,
)
