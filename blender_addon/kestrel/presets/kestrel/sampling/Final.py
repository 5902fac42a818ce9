# SPDX-License-Identifier: GPL-3.0-or-later
# For the finished picture: eight times the samples, long chains of reflections.
import bpy

kestrel = bpy.context.scene.kestrel

kestrel.viewport_samples = 32
kestrel.samples = 128
kestrel.selection = "all"
kestrel.budget_ms = 0.0
kestrel.max_depth = 16
kestrel.importance_cutoff = 0.002
kestrel.pixel_filter = "blackman_harris"
kestrel.filter_width = 1.5
