# SPDX-License-Identifier: GPL-3.0-or-later
"""The Render tab."""

import bpy

from ..native import loader
from .common import KestrelPanel, TablePanel, draw_library_error


class KESTREL_RENDER_PT_library(KestrelPanel, bpy.types.Panel):
    bl_label = "Kestrel cannot render"
    needs_library = False

    @classmethod
    def shown(cls, _context):
        return loader.library() is None

    def draw(self, _context):
        draw_library_error(self.layout)


class KESTREL_RENDER_PT_sampling(TablePanel, bpy.types.Panel):
    bl_label = "Sampling"
    names = ("viewport_samples", "samples", "pixel_filter", "filter_width")


class KESTREL_RENDER_PT_budget(TablePanel, bpy.types.Panel):
    bl_label = "Ray Tracing Budget"
    names = ("budget_ms", "selection", "selection_inertia")


class KESTREL_RENDER_PT_tracing(TablePanel, bpy.types.Panel):
    bl_label = "Ray Tracing"
    names = ("max_depth", "importance_cutoff", "environment_ior", "shadow_mode")


class KESTREL_RENDER_PT_shading(TablePanel, bpy.types.Panel):
    bl_label = "Shading"
    bl_options = {"DEFAULT_CLOSED"}
    names = ("shading_model", "ambient")


class KESTREL_RENDER_PT_performance(TablePanel, bpy.types.Panel):
    bl_label = "Performance"
    bl_options = {"DEFAULT_CLOSED"}
    names = ("primary", "tracer", "threads", "validate_areas")

    def draw(self, context):
        super().draw(context)
        self.layout.prop(context.scene.render, "preview_pixel_size", text="Viewport Pixel Size")


CLASSES = (
    KESTREL_RENDER_PT_library,
    KESTREL_RENDER_PT_sampling,
    KESTREL_RENDER_PT_budget,
    KESTREL_RENDER_PT_tracing,
    KESTREL_RENDER_PT_shading,
    KESTREL_RENDER_PT_performance,
)
