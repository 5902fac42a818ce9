# SPDX-License-Identifier: GPL-3.0-or-later
"""A node that is being compiled."""

from ... import compat


class Site:
    """One output of a node, within the groups `stack`; `c` is the Compiler, `b` its Builder."""

    def __init__(self, compiler, node, stack, output):
        self.c = compiler
        self.b = compiler.builder
        self.node = node
        self.stack = stack
        self.output = output

    def socket(self, *names):
        """The first of these inputs that the node has in this version, or None. Numbers are places;
        where several sockets share a name, identifiers tell them apart."""
        if isinstance(names[0], int):
            return self.node.inputs[names[0]]
        found = next((s for name in names for s in self.node.inputs if s.identifier == name), None)
        return found or compat.node_input(self.node, *names)

    def value(self, *names, default=0.0):
        """What an input gets; `default`, a number or a Value, where the node has no such input."""
        socket = self.socket(*names)
        if socket is not None:
            return self.c.value(socket, self.stack)
        return self.b.constant(default) if isinstance(default, (int, float)) else default

    def is_linked(self, *names):
        """Whether an input gets anything but the node's own value."""
        socket = self.socket(*names)
        if socket is None:
            return False
        node, origin, _ = self.c.source(socket, self.stack)
        return node is not None or origin != socket

    def vector(self, default):
        """The input Vector, or default() where nothing is linked to it."""
        return self.value("Vector") if self.is_linked("Vector") else default()

    def normal(self, name="Normal"):
        """The input of that name, or the normal that shaders have."""
        if self.is_linked(name):
            return self.b.op("vector_math", self.value(name), 0.0, 0.0, 1.0, modes=("NORMALIZE",))
        return self.c.shading_normal

    def generated(self):
        return self.c.input("GENERATED")

    def uv(self):
        return self.c.attribute("uv", "")

    def note(self, instead):
        """Report that this node is not done as Blender does it."""
        self.c.reader.note(self.node, self.stack, instead)
