# SPDX-License-Identifier: GPL-3.0-or-later
"""What Kestrel's panels share."""

import textwrap

from .. import compat
from ..native import loader

ENGINE = "KESTREL"
TEXT_WIDTH = 60  # characters of a wrapped message


def draw_text(layout, text):
    """A message of several lines."""
    column = layout.column(align=True)
    for index, line in enumerate(textwrap.wrap(text, TEXT_WIDTH)):
        column.label(text=line, icon="ERROR" if index == 0 else "BLANK1")


def draw_library_error(layout):
    """Why nothing can be rendered, and what to do."""
    draw_text(layout, loader.error())


def draw_use_nodes(layout, datablock):
    """The switch between nodes and plain settings, in the versions that have a choice."""
    if compat.chooses_nodes(datablock):
        layout.prop(datablock, "use_nodes", icon="NODETREE")


def draw_node_input(layout, tree, output_type, input_name):
    """The node that feeds the output, as a tree of its inputs."""
    output = tree.get_output_node("CYCLES") if output_type is None else next(
        (node for node in tree.nodes if node.type == output_type and node.is_active_output), None)
    if output is None:
        layout.label(text="No output node", icon="INFO")
        return
    layout.template_node_view(tree, output, output.inputs[input_name])


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
    """A panel of rows of the parameter table, `names`, of what owner() gives. Those that leave
    nothing to choose are not shown."""
    names = ()
    texts = {}  # name: another text than the property's own

    @staticmethod
    def owner(context):
        return context.scene

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = self.bl_context == "object"
        self.draw_rows(layout.column(), context, self.names)

    def draw_rows(self, layout, context, names):
        settings = self.owner(context).kestrel
        for name in names:
            if offers_choice(settings.bl_rna.properties[name]):
                text = self.texts.get(name)
                layout.prop(settings, name, **({} if text is None else {"text": text}))


def offers_choice(prop):
    """Whether a property has more than one value, not counting that Kestrel chooses it itself."""
    return prop.type != "ENUM" or len({item.identifier for item in prop.enum_items} - {"auto"}) > 1
