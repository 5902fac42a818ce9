# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on's page in the preferences: whether the library is there, and which one."""

import bpy

from .native import loader
from .ui import common


class KestrelPreferences(bpy.types.AddonPreferences):
    bl_idname = __package__

    def draw(self, _context):
        library = loader.library()
        if library is None:
            common.draw_library_error(self.layout)
            return
        column = self.layout.column()
        column.label(text=f"Kestrel {library.version()}", icon="CHECKMARK")
        column.label(text=str(loader.library_path()))
        column.label(text=loader.device_text())


def register():
    bpy.utils.register_class(KestrelPreferences)


def unregister():
    bpy.utils.unregister_class(KestrelPreferences)
