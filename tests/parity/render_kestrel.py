# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders the open .blend file with KESTREL into a linear EXR; runs inside Blender.

    blender -b FILE.blend -E KESTREL --python render_kestrel.py -- --out FILE.exr --samples N
"""

import argparse
import sys

import bpy

parser = argparse.ArgumentParser(prog="render_kestrel.py")
parser.add_argument("--out", required=True)
parser.add_argument("--samples", type=int, required=True)
args = parser.parse_args(sys.argv[sys.argv.index("--") + 1:])

scene = bpy.context.scene
if scene.render.engine != "KESTREL":
    raise RuntimeError("the engine KESTREL is not registered; is the add-on enabled?")
scene.kestrel.samples = args.samples
scene.kestrel.pixel_filter, scene.kestrel.filter_width = "box", 1.0
image = scene.render.image_settings
image.file_format, image.color_mode, image.color_depth, image.exr_codec = (
    "OPEN_EXR", "RGB", "32", "ZIP")
scene.render.filepath = args.out
scene.render.use_file_extension = False
bpy.ops.render.render(write_still=True)
