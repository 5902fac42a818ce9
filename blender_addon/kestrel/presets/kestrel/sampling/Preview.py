# SPDX-License-Identifier: GPL-3.0-or-later
# A first look: few samples, ray tracing within 20 ms a frame.
import bpy

kestrel = bpy.context.scene.kestrel

kestrel.viewport_samples = 4
kestrel.samples = 4
kestrel.selection = "graph"
kestrel.budget_ms = 20.0
kestrel.max_depth = 4
kestrel.importance_cutoff = 0.05
kestrel.pixel_filter = "blackman_harris"
kestrel.filter_width = 1.5
