# SPDX-License-Identifier: GPL-3.0-or-later
"""Times one F12 of the open .blend file; runs inside Blender.

    blender -b FILE.blend --python blender_f12.py -- ENGINE

Prints "F12 " and a JSON object: ms of the whole render() call, peak_mb of the process. Cycles is
given 1 sample on the processor, no denoiser and Blender's default bounces; Kestrel 1 sample and no
budget; EEVEE 1 sample.
"""

import json
import resource
import sys
import time

import addon_utils
import bpy

engine = sys.argv[sys.argv.index("--") + 1]
scene = bpy.context.scene
if engine == "KESTREL":
    addon_utils.enable("kestrel")
scene.render.engine = engine
scene.render.resolution_x, scene.render.resolution_y = 1280, 720
scene.render.resolution_percentage = 100
if engine == "KESTREL":
    scene.kestrel.samples, scene.kestrel.budget_ms = 1, 0.0
elif engine == "CYCLES":
    cycles = scene.cycles
    cycles.device, cycles.samples = "CPU", 1
    cycles.use_denoising = cycles.use_adaptive_sampling = False
    cycles.max_bounces, cycles.transmission_bounces = 12, 12
    cycles.diffuse_bounces, cycles.glossy_bounces, cycles.transparent_max_bounces = 4, 4, 8
    cycles.caustics_reflective = cycles.caustics_refractive = True
    cycles.light_sampling_threshold = 0.01
else:
    scene.eevee.taa_render_samples = 1


def measure():
    begin = time.perf_counter()
    bpy.ops.render.render()
    ms = 1000.0 * (time.perf_counter() - begin)
    peak_mb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
    print("F12 " + json.dumps({"ms": ms, "peak_mb": peak_mb}), flush=True)


if bpy.app.background:
    measure()
else:
    def once():
        measure()
        bpy.ops.wm.quit_blender()
    bpy.app.timers.register(once, first_interval=1.0)
