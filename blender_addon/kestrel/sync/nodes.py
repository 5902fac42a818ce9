# SPDX-License-Identifier: GPL-3.0-or-later
"""Reading node trees: what feeds a socket, as a constant colour times at most one image and at most
one colour attribute of the mesh.

Reroutes, muted nodes and groups are seen through. A node that cannot be followed is reported; then
the first image found upstream stands in for it, else the socket's own value.
"""

from dataclasses import dataclass, replace

from ..native import capi

MAX_CHAIN = 256  # nodes between a socket and its source; longer ones are taken for cycles
WHITE = (1.0, 1.0, 1.0)
BLACK = (0.0, 0.0, 0.0)
EXTENSIONS = {"REPEAT": capi.EXTENSION_REPEAT, "EXTEND": capi.EXTENSION_CLAMP,
              "CLIP": capi.EXTENSION_CLIP}


@dataclass(frozen=True)
class Note:
    """What is done instead of what a node says."""
    owner: str    # "Material 'Wood'"
    node: str     # its label or name, after those of the groups that it is in
    kind: str     # "Noise Texture"
    instead: str

    def __str__(self):
        return (f"{self.owner}: node '{self.node}' ({self.kind}) is not fully supported; "
                f"{self.instead}.")


@dataclass(frozen=True)
class Mask:
    """What gives a texture its alpha in place of its own image's."""
    image: object
    from_alpha: bool  # the image's alpha, else its brightness
    inverted: bool    # opaque where it is 0


@dataclass(frozen=True)
class Texture:
    """An image as one node samples it; uv' = offset + uv * tiling."""
    image: object  # None: white, with a mask
    nearest: bool = False
    extension: int = capi.EXTENSION_REPEAT
    tiling: tuple = (1.0, 1.0)
    offset: tuple = (0.0, 0.0)
    mask: Mask = None
    uv_map: str = ""  # empty: the one that rendering uses


@dataclass(frozen=True)
class Value:
    """A colour times the texture's colour times the mesh's."""
    color: tuple = BLACK
    texture: Texture = None
    attribute: str = None  # name of a colour attribute; empty: the one that rendering uses

    @property
    def varies(self):
        return self.texture is not None or self.attribute is not None

    def scaled(self, factor):
        """Times a number or a colour; black has no texture and no attribute."""
        factors = factor if isinstance(factor, tuple) else (factor,) * 3
        color = tuple(c * f for c, f in zip(self.color, factors))
        return replace(self, color=color) if any(color) else Value()

    def times(self, other):
        """The product, or None where it has two textures or two attributes."""
        if (self.texture and other.texture) or (
                self.attribute is not None and other.attribute is not None):
            return None
        attribute = other.attribute if self.attribute is None else self.attribute
        return Value(WHITE, self.texture or other.texture, attribute).scaled(
            tuple(a * b for a, b in zip(self.color, other.color)))

def constant(value):
    """A socket's own value as a colour; numbers become grey."""
    if hasattr(value, "__len__"):
        return tuple(float(channel) for channel in value[:3])
    return (float(value),) * 3


def output_node(tree, kind):
    """The active output of this type; Cycles' is preferred to one for everyone."""
    nodes = [node for node in tree.nodes if node.type == kind and node.is_active_output]
    nodes = nodes or [node for node in tree.nodes if node.type == kind]
    rank = {"CYCLES": 0, "ALL": 1}
    return min(nodes, key=lambda node: rank.get(getattr(node, "target", "ALL"), 2), default=None)


def followed_objects(tree, seen=()):
    """The objects whose places a node tree's coordinates follow; evaluated, as the tree is."""
    found = []
    for node in tree.nodes:
        if node.type == "TEX_COORD" and node.object is not None:
            found.append(node.object)
        elif node.type == "GROUP" and node.node_tree is not None and node.node_tree not in seen:
            found += followed_objects(node.node_tree, (*seen, node.node_tree))
    return found


def socket_key(socket, stack):
    """What tells a socket, or a node, within its groups from all others."""
    return (socket.as_pointer(), *(group.as_pointer() for group in stack))


def by_identifier(sockets, socket):
    return next((s for s in sockets if s.identifier == socket.identifier), None)


class Reader:
    """Follows the links of one datablock's node tree. `owner` names it in messages; `report` takes
    Notes."""

    def __init__(self, owner, report):
        self.owner = owner
        self._report = report
        self._colors = {}  # what color() found, by socket

    def note(self, node, stack, instead):
        """Report a node of the groups `stack`."""
        path = " / ".join(item.label or item.name for item in (*stack, node))
        self._report(Note(self.owner, path, node.bl_label, instead))

    def unsupported(self, node, instead):
        self.note(node, (), instead)

    def source(self, socket, stack=()):
        """(node, its output, group stack) that feeds an input, or (None, socket, stack) where an
        own value does: `socket` is then the one that holds it."""
        for _ in range(MAX_CHAIN):
            link = next((l for l in socket.links if l.is_valid and not l.is_muted), None)
            if link is None:
                return None, socket, stack
            node, output = link.from_node, link.from_socket
            if node.type == "REROUTE":
                socket = node.inputs[0]
            elif node.mute:
                inner = next((l for l in node.internal_links if l.to_socket == output), None)
                if inner is None:
                    return None, socket, stack
                socket = inner.from_socket
            elif node.type == "GROUP" and node.node_tree is not None:
                result = output_node(node.node_tree, "GROUP_OUTPUT")
                inside = by_identifier(result.inputs, output) if result else None
                if inside is None:
                    return None, socket, stack
                socket, stack = inside, stack + (node,)
            elif node.type == "GROUP_INPUT" and stack:
                outside = by_identifier(stack[-1].inputs, output)
                if outside is None:
                    return None, socket, stack
                socket, stack = outside, stack[:-1]
            else:
                return node, output, stack
        self.note(socket.node, stack, f"the links to it form a cycle; '{socket.name}' keeps its own "
                                      "value")
        return None, socket, stack

    def first_image(self, node, stack):
        """The first image texture upstream of a node, or None."""
        seen, waiting = set(), [(node, stack)]
        while waiting:
            node, stack = waiting.pop()
            key = socket_key(node, stack)
            if key in seen:
                continue
            seen.add(key)
            if node.type == "TEX_IMAGE" and node.image is not None:
                return self.texture(node, stack)
            sources = [self.source(socket, stack) for socket in node.inputs]
            waiting += [(above, above_stack) for above, _, above_stack in reversed(sources)
                        if above is not None]
        return None

    # ---- values ----

    def number(self, socket, stack=()):
        """A number: a Value node or the socket's own; anything else is reported."""
        node, origin, _ = self.source(socket, stack)
        if node is None:
            return sum(constant(origin.default_value)) / 3.0
        if node.type in ("VALUE", "RGB"):
            return sum(constant(node.outputs[0].default_value)) / 3.0
        own = sum(constant(socket.default_value)) / 3.0
        self.unsupported(node, f"'{socket.name}' is {own:.3g} everywhere")
        return own

    def color(self, socket, stack=()):
        """A Value for a colour (or grey) input."""
        key = socket_key(socket, stack)
        if key not in self._colors:
            self._colors[key] = self._read_color(socket, stack)
        return self._colors[key]

    def _read_color(self, socket, stack):
        node, origin, above = self.source(socket, stack)
        if node is None:
            return Value(constant(origin.default_value))
        if node.type in ("RGB", "VALUE"):
            return Value(constant(node.outputs[0].default_value))
        if node.type == "TEX_IMAGE" and origin.name == "Color":
            return Value(WHITE, self.texture(node, above)) if node.image else Value(BLACK)
        attribute = color_attribute(node, origin)
        if attribute is not None:
            return Value(WHITE, attribute=attribute)
        if node.type in ("MIX_RGB", "MIX"):
            mixed = self._mixed_color(node, above)
            if mixed is not None:
                return mixed
        return self._stand_in(socket, node, above)

    def _stand_in(self, socket, node, stack):
        texture = self.first_image(node, stack)
        if texture is not None:
            self.unsupported(node, f"the image '{texture.image.name}' is used as it is")
            return Value(WHITE, texture)
        own = constant(socket.default_value)
        self.unsupported(node, "the colour ({:.3g}, {:.3g}, {:.3g}) is used instead".format(*own))
        return Value(own)

    def _mixed_color(self, node, stack):
        """Mix and Multiply where the result is one colour times one image, else None."""
        if node.type == "MIX" and node.data_type != "RGBA":
            return None
        enabled = [socket for socket in node.inputs if socket.enabled]
        if len(enabled) != 3 or node.blend_type not in ("MIX", "MULTIPLY"):
            return None
        factor_node, factor_socket, _ = self.source(enabled[0], stack)
        if factor_node is not None and factor_node.type != "VALUE":
            return None
        holder = factor_socket if factor_node is None else factor_node.outputs[0]
        factor = min(max(constant(holder.default_value)[0], 0.0), 1.0)
        a, b = (self.color(socket, stack) for socket in enabled[1:])
        if node.blend_type == "MIX":
            return sum_values(a.scaled(1.0 - factor), b.scaled(factor))
        if not b.varies:
            return a.scaled(tuple(1.0 - factor + factor * c for c in b.color))
        return a.times(b) if factor == 1.0 else None

    # ---- images ----

    def texture(self, node, stack):
        """How an Image Texture node samples its image."""
        if node.projection != "FLAT":
            self.unsupported(node, "its image is projected flat by the UV map")
        extension = EXTENSIONS.get(node.extension)
        if extension is None:
            self.unsupported(node, "its image repeats instead of being mirrored")
            extension = capi.EXTENSION_REPEAT
        tiling, offset, uv_map = self._mapping(node.inputs["Vector"], stack)
        return Texture(node.image, node.interpolation == "Closest", extension, tiling, offset,
                       uv_map=uv_map)

    def _mapping(self, socket, stack):
        """Tiling and offset of the UV map that a vector input describes, and its name."""
        node, origin, above = self.source(socket, stack)
        if node is None:
            return (1.0, 1.0), (0.0, 0.0), ""
        if node.type == "MAPPING":
            return self._mapping_node(node, above)
        if node.type == "TEX_COORD" and origin.name == "UV":
            return (1.0, 1.0), (0.0, 0.0), ""
        if node.type == "UVMAP" and not node.from_instancer:
            return (1.0, 1.0), (0.0, 0.0), node.uv_map
        if node.type == "ATTRIBUTE" and origin.name in ("Color", "Vector") and (
                node.attribute_type == "GEOMETRY" and node.attribute_name):
            return (1.0, 1.0), (0.0, 0.0), node.attribute_name
        self.unsupported(node, "the UV map is used instead")
        return (1.0, 1.0), (0.0, 0.0), ""

    def _mapping_node(self, node, stack):
        tiling, offset, uv_map = self._mapping(node.inputs["Vector"], stack)
        scale = [self._vector(node, "Scale", stack)[i] for i in range(2)]
        place = [0.0, 0.0]
        if node.vector_type in ("POINT", "TEXTURE"):
            place = [self._vector(node, "Location", stack)[i] for i in range(2)]
        if any(abs(angle) > 1e-6 for angle in self._vector(node, "Rotation", stack)):
            self.unsupported(node, "its rotation is left out")
        if node.vector_type == "TEXTURE":  # the inverse: (uv - location) / scale
            scale = [1.0 / s if s else 0.0 for s in scale]
            place = [-p * s for p, s in zip(place, scale)]
        return (tuple(t * s for t, s in zip(tiling, scale)),
                tuple(o * s + p for o, s, p in zip(offset, scale, place)), uv_map)

    def _vector(self, node, name, stack):
        socket = node.inputs.get(name)
        if socket is None:  # the socket is hidden for this kind of vector
            return (1.0, 1.0, 1.0) if name == "Scale" else BLACK
        above, origin, _ = self.source(socket, stack)
        if above is not None:
            self.unsupported(above, f"'{name}' of '{node.name}' keeps its own value")
            origin = socket
        return constant(origin.default_value)


def color_attribute(node, output):
    """Name of the mesh's colour attribute that a node's output brings, or None."""
    if node.type == "VERTEX_COLOR" and output.name == "Color":
        return node.layer_name
    if node.type == "ATTRIBUTE" and output.name in ("Color", "Vector", "Fac") and (
            node.attribute_type == "GEOMETRY" and node.attribute_name):
        return node.attribute_name
    return None


def sum_values(a, b):
    """a + b, or None where they vary differently."""
    if a.texture == b.texture and a.attribute == b.attribute:
        return replace(a, color=tuple(x + y for x, y in zip(a.color, b.color)))
    if not any(a.color):
        return b
    return None if any(b.color) else a
