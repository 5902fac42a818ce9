# SPDX-License-Identifier: GPL-3.0-or-later
"""Opens a window with the engine KESTREL and takes pictures of it; packaging/matrix.py runs it.

    xvfb-run -s "-fbdir FOLDER/display" blender FILE.blend --python tests/matrix/viewport.py -- \\
        MODULE FOLDER

Shading is set to solid, material preview, rendered and solid again, with a screenshot of each in
FOLDER. Prints `step: ...` lines and ends with status 0 when nothing was amiss, else 1. Once the engine
draws into the viewport, the rendered one must show the scene; until then Blender must not offer it.
"""

import os
import struct
import sys
import traceback
import zlib
from pathlib import Path

import bpy
import numpy as np

MODULE, FOLDER = sys.argv[sys.argv.index("--") + 1:][:2]
FOLDER = Path(FOLDER)
FRAME_BUFFER = FOLDER / "display" / "Xvfb_screen0"
SHADINGS = ("SOLID", "MATERIAL", "RENDERED", "SOLID")
WAIT_S = 6.0          # for a shading to show; software GL compiles its shaders meanwhile
CONTENT_SPREAD = 0.02  # standard deviation of a picture, 0 to 1, that is more than a plain area
PATIENCE = 5           # times to look again at a picture that shows nothing yet
_state = {"index": -1, "looks": 0}


def window_and_area():
    window = bpy.context.window_manager.windows[0]
    areas = [area for area in window.screen.areas if area.type == "VIEW_3D"]
    return window, max(areas, key=lambda area: area.width * area.height)


def read_display():
    """What the virtual display shows, height x width x 3, 0 to 255, first row on top: the file that
    Xvfb keeps its frame buffer in (X window dump format, 32 bits a pixel)."""
    data = FRAME_BUFFER.read_bytes()
    header = struct.unpack_from(">25I", data)
    size, width, height, pitch, colors = header[0], header[4], header[5], header[12], header[19]
    rows = np.frombuffer(data, np.uint8, pitch * height, size + 12 * colors).reshape(height, pitch)
    return rows[:, :4 * width].reshape(height, width, 4)[..., 2::-1]


def write_png(path, picture):
    def chunk(kind, content):
        check = zlib.crc32(kind + content)
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", check)

    height, width, _ = picture.shape
    rows = b"".join(b"\0" + row.tobytes() for row in picture)
    path.write_bytes(b"\x89PNG\r\n\x1a\n"
                     + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0))
                     + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


def shoot(name):
    """Screenshot of the display; returns the 3D view's middle, 0 to 1. Blender's own screenshots are
    black in some combinations of its version and Mesa's."""
    _, area = window_and_area()
    picture = read_display()
    write_png(FOLDER / f"viewport_{name}.png", picture)
    left, low = area.x + area.width // 4, area.y + area.height // 4
    top = picture.shape[0] - low - area.height // 2
    return picture[top:top + area.height // 2, left:left + area.width // 2] / 255.0


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
