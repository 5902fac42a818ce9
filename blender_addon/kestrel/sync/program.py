# SPDX-License-Identifier: GPL-3.0-or-later
"""Assembles node programs: values that depend on each other, then instructions over registers.

A Value is a constant or what one instruction gives, four floats. Numbers stand in x, y and z, with
w = 1; colours and vectors in x, y and z; an image's alpha in w. Equal values are one and the same,
arithmetic of constants is done at once. Only what the outputs need becomes instructions.
"""

import heapq
import math
import struct
from collections import Counter
from dataclasses import dataclass

import numpy as np

UNSET = -2 ** 31  # KESTREL_NODE_UNSET
MAX_INSTRUCTIONS = 65536
OPERANDS = 8
MAX_COST = 2 ** 30
FLOAT32 = struct.Struct("f")


class TooComplex(Exception):
    """The program would need more registers or instructions than there are."""


@dataclass(frozen=True)
class Program:
    instructions: np.ndarray  # int32 (N, 12): op, mode, result, data, operands
    constants: np.ndarray     # float32 (C, 4)
    textures: tuple           # whatever Builder.texture() was given
    attributes: tuple         # whatever Builder.attribute() was given
    outputs: tuple            # operands in the order of the table's outputs
    names: tuple              # of the outputs

    def constant_output(self, name):
        """(x, y, z) of an output that is the same everywhere, else None."""
        operand = self.outputs[self.names.index(name)]
        if operand == UNSET or operand >= 0:
            return None
        return tuple(map(float, self.constants[-1 - operand, :3]))


class Value:
    """One value of a Builder. `constant`: its four floats, or None."""
    __slots__ = ("number", "constant", "op", "mode", "data", "operands", "scalar", "need", "cost")

    def __init__(self, number, constant=None, op=None, mode=0, data=0, operands=(), scalar=False):
        self.number = number
        self.constant = constant
        self.op, self.mode, self.data, self.operands = op, mode, data, operands
        self.scalar = scalar  # whether x, y and z are surely the same
        computed = sorted((o.need for o in self.inputs()), reverse=True)
        # Registers and instructions that it takes where nothing is shared.
        self.need = max([1] + [need + index for index, need in enumerate(computed)])
        self.cost = min(1 + sum(o.cost for o in self.inputs()), MAX_COST)

    def inputs(self):
        """The operands that are no constants, each once, in order."""
        return [o for o in dict.fromkeys(self.operands) if o.constant is None]

    def is_all(self, number):
        """Whether it is a constant with this in x, y and z."""
        return self.constant is not None and self.constant[:3] == (number,) * 3


def _finite(value):
    """As float32 has it; 0 for what is not finite."""
    try:
        number = FLOAT32.unpack(FLOAT32.pack(value))[0]
    except OverflowError:
        return 0.0
    return number if math.isfinite(number) else 0.0


# By component; None where the library's own rules for special cases had to be repeated.
ARITHMETIC = {
    "ADD": lambda a, b: a + b,
    "SUBTRACT": lambda a, b: a - b,
    "MULTIPLY": lambda a, b: a * b,
    "DIVIDE": lambda a, b: a / b if b else 0.0,
    "MINIMUM": min,
    "MAXIMUM": max,
    "LESS_THAN": lambda a, b: float(a < b),
    "GREATER_THAN": lambda a, b: float(a > b),
}
SCALAR_OPS = {"math", "component", "scalar", "fresnel", "layer_weight"}
BY_COMPONENT = {"ADD", "SUBTRACT", "MULTIPLY", "DIVIDE", "MINIMUM", "MAXIMUM"}


class Builder:
    """Makes values of one program. `table`: the library's table of instructions, from its JSON."""

    def __init__(self, table):
        self.table = table
        self._ops = {op["name"]: (number, op) for number, op in enumerate(table["ops"])}
        self._values = {}
        self._numbers = {}  # constants that are asked for often
        self._textures = {}
        self._attributes = {}

    # ---- values ----

    def constant(self, x, y=None, z=None, w=1.0):
        """A number, or a vector or colour of three."""
        if y is None:
            if x not in self._numbers:
                self._numbers[x] = self.constant(x, x, x)
            return self._numbers[x]
        return self._known(tuple(_finite(c) for c in (x, y, z, w)))

    def _known(self, four):
        return self._shared(("constant", *four), lambda number: Value(
            number, constant=four, scalar=four[0] == four[1] == four[2]))

    def _shared(self, key, make):
        if key not in self._values:
            self._values[key] = make(len(self._values))
        return self._values[key]

    def texture(self, item):
        """Number of a texture, any hashable thing."""
        return self._textures.setdefault(item, len(self._textures))

    def attribute(self, item):
        """Number of an attribute of the mesh, any hashable thing."""
        return self._attributes.setdefault(item, len(self._attributes))

    def op(self, name, *operands, modes=(), data=0):
        """What an instruction gives. Operands are Values or numbers, modes names. `data`: a number,
        or for those that read constants a tuple of constants of four floats."""
        number, op = self._ops[name]
        operands = tuple(o if isinstance(o, Value) else self.constant(o) for o in operands)
        if len(operands) != len(op["operands"]):
            raise ValueError(f"{name} has the operands {op['operands']}")
        mode = self._mode(name, op, modes)
        found = self._simplified(name, modes, operands)
        if found is not None:
            return found
        scalar = name in SCALAR_OPS or (
            (name == "mix" or (name == "vector_math" and modes[0] in BY_COMPONENT))
            and all(o.scalar for o in operands))
        key = (number, mode, data, *(o.number for o in operands))
        return self._shared(key, lambda at: Value(at, None, number, mode, data, operands, scalar))

    @staticmethod
    def _mode(name, op, modes):
        if len(modes) != len(op["modes"]):
            raise ValueError(f"{name} has the modes {op['modes']}")
        mode, factor = 0, 1
        for choice, digit in zip(modes, op["modes"]):
            if choice not in digit:
                raise ValueError(f"{name} has no mode {choice}: {digit}")
            mode += factor * digit.index(choice)
            factor *= len(digit)
        return mode

    def has_mode(self, name, digit, choice):
        """Whether an instruction knows this mode."""
        return choice in self._ops[name][1]["modes"][digit]

    # ---- simplification ----

    def _simplified(self, name, modes, operands):
        """A value without a new instruction, or None."""
        if name in ("math", "vector_math"):
            if name == "math" and modes[1] == "YES":
                return None
            return self._arithmetic(name, modes[0], operands)
        if name == "mix":
            return self._mixed(modes[0] == "YES", *operands)
        if any(o.constant is None for o in operands):
            return operands[0] if name == "scalar" and operands[0].scalar else None
        if name == "component":
            return self.constant(operands[0].constant["XYZ".find(modes[0])])
        if name == "scalar":
            weights = (0.2126, 0.7152, 0.0722) if modes[0] == "LUMINANCE" else (1 / 3,) * 3
            x, y, z = operands[0].constant[:3]
            return self.constant(x if x == y == z else sum(
                w * c for w, c in zip(weights, (x, y, z))))
        if name == "combine":
            return self.constant(*(o.constant[0] for o in operands))
        return None

    def _arithmetic(self, name, operation, operands):
        a, b = operands[:2]
        if operation == "SCALE":  # the same as MULTIPLY
            operation, b = "MULTIPLY", operands[3]
        if operation in ARITHMETIC and not (
                name == "vector_math" and operation not in BY_COMPONENT):
            if a.constant and b.constant:
                return self._folded(name, ARITHMETIC[operation], a.constant, b.constant)
            return self._neutral(name, operation, a, b)
        return None

    def _folded(self, name, function, a, b):
        count = 1 if name == "math" else 3
        try:
            values = [function(x, y) for x, y in zip(a[:count], b[:count])]
        except OverflowError:
            return None
        if not all(abs(value) < 3e38 for value in values):
            return None
        return self.constant(*values)

    def _neutral(self, name, operation, a, b):
        """What a 0 or 1 leaves of an operation."""
        def whole(value):
            return value if name == "vector_math" or value.scalar else None
        if operation == "MULTIPLY":
            if a.is_all(0.0) or b.is_all(0.0):
                return self.constant(0.0)
            if a.is_all(1.0):
                return whole(b)
        if operation == "ADD" and a.is_all(0.0):
            return whole(b)
        if (operation in ("ADD", "SUBTRACT") and b.is_all(0.0)) or (
                operation in ("MULTIPLY", "DIVIDE") and b.is_all(1.0)):
            return whole(a)
        if operation == "DIVIDE" and a.is_all(0.0):
            return self.constant(0.0)
        return None

    def _mixed(self, clamped, factor, a, b):
        if a is b or factor.is_all(0.0):
            return a
        if factor.is_all(1.0):
            return b
        if factor.constant and a.constant and b.constant:
            shares = factor.constant[:3]
            if clamped:
                shares = [min(max(share, 0.0), 1.0) for share in shares]
            return self.constant(*(x + (y - x) * share for share, x, y in zip(
                shares, a.constant, b.constant)))
        return None

    # ---- abbreviations: all by component, for numbers, vectors and colours ----

    def add(self, a, b):
        return self.vector_math("ADD", a, b)

    def subtract(self, a, b):
        return self.vector_math("SUBTRACT", a, b)

    def multiply(self, *values):
        product = values[0]
        for value in values[1:]:
            product = self.vector_math("MULTIPLY", product, value)
        return product

    def divide(self, a, b):
        """0 where b is 0."""
        return self.vector_math("DIVIDE", a, b)

    def clamp(self, value, low=0.0, high=1.0):
        return self.vector_math("MINIMUM", self.vector_math("MAXIMUM", value, low), high)

    def invert(self, value):
        return self.subtract(1.0, value)

    def mix(self, factor, a, b):
        """(1 - factor) a + factor b."""
        return self.op("mix", factor, a, b, modes=("NO",))

    def vector_math(self, operation, a, b=0.0, c=0.0, scale=1.0):
        return self.op("vector_math", a, b, c, scale, modes=(operation,))

    def math(self, operation, a, b=0.0, c=0.0, clamp=False):
        """Of numbers alone."""
        return self.op("math", a, b, c, modes=(operation, "YES" if clamp else "NO"))

    def component(self, value, which):
        return self.op("component", value, modes=(which,))

    def luminance(self, value):
        return self.op("scalar", value, modes=("LUMINANCE",))

    def average(self, value):
        return self.op("scalar", value, modes=("AVERAGE",))

    def combine(self, x, y, z):
        return self.op("combine", x, y, z)

    # ---- the program ----

    def program(self, outputs):
        """The Program that computes these: {name of an output: Value}. Raises TooComplex."""
        values = [outputs.get(name) for name in self.table["outputs"]]
        constants = _Constants()
        steps = _Registers(self.table["registers"]).schedule(
            [value for value in values if value is not None])
        used_textures, used_attributes = {}, {}

        def operand(value, register):
            return register if value.constant is None else -1 - constants.at((value.constant,))

        rows = []
        for value, result, registers in steps:
            data = value.data
            kind = self.table["ops"][value.op]["data"]
            if kind in ("table", "constant"):
                data = constants.at(data)
            elif kind == "texture":
                data = used_textures.setdefault(data, len(used_textures))
            elif kind == "attribute":
                data = used_attributes.setdefault(data, len(used_attributes))
            operands = [operand(o, registers.get(o)) for o in value.operands]
            rows.append([value.op, value.mode, result, data,
                         *operands, *[0] * (OPERANDS - len(operands))])
        places = steps.places
        outputs = tuple(UNSET if value is None else operand(value, places.get(value))
                        for value in values)
        return Program(
            np.array(rows, np.int32).reshape(-1, 4 + OPERANDS),
            np.array(constants.rows, np.float32).reshape(-1, 4),
            tuple(_chosen(self._textures, used_textures)),
            tuple(_chosen(self._attributes, used_attributes)), outputs,
            tuple(self.table["outputs"]))


def _chosen(items, used):
    items = list(items)
    return [items[index] for index in used]


class _Constants:
    """Blocks of constants one after the other, equal ones once."""

    def __init__(self):
        self.rows = []
        self._blocks = {}

    def at(self, block):
        """Number of the first constant of a tuple of them."""
        if block not in self._blocks:
            self._blocks[block] = len(self.rows)
            self.rows.extend(block)
        return self._blocks[block]


class _Steps(list):
    """[(Value, result, {operand: register}), ...] and where the outputs are in the end."""
    places = None


class _Registers:
    """Puts values in order and into registers. Where these do not suffice, the value that is the
    easiest to compute again is given up until it is needed. What needs most registers comes first
    (Sethi and Ullman), so the program's need, were nothing shared, always suffices."""

    def __init__(self, count):
        self._count = count
        self._free = list(range(count))
        self._at = {}          # Value: register
        self._pins = Counter()  # how many wait for it with what else they need
        self._left = Counter()  # how many instructions will still read it
        self._steps = _Steps()

    def schedule(self, outputs):
        outputs = [value for value in dict.fromkeys(outputs) if value.constant is None]
        for value in outputs:
            self._expect(value)
        self._gather(outputs)
        self._steps.places = dict(self._at)
        return self._steps

    def _expect(self, value):
        """One more instruction will read it. What is in no register must be computed for that."""
        self._left[value] += 1
        if self._left[value] == 1 and value not in self._at:
            for o in value.inputs():
                self._expect(o)

    def _gather(self, values):
        """All of these in registers, and pinned there."""
        for value in sorted(values, key=lambda v: (-v.need, v.number)):
            self._compute(value)
            self._pins[value] += 1

    def _compute(self, value):
        if value in self._at:
            return
        inputs = value.inputs()
        self._gather(inputs)
        registers = {o: self._at[o] for o in inputs}
        for o in inputs:
            self._pins[o] -= 1
            self._left[o] -= 1
            if self._left[o] <= 0 and not self._pins[o]:
                heapq.heappush(self._free, self._at.pop(o))
        self._at[value] = self._take()
        self._steps.append((value, self._at[value], registers))
        if len(self._steps) > MAX_INSTRUCTIONS:
            raise TooComplex("it takes too many instructions")

    def _take(self):
        if not self._free:
            given_up = min((v for v in self._at if not self._pins[v]), default=None,
                           key=lambda v: (v.cost, v.number))
            if given_up is None:
                raise TooComplex("it takes too many registers")
            heapq.heappush(self._free, self._at.pop(given_up))
            for o in given_up.inputs():
                self._expect(o)
        return heapq.heappop(self._free)
