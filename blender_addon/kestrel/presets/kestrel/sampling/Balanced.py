# SPDX-License-Identifier: GPL-3.0-or-later
# Kestrel's defaults: everything ray traced, smooth edges.
import bpy

kestrel = bpy.context.scene.kestrel

kestrel.viewport_samples = 16
kestrel.samples = 16
kestrel.selection = "graph"
kestrel.budget_ms = 0.0
kestrel.max_depth = 10
kestrel.importance_cutoff = 0.01
kestrel.pixel_filter = "blackman_harris"
kestrel.filter_width = 1.5
