# SPDX-License-Identifier: GPL-3.0-or-later
"""The assembler of node programs, its programs run by a literal interpreter."""

import unittest

import numpy as np
from kestrel.native import loader
from kestrel.sync.program import UNSET, Builder

# What `input` gives here, by its mode.
INPUTS = {"POSITION": (0.25, -0.5, 2.0), "NORMAL": (0.6, 0.0, 0.8), "OBJECT": (1.5, 0.75, -1.25)}


def divided(a, b):
    return np.where(b == 0, 0, a / np.where(b == 0, 1, b))


ARITHMETIC = {
    "ADD": np.add, "SUBTRACT": np.subtract, "MULTIPLY": np.multiply, "DIVIDE": divided,
    "MINIMUM": np.minimum, "MAXIMUM": np.maximum,
    "LESS_THAN": lambda a, b: (a < b).astype(np.float32),
    "GREATER_THAN": lambda a, b: (a > b).astype(np.float32),
}


def vector(xyz):
    return np.array([*xyz, 1.0], np.float32)


def execute(name, modes, v):
    """One instruction on its operands, float32 (4,) each."""
    if name == "input":
        return vector(INPUTS[modes[0]])
    if name == "math":
        value = ARITHMETIC[modes[0]](v[0][0], v[1][0])
        return vector([min(max(value, 0.0), 1.0) if modes[1] == "YES" else value] * 3)
    if name == "vector_math":
        if modes[0] == "DOT_PRODUCT":
            return vector([np.dot(v[0][:3], v[1][:3])] * 3)
        return vector(ARITHMETIC[modes[0]](v[0][:3], v[1][:3]))
    if name == "mix":
        factor = np.clip(v[0], 0, 1) if modes[0] == "YES" else v[0]
        return (1 - factor) * v[1] + factor * v[2]
    if name == "component":
        return vector([v[0][["X", "Y", "Z", "ALPHA"].index(modes[0])]] * 3)
    if name == "scalar":
        weights = (0.2126, 0.7152, 0.0722) if modes[0] == "LUMINANCE" else (1 / 3,) * 3
        return vector([np.dot(v[0][:3], np.array(weights, np.float32))] * 3)
    if name == "combine":
        return vector([o[0] for o in v])
    raise KeyError(name)


def run(program, table):
    """{output: float32 (4,)} of a program."""
    registers = np.full((table["registers"], 4), np.nan, np.float32)

    def value(operand):
        return program.constants[-1 - operand] if operand < 0 else registers[operand]

    for op, mode, result, _data, *operands in program.instructions:
        kind = table["ops"][op]
        modes = []
        for digit in kind["modes"]:
            modes.append(digit[mode % len(digit)])
            mode //= len(digit)
        registers[result] = execute(
            kind["name"], modes, [value(o).copy() for o, _ in zip(operands, kind["operands"])])
    return {name: value(operand).copy() for name, operand in zip(table["outputs"], program.outputs)
            if operand != UNSET}


class ProgramTest(unittest.TestCase):
    def setUp(self):
        self.table = loader.node_table()
        self.b = Builder(self.table)

    def input(self, what="POSITION"):
        return self.b.op("input", modes=(what,))

    def results(self, **outputs):
        return run(self.b.program(outputs), self.table)

    def test_outputs_that_are_not_given_are_unset(self):
        program = self.b.program({"emission": self.b.constant(0.5)})
        self.assertEqual(len(program.instructions), 0)
        self.assertEqual([o == UNSET for o in program.outputs], [False] + [True] * 9)
        self.assertEqual(program.constant_output("emission"), (0.5,) * 3)
        self.assertIsNone(program.constant_output("alpha"))

    def test_arithmetic_of_constants_is_done_at_once(self):
        b = self.b
        value = b.mix(0.25, b.add(b.constant(1, 2, 3), 1.0), b.divide(1.0, 0.0))
        np.testing.assert_allclose(value.constant, (1.5, 2.25, 3.0, 1.0))
        self.assertIs(b.component(value, "Z"), b.constant(3.0))
        self.assertIs(b.combine(b.constant(1), b.constant(2), b.constant(3)), b.constant(1, 2, 3))
        self.assertAlmostEqual(b.luminance(b.constant(1, 0, 0)).constant[0], 0.2126, 6)

    def test_zeros_and_ones_need_no_instructions(self):
        b, x = self.b, self.input()
        for value in (b.multiply(x, 1.0), b.multiply(1.0, x), b.add(x, 0.0), b.subtract(x, 0.0),
                      b.mix(0.0, x, 5.0), b.mix(1.0, 5.0, x), b.divide(x, 1.0)):
            self.assertIs(value, x)
        self.assertIs(b.multiply(x, 0.0), b.constant(0.0))

    def test_numbers_for_one_component_stay_apart_from_vectors(self):
        """Math takes a vector's x alone, so it cannot be left out."""
        self.assertIsNot(self.b.math("MULTIPLY", self.input(), 1.0), self.input())

    def test_what_cannot_be_a_number_is_left_to_the_library(self):
        b = self.b
        self.assertIsNone(b.multiply(b.constant(1e30), 1e30).constant)
        self.assertEqual(b.constant(float("nan")).constant[0], 0.0)

    def test_equal_values_are_one(self):
        b = self.b
        value = b.multiply(b.add(self.input(), 1.0), b.add(self.input(), 1.0))
        program = b.program({"emission": value, "diffuse": b.add(self.input(), 1.0)})
        self.assertEqual(len(program.instructions), 3)
        self.assertEqual(len(program.constants), 2)  # 1, and the 0 of operands that do not count

    def test_what_nobody_needs_is_left_out(self):
        b = self.b
        b.op("image", self.input("NORMAL"), 0.0, modes=("FLAT",), data=b.texture("unused"))
        used = b.op("image", self.input(), 0.0, modes=("FLAT",), data=b.texture("used"))
        program = b.program({"diffuse": used})
        self.assertEqual(program.textures, ("used",))
        self.assertEqual(len(program.instructions), 2)
        self.assertEqual(program.instructions[-1, 3], 0)

    def test_tables_are_blocks_of_constants(self):
        b = self.b
        rows = tuple((i / 255, 0.0, 0.0, 1.0) for i in range(self.table["table_size"]))
        value = b.op("table", b.component(self.input(), "X"), modes=("LINEAR",), data=rows)
        program = b.program({"diffuse": value, "emission": b.constant(7.0)})
        first = program.instructions[-1, 3]
        np.testing.assert_allclose(program.constants[first:first + 256], rows, rtol=1e-6)

    def test_wrong_names_are_refused(self):
        for arguments in (("math", 1.0, 2.0, 3.0), ("fresnel", 1.0)):
            with self.assertRaises(ValueError):
                self.b.op(*arguments)
        with self.assertRaises(ValueError):
            self.b.math("NO_SUCH_OPERATION", self.input())

    def random_values(self, rng, count):
        """Values that depend on each other in a random way, with what numpy makes of them."""
        b = self.b
        values = [(self.input(name), vector(xyz)) for name, xyz in INPUTS.items()]
        values += [(b.constant(*xyz), vector(xyz))
                   for xyz in rng.uniform(-1, 1, (4, 3)).astype(np.float32)]
        kinds = [("vector_math", (name,)) for name in list(ARITHMETIC)[:6]]
        kinds += [("math", (name, clamp)) for name in ARITHMETIC for clamp in ("NO", "YES")]
        kinds += [("mix", ("YES",)), ("component", ("Y",)), ("scalar", ("AVERAGE",)),
                  ("scalar", ("LUMINANCE",)), ("combine", ()), ("vector_math", ("DOT_PRODUCT",))]
        operands = {op["name"]: len(op["operands"]) for op in self.table["ops"]}
        while len(values) < count:
            name, modes = kinds[rng.integers(len(kinds))]
            picked = [values[i] for i in rng.integers(max(0, len(values) - 60), len(values),
                                                      operands[name])]
            made = execute(name, modes, [value for _, value in picked])
            if np.abs(made).max() < 100:
                values.append((b.op(name, *(o for o, _ in picked), modes=modes), made))
        return values

    def test_random_programs(self):
        for seed in range(20):
            rng = np.random.default_rng(seed)
            self.b = Builder(self.table)
            values = self.random_values(rng, 300)
            names = self.table["outputs"]
            chosen = dict(zip(names, [values[i] for i in rng.integers(250, 300, len(names))]))
            results = self.results(**{name: value for name, (value, _) in chosen.items()})
            for name, (_, expected) in chosen.items():
                np.testing.assert_allclose(results[name][:3], expected[:3], rtol=2e-3, atol=2e-3)

    def test_more_values_at_once_than_registers(self):
        """All values are wanted again after the last one was made, in the opposite order."""
        b, count = self.b, 2 * self.table["registers"]
        chain = [self.input()]
        for i in range(count):
            chain.append(b.add(b.multiply(chain[-1], 0.5), b.constant(i / count, 1.0, 0.0)))
        total = b.constant(0.0)
        for value in reversed(chain):
            total = b.add(b.multiply(total, 0.5), b.multiply(value, value))
        program = b.program({"emission": total})
        self.assertLess(len(program.instructions), 40 * count)
        result = run(program, self.table)["emission"]

        x = np.array(INPUTS["POSITION"])
        made = [x]
        for i in range(count):
            made.append(made[-1] * 0.5 + (i / count, 1.0, 0.0))
        expected = np.zeros(3)
        for value in reversed(made):
            expected = expected * 0.5 + value * value
        np.testing.assert_allclose(result[:3], expected, rtol=1e-4)

    def test_same_program_every_time(self):
        def made():
            self.b = Builder(self.table)
            values = self.random_values(np.random.default_rng(7), 200)
            return self.b.program({"emission": values[-1][0], "diffuse": values[-2][0]})
        first, second = made(), made()
        np.testing.assert_array_equal(first.instructions, second.instructions)
        np.testing.assert_array_equal(first.constants, second.constants)
