# SPDX-License-Identifier: GPL-3.0-or-later
"""Opens a window with the engine KESTREL and takes pictures of it; packaging/matrix.py runs it.

    xvfb-run blender FILE.blend --python tests/matrix/viewport.py -- MODULE FOLDER

Shading is set to solid, material preview, rendered and solid again, with a screenshot of each in
FOLDER. Prints `step: ...` lines and ends with status 0 when nothing was amiss, else 1. Once the engine
draws into the viewport, the rendered one must show the scene; until then Blender must not offer it.
"""

import os
import sys
import traceback
from pathlib import Path

import bpy
import numpy as np

MODULE, FOLDER = sys.argv[sys.argv.index("--") + 1:][:2]
FOLDER = Path(FOLDER)
SHADINGS = ("SOLID", "MATERIAL", "RENDERED", "SOLID")
WAIT_S = 6.0          # for a shading to show; software GL compiles its shaders meanwhile
CONTENT_SPREAD = 0.02  # standard deviation of a picture, 0 to 1, that is more than a plain area
PATIENCE = 5           # times to look again at a picture that shows nothing yet
_state = {"index": -1, "looks": 0}


def window_and_area():
    window = bpy.context.window_manager.windows[0]
    areas = [area for area in window.screen.areas if area.type == "VIEW_3D"]
    return window, max(areas, key=lambda area: area.width * area.height)


def shoot(name):
    """Screenshot of the window; returns the 3D view's middle, height x width x 3, 0 to 1."""
    window, area = window_and_area()
    path = FOLDER / f"viewport_{name}.png"
    with bpy.context.temp_override(window=window, area=area):
        bpy.ops.wm.redraw_timer(type="DRAW_WIN_SWAP", iterations=1)
        bpy.ops.screen.screenshot(filepath=str(path))
    image = bpy.data.images.load(str(path))
    width, height = image.size
    pixels = np.empty(width * height * 4, np.float32)
    image.pixels.foreach_get(pixels)
    bpy.data.images.remove(image)
    picture = pixels.reshape(height, width, 4)[..., :3]
    left, low = area.x + area.width // 4, area.y + area.height // 4
    return picture[low:low + area.height // 2, left:left + area.width // 2]


def draws():
    """Whether the engine draws into the viewport."""
    return any(hasattr(kind, "view_draw") for kind in bpy.types.RenderEngine.__subclasses__()
               if getattr(kind, "bl_idname", "") == "KESTREL")


def is_shown(name, picture):
    """Whether there is something to see; raises when there has been nothing for long."""
    spread = float(picture.std())
    _state["looks"] += 1
    if spread >= CONTENT_SPREAD:
        print(f"step: {name}: spread {spread:.3f}", flush=True)
        _state["looks"] = 0
        return True
    if _state["looks"] > PATIENCE:
        raise RuntimeError(f"the {name} viewport shows nothing (spread {spread:.3f})")
    return False


def show(space, shading):
    """Set a shading. Without view_draw, Blender does not offer the rendered one."""
    if shading == "RENDERED" and not draws():
        try:
            space.shading.type = shading
        except TypeError:
            print("step: RENDERED: not offered, as the engine does not draw into the viewport yet",
                  flush=True)
            return
        raise RuntimeError("an engine that does not draw is offered as rendered shading")
    space.shading.type = shading


def advance():
    """Picture of the shading that has been shown for a while, then the next one."""
    try:
        if _state["index"] >= 0:
            name = SHADINGS[_state["index"]]
            if not is_shown(name, shoot(name)):
                return WAIT_S
        _state["index"] += 1
        if _state["index"] == len(SHADINGS):
            print("step: the window went through every shading", flush=True)
            bpy.ops.wm.quit_blender()  # as the artist does, so that a crash on the way out shows
            return None
        _, area = window_and_area()
        space = area.spaces.active
        show(space, SHADINGS[_state["index"]])
        space.region_3d.view_perspective = "CAMERA"
        area.tag_redraw()
        return WAIT_S
    except Exception:
        traceback.print_exc(file=sys.stdout)
        sys.stdout.flush()
        os._exit(1)


def start():
    if bpy.context.scene.render.engine != "KESTREL":
        bpy.context.scene.render.engine = "KESTREL"
    bpy.app.timers.register(advance, first_interval=2.0)


start()
