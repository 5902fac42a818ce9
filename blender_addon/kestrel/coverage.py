# SPDX-License-Identifier: GPL-3.0-or-later
"""Node coverage: what Kestrel does not draw as the nodes of a file's materials say, told without
rendering. As a panel of the Render tab, and on the command line:

    blender -b FILE.blend --addons kestrel --python-expr "import kestrel; kestrel.print_node_coverage()"
    blender -b FILE.blend --command kestrel_node_coverage          from Blender 4.2 on
"""

import bpy
from bpy.props import BoolProperty, CollectionProperty, IntProperty, PointerProperty, StringProperty

from .native import capi
from .sync.image import shortcomings
from .sync.material import read_material
from .sync.nodes import Note
from .sync.surface import Surface

COMMAND = "kestrel_node_coverage"


def material_coverage(material):
    """[nodes.Note, ...] of one material, each once. Raises KestrelError where there is no library."""
    notes = []
    read = read_material(material, 1.0, notes.append)
    textures = read.textures() if isinstance(read, Surface) else read[0].textures
    owner = f"Material '{material.name}'"
    for image in dict.fromkeys(texture.image for texture in textures if texture.image):
        notes += [Note(owner, image.name, "Image", text) for text in shortcomings(image)]
    return list(dict.fromkeys(notes))


def node_coverage(materials=None):
    """[(material's name, nodes.Note), ...] of these materials; None: all of the file's that something
    uses."""
    if materials is None:
        materials = [material for material in bpy.data.materials
                     if material.users and not material.grease_pencil]
    return [(material.name, note) for material in materials
            for note in material_coverage(material)]


def coverage_text(found):
    """The lines of what node_coverage() gives."""
    lines = [f"{material}: {note.node} ({note.kind}): {note.instead}" for material, note in found]
    return "\n".join(lines or ["Kestrel draws all nodes of the materials in use as Blender does."])


def print_node_coverage():
    """Print the coverage of the open file."""
    print(coverage_text(node_coverage()))


def _command(_arguments):
    print_node_coverage()
    return 0


# ---- interface -------------------------------------------------------------------------------

class KestrelCoverageItem(bpy.types.PropertyGroup):
    __annotations__ = {"material": StringProperty(), "text": StringProperty()}


class KestrelCoverage(bpy.types.PropertyGroup):
    """What the panel shows: the result of the last check."""
    __annotations__ = {"items": CollectionProperty(type=KestrelCoverageItem),
                       "active": IntProperty(name="Selected Line"),
                       "checked": BoolProperty()}

    def fill(self, found):
        self.items.clear()
        for material, note in found:
            item = self.items.add()
            item.name = f"{material}: {note.node}"
            item.material, item.text = material, str(note)
        self.active, self.checked = 0, True

    def selected(self):
        """The item that is selected in the list, or None."""
        return self.items[self.active] if 0 <= self.active < len(self.items) else None


class KESTREL_OT_check_materials(bpy.types.Operator):
    bl_idname = "kestrel.check_materials"
    bl_label = "Check Materials"
    bl_description = ("List the nodes of all materials in use that Kestrel does not draw as Blender "
                      "does, and what it does instead. Nothing is rendered")

    def execute(self, context):
        try:
            found = node_coverage()
        except capi.KestrelError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        context.window_manager.kestrel_coverage.fill(found)
        self.report({"INFO"}, f"{len(found)} notes on materials")
        return {"FINISHED"}


class KESTREL_OT_copy_node_coverage(bpy.types.Operator):
    bl_idname = "kestrel.copy_node_coverage"
    bl_label = "Copy Node Coverage"
    bl_description = "Copy the list to the clipboard, a line for each node"

    def execute(self, context):
        items = context.window_manager.kestrel_coverage.items
        context.window_manager.clipboard = "\n".join(item.text for item in items)
        return {"FINISHED"}


class KESTREL_OT_select_material(bpy.types.Operator):
    bl_idname = "kestrel.select_material"
    bl_label = "Select Material"
    bl_description = ("Select the objects of the material in the selected line, and make it the "
                      "active material")
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return context.window_manager.kestrel_coverage.selected() is not None

    def execute(self, context):
        name = context.window_manager.kestrel_coverage.selected().material
        found = [obj for obj in context.view_layer.objects if obj.visible_get()
                 and any(slot.name == name for slot in obj.material_slots)]
        if not found:
            self.report({"WARNING"}, f"No visible object has the material '{name}'.")
            return {"CANCELLED"}
        for obj in context.view_layer.objects:
            obj.select_set(obj in found)
        active = context.view_layer.objects.active = found[0]
        active.active_material_index = active.material_slots.find(name)
        return {"FINISHED"}


OPERATORS = (KESTREL_OT_check_materials, KESTREL_OT_copy_node_coverage, KESTREL_OT_select_material)
CLASSES = (KestrelCoverageItem, KestrelCoverage, *OPERATORS)

_commands = []


def register():
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.WindowManager.kestrel_coverage = PointerProperty(type=KestrelCoverage,
                                                               options={"SKIP_SAVE"})
    if hasattr(bpy.utils, "register_cli_command"):  # 4.2 on
        _commands.append(bpy.utils.register_cli_command(COMMAND, _command))


def unregister():
    while _commands:
        bpy.utils.unregister_cli_command(_commands.pop())
    del bpy.types.WindowManager.kestrel_coverage
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
