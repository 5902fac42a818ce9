# SPDX-License-Identifier: GPL-3.0-or-later
"""Keeps Blender from forbidding Python to write for good.

While Blender draws, Python may not write to its data; one flag says so, for all threads. A render
that begins on its own thread in that time finds the flag set and sets it again when it ends, and
from then on every timer and handler fails. As view_draw() lets other threads go on whenever it
calls the library, this would be common. Blender lifts the flag for the getters of properties: what is
drawn from one leaves nothing to find.
"""

import bpy

_NAME = "kestrel_drawing"
_todo = []


def _getter(_window_manager):
    _todo.pop()()
    return True


def lifted(window_manager, function):
    """Call `function()`, which must not raise, while the flag is lifted."""
    _todo.append(function)
    getattr(window_manager, _NAME)


def register():
    setattr(bpy.types.WindowManager, _NAME,
            bpy.props.BoolProperty(get=_getter, options={"HIDDEN", "SKIP_SAVE"}))


def unregister():
    delattr(bpy.types.WindowManager, _NAME)
