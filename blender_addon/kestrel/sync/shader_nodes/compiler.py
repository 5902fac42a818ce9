# SPDX-License-Identifier: GPL-3.0-or-later
"""Walks a material's node tree and makes a program of it.

What each node does stands in the other files here, one for each family, as functions of a Site, by
the nodes' types. A node that is unknown leaves the sockets that it feeds their own values.
"""

import contextlib
import sys

from .. import nodes
from ..program import Builder
from . import color, converter, inputs, shaders, textures, vector
from .closure import Closure
from .site import Site

HERE, BESIDE_X, BESIDE_Y = "HERE", "BESIDE_X", "BESIDE_Y"
PLACES = (HERE, BESIDE_X, BESIDE_Y)
VALUES = {**inputs.VALUES, **textures.VALUES, **color.VALUES, **vector.VALUES, **converter.VALUES}
RECURSION_LIMIT = 20000  # Python's; a chain of nodes takes several calls each
CONVERSIONS = {"VALUE": "number", "INT": "number", "BOOLEAN": "number", "RGBA": "color",
               "VECTOR": "vector", "ROTATION": "vector"}


class Compiler:
    """One material's program in the making. `report` takes nodes.Notes."""

    def __init__(self, owner, report, environment_ior, table):
        self.builder = Builder(table)
        self.reader = nodes.Reader(owner, report)
        self.environment_ior = environment_ior
        self.place = HERE  # where values are wanted: here, or a bump's step beside
        self.tangent_map = None  # UV map along which normal maps lie
        self.shading_normal = self.input("NORMAL")  # where a shader's Normal has no link
        self._made = {}
        self._open = set()

    # ---- sources ----

    def source(self, socket, stack):
        """As nodes.Reader.source(); a reroute that nothing feeds leaves the socket its own value."""
        node, origin, above = self.reader.source(socket, stack)
        if node is None and origin.node.type == "REROUTE":
            return None, socket, stack
        return node, origin, above

    def _once(self, kind, node, output, stack, make):
        """make(), once for each output of a node in its group. None where the node depends on
        itself."""
        key = (kind, node.as_pointer(), output.identifier,
               tuple(group.as_pointer() for group in stack), self.place, self.shading_normal)
        if key in self._made:
            return self._made[key]
        if key in self._open or len(self._open) > nodes.MAX_CHAIN:
            self.reader.note(node, stack, "the links to it form a cycle, or a chain that is too "
                                          "long; the socket that it feeds keeps its own value")
            return None
        self._open.add(key)
        self._made[key] = make()
        self._open.discard(key)
        return self._made[key]

    # ---- values ----

    def value(self, socket, stack):
        """What a socket gets, of the socket's own type."""
        node, origin, above = self.source(socket, stack)
        if node is None:
            return self.converted(self.own_value(origin), origin.type, socket.type)
        made = self._once("value", node, origin, above,
                          lambda: self._output(node, origin, above))
        if made is None:
            return self.own_value(socket)
        return self.converted(made, origin.type, socket.type)

    def _output(self, node, output, stack):
        make = VALUES.get(node.type)
        site = Site(self, node, stack, output)
        if make is None:
            site.note("the sockets that it feeds keep their own values")
            return None
        return make(site)

    def own_value(self, socket):
        value = getattr(socket, "default_value", 0.0)
        if hasattr(value, "__len__") and not isinstance(value, str):
            return self.builder.constant(*value[:3])
        return self.builder.constant(0.0 if isinstance(value, str) else float(value))

    def converted(self, value, from_type, to_type):
        """As Blender converts between sockets of different types."""
        before, after = CONVERSIONS.get(from_type), CONVERSIONS.get(to_type)
        if after == "number" and before == "color":
            return self.builder.luminance(value)
        if after == "number" and before == "vector":
            return self.builder.average(value)
        return value

    def input(self, what):
        """What the point itself says: a mode of the instruction `input`."""
        data = PLACES.index(self.place) if what in ("POSITION", "OBJECT", "GENERATED") else 0
        return self.builder.op("input", modes=(what,), data=data)

    def attribute(self, kind, name):
        """What the mesh brings: "uv" or "color", by name; no name: what rendering uses."""
        return self.builder.op("attribute", modes=(self.place,),
                               data=self.builder.attribute((kind, name)))

    def at_places(self, socket, stack):
        """A number here and a bump's steps beside: three values."""
        place, values = self.place, []
        for self.place in PLACES:
            values.append(self.value(socket, stack))
        self.place = place
        return values

    def bumped(self, socket, stack, normal, strength=1.0, distance=1.0, inverted=False):
        """A normal, bent by the height that a socket gets."""
        heights = self.at_places(socket, stack)
        if heights[0] is heights[1] is heights[2]:
            return normal
        return self.builder.op("bump", *heights, normal, strength, distance,
                               modes=("YES" if inverted else "NO",))

    def use_tangent_map(self, site, name):
        """Note the UV map of a normal map; the material has one for all."""
        if self.tangent_map not in (None, name):
            site.note(f"it lies along the UV map '{self.tangent_map}' as the other normal maps do")
        else:
            self.tangent_map = name

    # ---- surfaces ----

    def closure(self, socket, stack=()):
        node, origin, above = self.source(socket, stack)
        if node is None:
            return Closure(self.builder)
        made = self._once("closure", node, origin, above, lambda: self._surface(
            Site(self, node, above, origin)))
        return made or Closure(self.builder)

    @staticmethod
    def _surface(site):
        make = shaders.CLOSURES.get(site.node.type)
        if make is not None:
            return make(site)
        if site.node.type in VALUES:  # a colour where a shader is wanted shines
            return shaders.glow(site, site.c.converted(
                VALUES[site.node.type](site), site.output.type, "RGBA"))
        return shaders.substitute(site)


@contextlib.contextmanager
def deep_calls():
    limit = sys.getrecursionlimit()
    sys.setrecursionlimit(max(limit, RECURSION_LIMIT))
    try:
        yield
    finally:
        sys.setrecursionlimit(limit)


def compile_material(material, report, environment_ior, table):
    """(Program, UV map of its normal maps or None) of a material with nodes. `report` takes
    nodes.Notes of what is not done as Blender does it. The program's textures are nodes.Textures,
    its attributes ("uv" or "color", name). Raises program.TooComplex."""
    with deep_calls():
        compiler = Compiler(f"Material '{material.name}'", report, environment_ior, table)
        output = nodes.output_node(material.node_tree, "OUTPUT_MATERIAL")
        if output is None:
            return compiler.builder.program(Closure(compiler.builder).outputs()), None
        vector.displace(compiler, output, material)
        if output.inputs["Volume"].is_linked:
            compiler.reader.note(output, (), "its volume is left out")
        closure = compiler.closure(output.inputs["Surface"])
        return compiler.builder.program(closure.outputs()), compiler.tangent_map
