# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators that help to find out what is wrong."""

import bpy

from . import log, report

LOG_NAME = "Kestrel Log"


class KESTREL_OT_copy_system_report(bpy.types.Operator):
    bl_idname = "kestrel.copy_system_report"
    bl_label = "Copy Kestrel System Report"
    bl_description = ("Copy to the clipboard what belongs into a report of a fault: versions, "
                      "devices, this scene's settings and the last messages")

    def execute(self, context):
        context.window_manager.clipboard = report.text(context.scene)
        self.report({"INFO"}, "The system report is on the clipboard. Paste it into your message.")
        return {"FINISHED"}


class KESTREL_OT_open_log(bpy.types.Operator):
    bl_idname = "kestrel.open_log"
    bl_label = "Open Kestrel Log"
    bl_description = "Show Kestrel's last messages in a text, in a window of its own"

    def execute(self, context):
        text = bpy.data.texts.get(LOG_NAME) or bpy.data.texts.new(LOG_NAME)
        text.from_string("\n".join(log.recent() or ["Kestrel has had nothing to say so far."]))
        if bpy.ops.wm.window_new.poll():
            self.show(context, text)
        else:  # in background, or while an area fills the whole window
            self.report({"INFO"}, f"The log is the text '{LOG_NAME}'. Open it in a Text Editor.")
        return {"FINISHED"}

    @staticmethod
    def show(context, text):
        bpy.ops.wm.window_new()
        area = context.window_manager.windows[-1].screen.areas[0]
        area.type = "TEXT_EDITOR"
        area.spaces.active.text = text


CLASSES = (
    KESTREL_OT_copy_system_report,
    KESTREL_OT_open_log,
)


def draw_in_help(self, _context):
    self.layout.separator()
    for operator in CLASSES:
        self.layout.operator(operator.bl_idname)


def register():
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.TOPBAR_MT_help.append(draw_in_help)


def unregister():
    bpy.types.TOPBAR_MT_help.remove(draw_in_help)
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
