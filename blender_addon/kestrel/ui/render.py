# SPDX-License-Identifier: GPL-3.0-or-later
"""The Render tab."""

import bpy

from ..native import loader
from .common import KestrelPanel, TablePanel, draw_library_error
from .presets import KESTREL_PT_sampling_presets

class RenderPanel(KestrelPanel):
    """A panel of Blender's own settings, `names`, of the scene's render."""
    names = ()  # (property, text)

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        column = layout.column()
        for name, text in self.names:
            column.prop(context.scene.render, name, text=text)


class KESTREL_RENDER_PT_library(KestrelPanel, bpy.types.Panel):
    bl_label = "Kestrel cannot render"
    needs_library = False

    @classmethod
    def shown(cls, _context):
        return loader.library() is None

    def draw(self, _context):
        draw_library_error(self.layout)


class KESTREL_RENDER_PT_sampling(KestrelPanel, bpy.types.Panel):
    bl_label = "Sampling"

    def draw_header_preset(self, _context):
        KESTREL_PT_sampling_presets.draw_panel_header(self.layout)

    def draw(self, _context):
        pass


class KESTREL_RENDER_PT_sampling_viewport(TablePanel, bpy.types.Panel):
    bl_label = "Viewport"
    bl_parent_id = "KESTREL_RENDER_PT_sampling"
    names = ("viewport_samples",)
    texts = {"viewport_samples": "Samples"}


class KESTREL_RENDER_PT_sampling_render(TablePanel, bpy.types.Panel):
    bl_label = "Render"
    bl_parent_id = "KESTREL_RENDER_PT_sampling"
    names = ("samples",)


class KESTREL_RENDER_PT_tracing(TablePanel, bpy.types.Panel):
    bl_label = "Ray Tracing"
    names = ("budget_ms", "selection", "selection_inertia")

    def draw(self, context):
        layout, settings = self.layout, context.scene.kestrel
        layout.use_property_split = True
        layout.use_property_decorate = False
        column = layout.column()
        self.draw_rows(column, context, ("selection",))
        column = layout.column()
        column.active = settings.selection == "graph"
        self.draw_rows(column, context, ("budget_ms", "selection_inertia"))


class KESTREL_RENDER_PT_light_paths(TablePanel, bpy.types.Panel):
    bl_label = "Light Paths"
    bl_options = {"DEFAULT_CLOSED"}
    names = ("max_depth", "importance_cutoff", "environment_ior", "tracer")


class KESTREL_RENDER_PT_shading(TablePanel, bpy.types.Panel):
    bl_label = "Shading"
    bl_options = {"DEFAULT_CLOSED"}
    names = ("shading_model", "shadow_mode", "ambient")


class KESTREL_RENDER_PT_simplify(KestrelPanel, bpy.types.Panel):
    """Instead of Blender's own, which would stand above Sampling."""
    bl_label = "Simplify"
    bl_options = {"DEFAULT_CLOSED"}

    def draw_header(self, context):
        self.layout.prop(context.scene.render, "use_simplify", text="")

    def draw(self, _context):
        pass


class SimplifyPanel(RenderPanel):
    bl_parent_id = "KESTREL_RENDER_PT_simplify"

    def draw(self, context):
        self.layout.active = context.scene.render.use_simplify
        super().draw(context)


class KESTREL_RENDER_PT_simplify_viewport(SimplifyPanel, bpy.types.Panel):
    bl_label = "Viewport"
    names = (("simplify_subdivision", "Max Subdivision"),
             ("simplify_child_particles", "Max Child Particles"))


class KESTREL_RENDER_PT_simplify_render(SimplifyPanel, bpy.types.Panel):
    bl_label = "Render"
    names = (("simplify_subdivision_render", "Max Subdivision"),
             ("simplify_child_particles_render", "Max Child Particles"))


class KESTREL_RENDER_PT_motion_blur(KestrelPanel, bpy.types.Panel):
    bl_label = "Motion Blur"
    bl_options = {"DEFAULT_CLOSED"}

    def draw_header(self, context):
        self.layout.prop(context.scene.render, "use_motion_blur", text="")

    def draw(self, context):
        layout, render = self.layout, context.scene.render
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.active = render.use_motion_blur
        if hasattr(render, "motion_blur_position"):  # 4.2 on
            layout.prop(render, "motion_blur_position", text="Position")
        layout.prop(render, "motion_blur_shutter")


class KESTREL_RENDER_PT_film(RenderPanel, bpy.types.Panel):
    bl_label = "Film"
    bl_options = {"DEFAULT_CLOSED"}
    names = (("film_transparent", "Transparent"),)


class KESTREL_RENDER_PT_film_pixel_filter(TablePanel, bpy.types.Panel):
    bl_label = "Pixel Filter"
    bl_parent_id = "KESTREL_RENDER_PT_film"
    names = ("pixel_filter", "filter_width")
    texts = {"pixel_filter": "Type", "filter_width": "Width"}


class KESTREL_RENDER_PT_performance(TablePanel, bpy.types.Panel):
    bl_label = "Performance"
    bl_options = {"DEFAULT_CLOSED"}
    names = ("primary",)


class KESTREL_RENDER_PT_performance_threads(KestrelPanel, bpy.types.Panel):
    bl_label = "Threads"
    bl_parent_id = "KESTREL_RENDER_PT_performance"

    def draw(self, context):
        layout, render = self.layout, context.scene.render
        layout.use_property_split = True
        layout.use_property_decorate = False
        column = layout.column()
        column.prop(render, "threads_mode")
        sub = column.column()
        sub.enabled = render.threads_mode == "FIXED"
        sub.prop(render, "threads")


class KESTREL_RENDER_PT_performance_final(RenderPanel, bpy.types.Panel):
    bl_label = "Final Render"
    bl_parent_id = "KESTREL_RENDER_PT_performance"
    names = (("use_persistent_data", "Persistent Data"),)


class KESTREL_RENDER_PT_performance_viewport(RenderPanel, bpy.types.Panel):
    bl_label = "Viewport"
    bl_parent_id = "KESTREL_RENDER_PT_performance"
    names = (("preview_pixel_size", "Pixel Size"),)


class KESTREL_RENDER_PT_performance_debug(TablePanel, bpy.types.Panel):
    bl_label = "Debug"
    bl_parent_id = "KESTREL_RENDER_PT_performance"
    bl_options = {"DEFAULT_CLOSED"}
    names = ("validate_areas",)

    @classmethod
    def shown(cls, context):
        return context.preferences.view.show_developer_ui


CLASSES = (
    KESTREL_RENDER_PT_library,
    KESTREL_RENDER_PT_sampling,
    KESTREL_RENDER_PT_sampling_viewport,
    KESTREL_RENDER_PT_sampling_render,
    KESTREL_RENDER_PT_tracing,
    KESTREL_RENDER_PT_light_paths,
    KESTREL_RENDER_PT_shading,
    KESTREL_RENDER_PT_simplify,
    KESTREL_RENDER_PT_simplify_viewport,
    KESTREL_RENDER_PT_simplify_render,
    KESTREL_RENDER_PT_motion_blur,
    KESTREL_RENDER_PT_film,
    KESTREL_RENDER_PT_film_pixel_filter,
    KESTREL_RENDER_PT_performance,
    KESTREL_RENDER_PT_performance_threads,
    KESTREL_RENDER_PT_performance_final,
    KESTREL_RENDER_PT_performance_viewport,
    KESTREL_RENDER_PT_performance_debug,
)
