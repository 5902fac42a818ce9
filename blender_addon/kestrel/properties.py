# SPDX-License-Identifier: GPL-3.0-or-later
"""scene.kestrel and object.kestrel, made from the parameter table; view_layer.kestrel and
material.kestrel, which the table does not know."""

import bpy
from bpy.props import (BoolProperty, EnumProperty, FloatProperty, FloatVectorProperty, IntProperty,
                       PointerProperty)

from . import passes
from .native import loader
from .sync.settings import BLENDERS_OWN

ABBREVIATIONS = {"ior": "IOR"}
# What the artist reads of a choice: (label, description). The table knows its identifiers.
ITEMS = {
    ("selection", "graph"): ("Most Relevant", "Those that matter most, as many as the budget "
                                               "allows"),
    ("selection", "all"): ("All", "Every object in view, however long it takes"),
    ("selection", "none"): ("None", "No object: rasterised shading alone, the fastest"),
    ("shading_model", "blinn_phong"): ("Blinn-Phong", "Diffuse reflection and a highlight"),
    ("shading_model", "principled"): ("Principled", "Blender's Principled BSDF"),
    ("primary", "auto"): ("Automatic", "Whichever is faster on this machine"),
    ("primary", "raster"): ("Rasterized", "With OpenGL: fast on a graphics card"),
    ("primary", "rays"): ("Rays", "On the processor: fast without a graphics card, and needs no "
                                  "OpenGL"),
    ("tracer", "auto"): ("Automatic", "Whichever suits the object"),
    ("tracer", "embree"): ("Embree", "Exact rays on the processor"),
    ("pixel_filter", "box"): ("Box", "Every sample counts the same: sharp, with harder edges"),
    ("pixel_filter", "blackman_harris"): ("Blackman-Harris", "Samples near the centre count most: "
                                                             "smooth edges"),
    ("shadow_mode", "hard"): ("Hard", "Every light is a point or a direction: one ray a light"),
    ("shadow_mode", "soft"): ("Soft", "Lights have a size: edges blur, with noise at few samples"),
    "auto": ("Automatic", "Ray traced where the budget allows"),
    "always": ("Always", "Ray traced whatever it costs"),
    "never": ("Never", "Left as it was rasterised, which costs nothing"),
}
# Where a slider should end; the table's own limits only keep out what makes no sense.
SOFT_MAXIMUM = {"budget_ms": 1000.0, "selection_inertia": 10000.0, "ambient": 1.0,
                "environment_ior": 3.0, "samples": 1024, "filter_width": 5.0, "relevance": 100.0,
                "cost": 100.0}
PRECISION = {"budget_ms": 1, "selection_inertia": 1}  # digits shown; 3 for the others


def label(name, unit=""):
    """'budget_ms' in ms: 'Budget (ms)'."""
    words = name.split("_")
    if unit and words[-1] == unit:
        words.pop()
    text = " ".join(ABBREVIATIONS.get(word, word.capitalize()) for word in words)
    return f"{text} ({unit})" if unit and unit != "px" else text


def table_property(row):
    """The bpy property of one row of the parameter table."""
    common = {"name": label(row["name"], row["unit"]), "description": row["help"]}
    kind, default = row["type"], row["default"]
    if kind == "bool":
        return BoolProperty(default=default == "true", **common)
    if kind == "enum":
        items = [(item, *ITEMS.get((row["name"], item), ITEMS.get(item, (label(item), ""))))
                 for item in row["items"]]
        return EnumProperty(items=items, default=default, **common)
    limits = {"min": row["min"], "max": row["max"],
              "soft_max": SOFT_MAXIMUM.get(row["name"], row["max"])}
    if kind == "int":
        limits = {name: int(value) for name, value in limits.items()}
        return IntProperty(default=int(default), **limits, **common)
    if kind == "color":
        return FloatVectorProperty(size=3, subtype="COLOR", **limits, **common,
                                   default=tuple(float(c) for c in default.split()))
    return FloatProperty(default=float(default), precision=PRECISION.get(row["name"], 3), **limits,
                         **common, subtype="PIXEL" if row["unit"] == "px" else "NONE")


def group(name, annotations):
    return type(name, (bpy.types.PropertyGroup,), {"__annotations__": annotations})


def table_group(name, scope, **more):
    rows = {row["name"]: table_property(row) for row in loader.parameter_table()
            if row["scope"] == scope and row["name"] not in BLENDERS_OWN}
    return group(name, {**rows, **more})


def scene_group():
    return table_group("KestrelSceneSettings", "scene", viewport_samples=IntProperty(
        name="Viewport Samples", default=16, min=1, max=65536, soft_max=1024,
        description="Anti-aliasing samples per pixel that a still 3D view adds up. More take "
                    "longer to finish; while something changes, each frame has one, whatever "
                    "is set here"))


def _passes_changed(_group, context):
    if context.view_layer is not None:
        context.view_layer.update_render_passes()


def view_layer_group():
    items = [(item.name, label_of_pass(item.name), item.help, 1 << index)
             for index, item in enumerate(passes.OPTIONAL)]
    return group("KestrelViewLayerSettings", {"passes": EnumProperty(
        name="Passes",
        description="What else is written beside the picture. Each pass takes memory, and time to "
                    "write", items=items,
        options={"ENUM_FLAG"}, default=set(), update=_passes_changed)})


def label_of_pass(name):
    """'HeuristicMask': 'Heuristic Mask'."""
    return "".join(f" {c}" if c.isupper() else c for c in name).strip()


def material_group():
    return group("KestrelMaterialSettings", {"casts_shadow": BoolProperty(
        name="Cast Shadows",
        description="Surfaces of this material block light. Without it light passes as if they "
                    "were not there, which takes about the same time", default=True)})


_registered = []  # (class, owner type)


def register():
    for made, owner in ((scene_group(), bpy.types.Scene),
                        (table_group("KestrelObjectSettings", "object"), bpy.types.Object),
                        (view_layer_group(), bpy.types.ViewLayer),
                        (material_group(), bpy.types.Material)):
        bpy.utils.register_class(made)
        owner.kestrel = PointerProperty(type=made, name="Kestrel",
                                        description="Settings of the render engine Kestrel")
        _registered.append((made, owner))


def unregister():
    while _registered:
        made, owner = _registered.pop()
        del owner.kestrel
        bpy.utils.unregister_class(made)
