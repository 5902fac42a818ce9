# SPDX-License-Identifier: GPL-3.0-or-later
"""The Render tab's list of nodes that are not drawn as Blender does."""

import bpy

from .common import KestrelPanel, draw_text


class KESTREL_RENDER_PT_node_coverage(KestrelPanel, bpy.types.Panel):
    bl_label = "Node Coverage"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout = self.layout
        coverage = context.window_manager.kestrel_coverage
        layout.operator("kestrel.check_materials", icon="VIEWZOOM")
        if not coverage.checked:
            return
        if not coverage.items:
            layout.label(text="All nodes are supported", icon="CHECKMARK")
            return
        layout.template_list("UI_UL_list", "kestrel_coverage", coverage, "items", coverage,
                             "active", rows=4)
        item = coverage.selected()
        if item is not None:
            draw_text(layout, item.text)
        row = layout.row(align=True)
        row.operator("kestrel.select_material", icon="RESTRICT_SELECT_OFF")
        row.operator("kestrel.copy_node_coverage", icon="COPYDOWN")


CLASSES = (KESTREL_RENDER_PT_node_coverage,)
