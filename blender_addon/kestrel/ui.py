# SPDX-License-Identifier: GPL-3.0-or-later
"""Panels: Kestrel's own, and Blender's that make sense with it."""

import textwrap

import bpy

from .native import loader

ENGINE = "KESTREL"
TEXT_WIDTH = 60  # characters of a wrapped message

# Panels for every engine without one of its own that show what Kestrel has not.
NOT_FOR_KESTREL = {
    "DATA_PT_area", "DATA_PT_falloff_curve", "DATA_PT_light", "DATA_PT_preview", "DATA_PT_spot",
    "EEVEE_MATERIAL_PT_viewport_settings", "NODE_DATA_PT_light", "RENDER_PT_stereoscopy",
    "WORLD_PT_context_world",
}
NOT_FOR_KESTREL_PREFIXES = ("MATERIAL_PT_freestyle", "RENDER_PT_freestyle", "RENDER_PT_gpencil",
                            "RENDER_PT_grease_pencil", "VIEWLAYER_PT_freestyle")


def draw_text(layout, text):
    """A message of several lines."""
    column = layout.column(align=True)
    for index, line in enumerate(textwrap.wrap(text, TEXT_WIDTH)):
        column.label(text=line, icon="ERROR" if index == 0 else "BLANK1")


def draw_library_error(layout):
    """Why nothing can be rendered, and what to do."""
    draw_text(layout, loader.error())


class KestrelPanel:
    """What all of Kestrel's panels share."""
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "render"
    COMPAT_ENGINES = {ENGINE}
    needs_library = True

    @classmethod
    def poll(cls, context):
        return (context.engine in cls.COMPAT_ENGINES and
                (not cls.needs_library or loader.library() is not None) and cls.shown(context))

    @classmethod
    def shown(cls, _context):
        return True


class TablePanel(KestrelPanel):
    """A panel of rows of the parameter table, `names`, of what owner() gives."""
    names = ()

    @staticmethod
    def owner(context):
        return context.scene

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = self.bl_context == "object"
        for name in self.names:
            layout.prop(self.owner(context).kestrel, name)


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


class KESTREL_OBJECT_PT_tracing(TablePanel, bpy.types.Panel):
    bl_label = "Ray Tracing"
    bl_context = "object"
    names = ("relevance", "cost", "shadows", "reflections", "refractions")

    @staticmethod
    def owner(context):
        return context.object

    @classmethod
    def shown(cls, context):
        return context.object is not None and context.object.type not in {"LIGHT", "CAMERA"}


class KESTREL_VIEW_LAYER_PT_passes(KestrelPanel, bpy.types.Panel):
    bl_label = "Passes"
    bl_context = "view_layer"
    needs_library = False

    def draw(self, context):
        layout = self.layout
        layer = context.view_layer
        layout.use_property_split = True
        layout.use_property_decorate = False
        column = layout.column(heading="Data", align=True)
        column.prop(layer, "use_pass_z", text="Depth")
        column.prop(layer, "use_pass_position")
        column.prop(layer, "use_pass_normal")
        column.prop(layer, "use_pass_emit", text="Emission")
        layout.use_property_split = False
        layout.label(text="Kestrel")
        layout.column(align=True).prop(layer.kestrel, "passes")


# ---- materials, lights, world ------------------------------------------------------------------

def draw_node_input(layout, tree, output_type, input_name):
    """The node that feeds the output, as a tree of its inputs."""
    output = tree.get_output_node("CYCLES") if output_type is None else next(
        (node for node in tree.nodes if node.type == output_type and node.is_active_output), None)
    if output is None:
        layout.label(text="No output node", icon="INFO")
        return
    layout.template_node_view(tree, output, output.inputs[input_name])


class KESTREL_MATERIAL_PT_slots(KestrelPanel, bpy.types.Panel):
    bl_label = ""
    bl_context = "material"
    bl_options = {"HIDE_HEADER"}
    needs_library = False

    @classmethod
    def shown(cls, context):
        return (context.material or context.object) and not (
            context.object and context.object.type in {"GPENCIL", "GREASEPENCIL"})

    def draw(self, context):
        layout, obj = self.layout, context.object
        if obj is None:
            layout.template_ID(context.space_data, "pin_id")
            return
        row = layout.row()
        row.template_list("MATERIAL_UL_matslots", "", obj, "material_slots", obj,
                          "active_material_index", rows=3 if len(obj.material_slots) < 2 else 5)
        column = row.column(align=True)
        column.operator("object.material_slot_add", icon="ADD", text="")
        column.operator("object.material_slot_remove", icon="REMOVE", text="")
        column.menu("MATERIAL_MT_context_menu", icon="DOWNARROW_HLT", text="")
        layout.template_ID(obj, "active_material", new="material.new")
        if obj.mode == "EDIT":
            row = layout.row(align=True)
            row.operator("object.material_slot_assign", text="Assign")
            row.operator("object.material_slot_select", text="Select")
            row.operator("object.material_slot_deselect", text="Deselect")


class KESTREL_MATERIAL_PT_surface(KestrelPanel, bpy.types.Panel):
    bl_label = "Surface"
    bl_context = "material"
    needs_library = False

    @classmethod
    def shown(cls, context):
        return context.material is not None and not context.material.grease_pencil

    def draw(self, context):
        layout, material = self.layout, context.material
        layout.use_property_split = True
        layout.prop(material, "use_nodes", icon="NODETREE")
        if material.use_nodes and material.node_tree:
            draw_node_input(layout, material.node_tree, None, "Surface")
        else:
            layout.prop(material, "diffuse_color", text="Base Color")
            layout.prop(material, "metallic")
            layout.prop(material, "roughness")


class KESTREL_MATERIAL_PT_settings(KestrelPanel, bpy.types.Panel):
    bl_label = "Settings"
    bl_context = "material"
    needs_library = False
    shown = KESTREL_MATERIAL_PT_surface.shown

    def draw(self, context):
        layout, material = self.layout, context.material
        layout.use_property_split = True
        layout.prop(material.kestrel, "casts_shadow")
        if getattr(material, "blend_method", "") == "CLIP":
            layout.prop(material, "alpha_threshold")


class KESTREL_LIGHT_PT_light(KestrelPanel, bpy.types.Panel):
    bl_label = "Light"
    bl_context = "data"
    needs_library = False

    @classmethod
    def shown(cls, context):
        return context.light is not None

    def draw(self, context):
        layout, light = self.layout, context.light
        layout.row().prop(light, "type", expand=True)
        layout.use_property_split = True
        layout.prop(light, "color")
        layout.prop(light, "energy", text="Strength" if light.type == "SUN" else "Power")
        layout.prop(light, "specular_factor", text="Specular")
        if light.type == "SPOT":
            layout.prop(light, "spot_size")
            layout.prop(light, "spot_blend", slider=True)
        if hasattr(light, "use_shadow"):
            layout.prop(light, "use_shadow")


class KESTREL_WORLD_PT_context(KestrelPanel, bpy.types.Panel):
    bl_label = ""
    bl_context = "world"
    bl_options = {"HIDE_HEADER"}
    needs_library = False

    def draw(self, context):
        self.layout.template_ID(context.scene, "world", new="world.new")


class KESTREL_WORLD_PT_surface(KestrelPanel, bpy.types.Panel):
    bl_label = "Surface"
    bl_context = "world"
    needs_library = False

    @classmethod
    def shown(cls, context):
        return context.world is not None

    def draw(self, context):
        layout, world = self.layout, context.world
        layout.use_property_split = True
        layout.prop(world, "use_nodes", icon="NODETREE")
        if world.use_nodes and world.node_tree:
            draw_node_input(layout, world.node_tree, "OUTPUT_WORLD", "Surface")
        else:
            layout.prop(world, "color")


CLASSES = (
    KESTREL_RENDER_PT_library,
    KESTREL_RENDER_PT_sampling,
    KESTREL_RENDER_PT_budget,
    KESTREL_RENDER_PT_tracing,
    KESTREL_RENDER_PT_shading,
    KESTREL_RENDER_PT_performance,
    KESTREL_OBJECT_PT_tracing,
    KESTREL_VIEW_LAYER_PT_passes,
    KESTREL_MATERIAL_PT_slots,
    KESTREL_MATERIAL_PT_surface,
    KESTREL_MATERIAL_PT_settings,
    KESTREL_LIGHT_PT_light,
    KESTREL_WORLD_PT_context,
    KESTREL_WORLD_PT_surface,
)


def shared_panels():
    """Blender's panels that every engine without special needs shows."""
    for panel in bpy.types.Panel.__subclasses__():
        engines = getattr(panel, "COMPAT_ENGINES", ())
        name = panel.__name__
        if ("BLENDER_RENDER" in engines and name not in NOT_FOR_KESTREL
                and not name.startswith(NOT_FOR_KESTREL_PREFIXES)):
            yield panel


_shared = []


def register():
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    _shared.extend(shared_panels())
    for panel in _shared:
        panel.COMPAT_ENGINES.add(ENGINE)


def unregister():
    while _shared:
        _shared.pop().COMPAT_ENGINES.discard(ENGINE)
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
