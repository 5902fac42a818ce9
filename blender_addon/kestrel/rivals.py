# SPDX-License-Identifier: GPL-3.0-or-later
"""Two Kestrels in one Blender, such as an old add-on and a new extension: the second one stands back.

Both would register the same engine, settings and panels, and load two libraries. So the one that
Blender starts later registers nothing but a page in the preferences, and says what to do.
"""

import bpy

from .ui import common

_page = None
_text = ""


def active():
    """The module of another Kestrel whose engine is registered; empty when there is none."""
    for kind in bpy.types.RenderEngine.__subclasses__():
        owner = kind.__module__.rpartition(".")[0]
        if getattr(kind, "bl_idname", "") == common.ENGINE and kind.is_registered \
                and owner != __package__:
            return owner
    return ""


def message(other):
    return (f"Two Kestrels at once: '{other}' is enabled already, so '{__package__}' does nothing. "
            "Disable or remove one of the two in the preferences and restart Blender.")


def _draw_page(self, _context):
    common.draw_text(self.layout, _text)


def _pop_up():
    """In the window, as soon as there is one."""
    bpy.context.window_manager.popup_menu(_draw_page, title="Kestrel", icon="ERROR")


def register():
    global _page, _text
    _text = message(active())
    print(f"kestrel: error: {_text}", flush=True)
    # A name of its own, as the other Kestrel has a page too.
    _page = type("KestrelIdlePreferences", (bpy.types.AddonPreferences,),
                 {"bl_idname": __package__, "draw": _draw_page, "__module__": __name__})
    bpy.utils.register_class(_page)
    if not bpy.app.background:
        bpy.app.timers.register(_pop_up, first_interval=1.0)


def unregister():
    if bpy.app.timers.is_registered(_pop_up):
        bpy.app.timers.unregister(_pop_up)
    bpy.utils.unregister_class(_page)
