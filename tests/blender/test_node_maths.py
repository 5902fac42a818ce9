# SPDX-License-Identifier: GPL-3.0-or-later
"""Textures and colours of nodes are what Cycles makes of them.

One picture holds a tile for each case of node_cases.py. Every pixel carries the coordinates that its
node got and the value that it gave; the function of the same node is evaluated at those coordinates.
"""

import math
import os
import subprocess
from collections import defaultdict
from pathlib import Path

import bpy
import numpy as np
from mathutils import Matrix
from node_cases import cases
from support import SceneTest, new_material

TILE = 32  # pixels
TOLERANCE = 2 / 255  # of the values, where they exceed 1 of their largest
AGREEING = 0.995  # share of a tile's pixels; at the edges of cells rounding decides
W_BY_POSITION = (0.7, -0.4, 0.2)


def socket(sockets, name):
    """By identifier or name; 'Fac' is also found where it is called Factor."""
    for names in ((name,), ("Factor",) if name == "Fac" else ()):
        for one in sockets:
            if one.enabled and {one.identifier, one.name} & set(names):
                return one
    return None


def node_values(function, points):
    """The function of node_maths at points (n x 4): n x 4."""
    request = " ".join(map(str, function)) + "\n" + "\n".join(
        " ".join(map(repr, point)) for point in points.tolist())
    done = subprocess.run([program()], input=request, capture_output=True, text=True, check=True)
    return np.array(done.stdout.split(), np.float32).reshape(-1, 4)


def program():
    return Path(os.environ["KESTREL_TEST_COMMAND"]).parent / "tests/node_values"


class NodeMathsTest(SceneTest):
    def setUp(self):
        super().setUp()
        if not program().is_file():
            self.skipTest(f"{program()} is not built")

    def material(self, case):
        material, tree, output = new_material(case.name)
        nodes, links = tree.nodes, tree.links
        node = nodes.new(case.kind)
        for name, value in case.properties.items():
            setattr(node, name, value)
        for name, value in case.inputs.items():
            found = socket(node.inputs, name)
            if found:
                found.default_value = value
        place = nodes.new("ShaderNodeVectorMath")
        place.operation = "MULTIPLY_ADD"
        place.inputs[1].default_value, place.inputs[2].default_value = case.place
        links.new(nodes.new("ShaderNodeTexCoord").outputs["Object"], place.inputs[0])
        at = place.outputs["Vector"]
        w = nodes.new("ShaderNodeVectorMath")
        w.operation = "DOT_PRODUCT"
        w.inputs[1].default_value = W_BY_POSITION
        links.new(at, w.inputs[0])
        self.link_coordinates(case, tree, node, at, w.outputs["Value"])
        self.aov(tree, "At", at)
        self.aov(tree, "W", w.outputs["Value"])
        value = socket(node.outputs, case.output) or node.outputs[0]
        if case.kind == "ShaderNodeSeparateColor":
            value = nodes.new("ShaderNodeCombineXYZ")
            for part, whole in zip(node.outputs, value.inputs):
                links.new(part, whole)
            value = value.outputs[0]
        self.aov(tree, "Value", value)
        emission = nodes.new("ShaderNodeEmission")
        links.new(value, emission.inputs["Color"])
        links.new(emission.outputs[0], output.inputs["Surface"])
        return material

    def link_coordinates(self, case, tree, node, at, w):
        names = case.linked.split() if case.kind == "ShaderNodeCombineColor" else [case.linked]
        if socket(node.inputs, "W"):
            tree.links.new(w, socket(node.inputs, "W"))
        if names in (["Temperature"], ["Wavelength"]) or len(names) > 1:
            parts = tree.nodes.new("ShaderNodeSeparateXYZ")
            tree.links.new(at, parts.inputs[0])
            for name, part in zip(names, parts.outputs):
                tree.links.new(part, socket(node.inputs, name))
        elif socket(node.inputs, names[0]):
            tree.links.new(at, socket(node.inputs, names[0]))

    def aov(self, tree, name, value):
        node = tree.nodes.new("ShaderNodeOutputAOV")
        setattr(node, "aov_name" if hasattr(node, "aov_name") else "name", name)
        tree.links.new(value, node.inputs["Color"])

    def tiles(self, all_cases):
        """Passes of one picture by case: (case, at, value), each pixels x 4 and pixels x 3."""
        columns = math.ceil(math.sqrt(len(all_cases)))
        lines = math.ceil(len(all_cases) / columns)
        render = self.scene.render
        render.resolution_x, render.resolution_y = columns * TILE, lines * TILE
        center = (columns / 2, lines / 2, 0)
        self.camera((*center[:2], 5), center, ortho_scale=float(max(columns, lines)))
        corners = [(x, y, 0.3 * x - 0.7 * y + 0.11) for x, y in
                   ((-2, -2), (2, -2), (2, 2), (-2, 2))]
        for i, case in enumerate(all_cases):
            where = (i % columns + 0.5, lines - i // columns - 0.5, 0)
            self.mesh(case.name, corners, [(0, 1, 2, 3)], self.material(case),
                      Matrix.Translation(where) @ Matrix.Scale(0.25, 4))
        layer = self.scene.view_layers[0]
        for name in ("At", "W", "Value"):
            aov = layer.aovs.add()
            aov.name, aov.type = name, "COLOR"
        cycles = self.scene.cycles
        cycles.samples, cycles.use_denoising, cycles.use_adaptive_sampling = 1, False, False
        cycles.max_bounces, cycles.pixel_filter_type, cycles.filter_width = 0, "BOX", 0.01
        planes = self.render_planes("CYCLES")
        at, w, value = (np.stack([planes[f"{layer.name}.{name}.{channel}"] for channel in "RGB"],
                                 axis=-1) for name in ("At", "W", "Value"))
        for i, case in enumerate(all_cases):
            window = tuple(slice(TILE * k, TILE * (k + 1)) for k in divmod(i, columns))
            points = np.concatenate([at[window], w[window][..., :1]], axis=-1)
            yield case, points.reshape(-1, 4), value[window].reshape(-1, 3)

    def test_values_are_those_of_cycles(self):
        worst = defaultdict(lambda: (0.0, 0.0, 0.0, ""))
        for case, points, wanted in self.tiles(cases()):
            found = node_values(case.function, points)[:, ["xyzw".index(c) for c in case.channels]]
            known = np.isfinite(wanted).all(axis=1)
            error = np.abs(found - wanted)[known] / max(1.0, np.abs(wanted[known]).max())
            disagreeing = np.mean(error.max(axis=1) > TOLERANCE)
            usual = np.quantile(error, AGREEING)
            worst[case.kind] = max(worst[case.kind], (disagreeing, usual, error.max(), case.name))
            with self.subTest(case=case.name):
                self.assertEqual(known.mean(), 1.0)
                self.assertEqual(np.ptp(wanted) > 0.03, not case.constant, "the picture's contrast")
                self.assertLessEqual(disagreeing, 1 - AGREEING, f"usual error {usual:.5f}")
        print(f"Blender {bpy.app.version_string}, the worst case of each node: share of pixels "
              f"beyond {TOLERANCE:.4f}, error of {100 * AGREEING} % of the pixels, largest error")
        for kind, (disagreeing, usual, largest, name) in sorted(worst.items()):
            print(f"  {kind[10:]:16} {100 * disagreeing:5.2f} % {usual:.2e} {largest:.2e}  {name}")
