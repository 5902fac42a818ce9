# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws panels without a window: a layout that knows what Blender would complain about."""

import types

import bpy

# Arguments of Blender's own templates that name a property of the first one.
PROPERTY_TEMPLATES = ("template_ID",)
BLENDERS = (bpy.types.Panel, bpy.types.AddonPreferences)  # classes that Blender alone can make


class Layout:
    """Takes what bpy.types.UILayout takes; `texts` are the words that it was told to show."""

    def __init__(self, texts=None):
        self.texts = [] if texts is None else texts

    def _note(self, *words):
        self.texts += [word for word in words if word]

    def _part(self, *_arguments, heading="", **_options):
        self._note(heading)
        return Layout(self.texts)

    column = row = split = box = grid_flow = column_flow = menu_pie = _part

    def prop(self, data, name, text=None, **_options):
        if name not in data.bl_rna.properties:
            raise AttributeError(f"{data.bl_rna.identifier} has no property '{name}'")
        self._note(data.bl_rna.properties[name].name if text is None else text)

    def prop_enum(self, data, name, value, text=None, **_options):
        self.prop(data, name, text="")
        items = data.bl_rna.properties[name].enum_items
        self._note(items[value].name if text is None else text)

    def prop_search(self, data, name, where, collection, text=None, **_options):
        self.prop(data, name, text)
        getattr(where, collection)

    def operator(self, name, text=None, **_options):
        module, function = name.split(".")
        rna = getattr(getattr(bpy.ops, module), function).get_rna_type()
        self._note(rna.name if text is None else text)
        return types.SimpleNamespace()

    def label(self, text="", **_options):
        self._note(text)

    def menu(self, name, **_options):
        getattr(bpy.types, name)

    def popover(self, panel, **_options):
        getattr(bpy.types, panel)

    def separator(self, **_options):
        pass

    def __getattr__(self, name):
        """Templates, and what a layout can be asked for."""
        if name in PROPERTY_TEMPLATES:
            return lambda data, prop, **options: self.prop(data, prop, text="")
        if name not in bpy.types.UILayout.bl_rna.functions:
            raise AttributeError(f"UILayout has no '{name}'")
        return lambda *_arguments, **_options: None


def draw(panel, context):
    """Call everything of a panel class that draws; returns the words that it shows."""
    bases = tuple(base for base in panel.__bases__ if base not in BLENDERS)
    own = {name: value for name, value in vars(panel).items()
           if name not in ("__dict__", "__weakref__", "bl_rna", "__slots__")}
    made = type(panel.__name__, bases, own)()
    made.layout = Layout()
    made.bl_idname = panel.__name__
    for name in ("draw_header", "draw_header_preset", "draw"):
        if hasattr(made, name):
            getattr(made, name)(context)
    return made.layout.texts
