# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on's page in the preferences: whether the library is there, which one, and on what."""

import bpy

from . import operators, report
from .native import loader
from .ui import common


class KestrelPreferences(bpy.types.AddonPreferences):
    bl_idname = __package__

    def draw(self, _context):
        layout = self.layout
        if loader.library() is None:
            common.draw_library_error(layout)
        else:
            column = layout.column(align=True)
            for name, value in facts():
                row = column.split(factor=0.25)
                row.label(text=name)
                row.label(text=value, translate=False)
        row = layout.row()
        row.operator(operators.KESTREL_OT_copy_system_report.bl_idname, icon="COPYDOWN")
        row.operator(operators.KESTREL_OT_open_log.bl_idname, icon="TEXT")


def facts():
    """(name, value) of what is known of the library and the machine."""
    info = loader.device_info()
    return (
        ("Version", loader.library().version()),
        ("Library", report.without_home(loader.library_path())),
        ("OpenGL Device", loader.device_text()),
        ("Ray Tracing", f"Embree {info.get('embree', '?')}, {info.get('threads', '?')} threads"),
        ("Image Files", info.get("image_plugin") or "Read by Blender"),
    )


def register():
    bpy.utils.register_class(KestrelPreferences)


def unregister():
    bpy.utils.unregister_class(KestrelPreferences)
