# SPDX-License-Identifier: GPL-3.0-or-later
"""Preview icons of materials, lights and worlds: small pictures of Blender's own preview scene.

Blender asks for one as it asks for a frame, from a thread of its own while the artist works on. So
an icon has a session to itself, which ends with it, keeps off OpenGL, takes few samples and says
nothing: what is wrong with a material is said when the scene that uses it is rendered.
"""

import itertools
import weakref

from . import session, sync

# 128 x 128 pixels in about a tenth of a second on two cores.
SETTINGS = {"samples": "4", "max_depth": "6", "importance_cutoff": "0.05", "primary": "rays"}
# Of the floor that icons without a background only mirror and refract: its nodes hide it from the
# camera in Cycles.
HIDDEN_FLOOR = "FloorHidden"

_numbers = itertools.count(1)


def new_key(engine):
    """The key of an icon's session, which is dropped with the engine at the latest."""
    key = f"icon/{next(_numbers)}"
    weakref.finalize(engine, session.drop, key).atexit = False
    return key


def export(target, depsgraph, camera):
    """Send the preview scene; returns as sync.export_depsgraph() does."""
    target.unseen_material = HIDDEN_FLOOR
    return sync.export_depsgraph(target, depsgraph, camera, lambda _text: None, SETTINGS)
