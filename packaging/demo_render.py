# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders the open .blend file with KESTREL for `./dev demo`; runs inside Blender.

    blender -b FILE.blend -E KESTREL --python packaging/demo_render.py -- --out out/demo/showcase

Writes OUT.exr (every pass, multilayer, linear) and OUT.png (view transform Standard), and prints
what to tell the user on lines that begin with `demo: `.
"""

import json
import sys
import time
from pathlib import Path

import bpy

SIZE_PX = (1280, 720)
SAMPLES = 8  # half of what F12 takes by default: the demo should not keep anyone waiting
STAGES = ("raster", "heuristic", "trace", "blend")


def tell(text):
    print(f"demo: {text}", flush=True)


def prepare(scene):
    if scene.render.engine != "KESTREL":
        raise RuntimeError("the engine KESTREL is not registered; is the add-on enabled?")
    scene.render.resolution_x, scene.render.resolution_y = SIZE_PX
    scene.render.resolution_percentage = 100
    scene.render.use_persistent_data = True  # the statistics are read after the render
    scene.kestrel.samples = SAMPLES
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


def choose_all_passes(view_layer):
    """Switch on every pass that Kestrel has; returns their names."""
    from kestrel import passes
    for item in passes.PASSES:
        if item.toggle:
            setattr(view_layer, item.toggle, True)
    view_layer.kestrel.passes = {item.name for item in passes.OPTIONAL}
    return [item.blender_name for item in passes.enabled(view_layer)]


def last_stats(scene, view_layer):
    """What the core says about the frame just rendered."""
    from kestrel import final_render, session
    key = final_render.session_key(scene, view_layer)
    stats = session.acquire(key).renderer.stats()
    return json.loads(stats)


def tell_stats(stats):
    times = stats["stages_ms"]
    tell("stages: " + ", ".join(f"{stage} {times[stage]:.1f} ms" for stage in STAGES))
    tell(f"frame: {stats['frame_ms']:.0f} ms, primary visibility by {stats['primary']}, rays: "
         + ", ".join(f"{kind} {count:,}" for kind, count in stats["rays"].items()))
    selected = sum(bool(item["selected"]) for item in stats["objects"])
    tell(f"objects: {len(stats['objects'])}, ray traced: {selected}")


def main():
    out = Path(sys.argv[sys.argv.index("--out") + 1]).resolve()
    scene, view_layer = bpy.context.scene, bpy.context.view_layer
    prepare(scene)
    names = choose_all_passes(view_layer)
    seconds = render(scene, out)
    stats = last_stats(scene, view_layer)
    (out.parent / "stats.json").write_text(json.dumps({"frames": [stats]}, indent=1) + "\n")
    tell_stats(stats)
    tell(f"render call: {seconds:.2f} s at {SIZE_PX[0]}x{SIZE_PX[1]}, {SAMPLES} samples")
    tell(f"passes: {', '.join(names)}")
    tell(f"all passes: {display(out)}.exr")
    tell(f"picture: {display(out)}.png")


def display(path):
    """The path as the user may type it."""
    return path.relative_to(Path.cwd()) if Path.cwd() in path.parents else path


main()
