# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders the open .blend file with KESTREL for `./dev demo`; runs inside Blender.

    blender -b FILE.blend -E KESTREL --python packaging/demo_render.py -- --out out/demo/showcase

Writes OUT.exr (every pass, multilayer, linear) and OUT.png (view transform Standard), and prints
what to tell the user on lines that begin with `demo: `.
"""

import sys
import time
from pathlib import Path

import bpy

SIZE_PX = (1280, 720)
STAGES = ("raster", "heuristic", "trace", "blend")


def tell(text):
    print(f"demo: {text}", flush=True)


def prepare(scene):
    if scene.render.engine != "KESTREL":
        raise RuntimeError("the engine KESTREL is not registered; is the add-on enabled?")
    scene.render.resolution_x, scene.render.resolution_y = SIZE_PX
    scene.render.resolution_percentage = 100
    scene.view_settings.view_transform = "Standard"
    scene.view_settings.look = "None"


def use_format(scene, **values):
    for name, value in values.items():
        setattr(scene.render.image_settings, name, value)


def render(scene, out):
    """Render once and write both files; returns the seconds of the whole call."""
    use_format(scene, file_format="OPEN_EXR_MULTILAYER", color_depth="16", exr_codec="ZIP")
    scene.render.filepath = f"{out}.exr"
    start = time.monotonic()
    bpy.ops.render.render(write_still=True)
    seconds = time.monotonic() - start
    use_format(scene, file_format="PNG", color_mode="RGB", color_depth="8")
    bpy.data.images["Render Result"].save_render(f"{out}.png", scene=scene)
    return seconds


def main():
    out = Path(sys.argv[sys.argv.index("--out") + 1]).resolve()
    prepare(bpy.context.scene)
    seconds = render(bpy.context.scene, out)
    tell(f"picture: {out}.png")
    tell(f"render call: {seconds:.2f} s")


main()
