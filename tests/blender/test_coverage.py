# SPDX-License-Identifier: GPL-3.0-or-later
"""Node coverage: what materials' nodes are not drawn as Blender does is told without rendering, and
no node or tree stops that."""

import contextlib
import io
import types

import bpy
import kestrel
import numpy as np
from kestrel import coverage
from kestrel.sync.material import read_material
from kestrel.sync.program import Program
from kestrel.sync.surface import Surface
from support import SceneTest, diffuse, image, new_material, run_blender, textured

OUTPUT_TYPES = {"SHADER", "VALUE", "RGBA", "VECTOR", "INT", "BOOLEAN"}


def with_node(kind, output=None, shader="ShaderNodeBsdfDiffuse"):
    """A material that takes its colour from a node's output."""
    material, tree, end = new_material(kind)
    node, surface = tree.nodes.new(kind), tree.nodes.new(shader)
    tree.links.new(node.outputs[output or 0], surface.inputs["Color"])
    tree.links.new(surface.outputs[0], end.inputs["Surface"])
    return material, node


class CoverageTest(SceneTest):
    def texts(self, material):
        return [str(note) for note in coverage.material_coverage(material)]

    def test_supported_materials_have_no_notes(self):
        picture = image("Dots", np.ones((4, 4, 4), np.float32), non_color=True)
        for material in (diffuse("Plain", (0.1, 0.2, 0.3)), textured("Image", picture)[0],
                         with_node("ShaderNodeTexNoise")[0], with_node("ShaderNodeTexCoord")[0]):
            self.assertEqual(self.texts(material), [])

    def test_notes_name_material_node_and_what_is_done(self):
        material, node = with_node("ShaderNodeBevel", "Normal")
        node.label = "Soft edges"
        self.assertEqual(self.texts(material), [
            "Material 'ShaderNodeBevel': node 'Soft edges' (Bevel) is not fully supported; edges "
            "are not rounded."])

    def test_shaders_without_a_like(self):
        material, tree, output = new_material("Cartoon")
        node = tree.nodes.new("ShaderNodeBsdfToon")
        tree.links.new(node.outputs[0], output.inputs["Surface"])
        self.assertRegex(self.texts(material)[0], "it is drawn as a Diffuse BSDF")

    def test_nodes_in_groups_are_named_after_them(self):
        inner = bpy.data.node_groups.new("Inner", "ShaderNodeTree")
        if hasattr(inner, "interface"):
            inner.interface.new_socket("Color", in_out="OUTPUT", socket_type="NodeSocketColor")
        else:
            inner.outputs.new("NodeSocketColor", "Color")
        node, result = (inner.nodes.new(kind) for kind in ("ShaderNodeWireframe", "NodeGroupOutput"))
        inner.links.new(node.outputs[0], result.inputs[0])
        material, tree, end = new_material("Grouped")
        group, shader = tree.nodes.new("ShaderNodeGroup"), tree.nodes.new("ShaderNodeEmission")
        group.node_tree, group.label = inner, "Edges"
        tree.links.new(group.outputs[0], shader.inputs["Color"])
        tree.links.new(shader.outputs[0], end.inputs["Surface"])
        self.assertRegex(self.texts(material)[0], "node 'Edges / Wireframe' .Wireframe.")

    def test_images_that_are_not_read_as_in_blender(self):
        picture = image("Sea", np.ones((4, 4, 4), np.float32))
        material, _ = textured("Water", picture)
        picture.source = "TILED"
        self.assertRegex(self.texts(material)[0], "'Sea' .Image.*only its first picture is used")

    def test_volumes_are_named(self):
        material, tree, output = new_material("Fog")
        node = tree.nodes.new("ShaderNodeVolumeScatter")
        tree.links.new(node.outputs[0], output.inputs["Volume"])
        self.assertRegex(self.texts(material)[0], "its volume is left out")

    def test_cycles_end(self):
        material, tree, output = new_material("Cycle")
        shader = tree.nodes.new("ShaderNodeEmission")
        first, second = (tree.nodes.new("ShaderNodeMath") for _ in range(2))
        tree.links.new(first.outputs[0], second.inputs[0])
        tree.links.new(second.outputs[0], first.inputs[0])
        tree.links.new(second.outputs[0], shader.inputs["Strength"])
        tree.links.new(shader.outputs[0], output.inputs["Surface"])
        self.assertIsInstance(read_material(material, 1.0, lambda note: None)[0], Program)

    def test_long_chains(self):
        """Two hundred nodes in a row, each of which uses the one before twice."""
        material, tree, output = new_material("Chain")
        socket = tree.nodes.new("ShaderNodeTexCoord").outputs["Generated"]
        for _ in range(200):
            node = tree.nodes.new("ShaderNodeVectorMath")
            tree.links.new(socket, node.inputs[0])
            tree.links.new(socket, node.inputs[1])
            socket = node.outputs[0]
        shader = tree.nodes.new("ShaderNodeEmission")
        tree.links.new(socket, shader.inputs["Color"])
        tree.links.new(shader.outputs[0], output.inputs["Surface"])
        program = read_material(material, 1.0, self.fail)[0]
        self.assertLess(len(program.instructions), 300)

    def test_long_chains_of_shaders_and_colors(self):
        for kind, first, last in (("MixRGB", "RGB", "Color"), ("MixShader", "BsdfDiffuse", None)):
            material, tree, output = new_material("Chain")
            socket = tree.nodes.new(f"ShaderNode{first}").outputs[0]
            for _ in range(100):
                node = tree.nodes.new(f"ShaderNode{kind}")
                tree.links.new(socket, node.inputs[1])
                tree.links.new(socket, node.inputs[2])
                socket = node.outputs[0]
            if last:
                shader = tree.nodes.new("ShaderNodeEmission")
                tree.links.new(socket, shader.inputs[last])
                socket = shader.outputs[0]
            tree.links.new(socket, output.inputs["Surface"])
            self.assertIsInstance(read_material(material, 1.0, self.fail), Surface)

    def test_every_node_of_this_blender(self):
        """Whatever a material is made of, there is a program or a Surface for it."""
        kinds = [name for name in dir(bpy.types) if name.startswith("ShaderNode") and
                 name not in ("ShaderNode", "ShaderNodeTree", "ShaderNodeCustomGroup")]
        self.assertGreater(len(kinds), 80)
        material, tree, end = new_material("All")
        tried = 0
        for kind in kinds:
            try:
                node = tree.nodes.new(kind)
            except RuntimeError:  # no node of materials
                continue
            for output in node.outputs:
                if output.type not in OUTPUT_TYPES:
                    continue
                shader = tree.nodes.new("ShaderNodeEmission")
                if output.type == "SHADER":
                    tree.links.new(output, end.inputs["Surface"])
                else:
                    tree.links.new(output, shader.inputs["Color"])
                    tree.links.new(shader.outputs[0], end.inputs["Surface"])
                with self.subTest(node=kind, output=output.name):
                    read_material(material, 1.0, lambda note: None)
                    tried += 1
                tree.nodes.remove(shader)
            tree.nodes.remove(node)
        self.assertGreater(tried, 120)

    def test_text_on_the_command_line(self):
        self.cube(material=with_node("ShaderNodeWireframe")[0])
        text = io.StringIO()
        with contextlib.redirect_stdout(text):
            kestrel.print_node_coverage()
        self.assertEqual(text.getvalue(),
                         "ShaderNodeWireframe: Wireframe (Wireframe): there are no wires\n")
        path = self.folder / "wires.blend"
        bpy.ops.wm.save_as_mainfile(filepath=str(path))
        done = run_blender(self.folder, str(path), "--python-expr",
                           "import kestrel; kestrel.print_node_coverage()")
        self.assertIn("Wireframe (Wireframe): there are no wires", done.stdout, done.stderr)


class PanelOperatorTest(SceneTest):
    def setUp(self):
        super().setUp()
        self.coverage = bpy.context.window_manager.kestrel_coverage
        self.coverage.fill([])
        self.object = self.cube(material=with_node("ShaderNodeWireframe")[0])

    def test_check_fills_the_list(self):
        self.assertEqual(bpy.ops.kestrel.check_materials(), {"FINISHED"})
        self.assertEqual([item.name for item in self.coverage.items],
                         ["ShaderNodeWireframe: Wireframe"])
        self.assertIn("there are no wires", self.coverage.selected().text)
        bpy.ops.kestrel.check_materials()
        self.assertEqual(len(self.coverage.items), 1)

    def test_select_material(self):
        other = self.cube("Other")
        other.select_set(True)
        bpy.ops.kestrel.check_materials()
        self.assertEqual(bpy.ops.kestrel.select_material(), {"FINISHED"})
        self.assertEqual(bpy.context.view_layer.objects.active, self.object)
        self.assertEqual(bpy.context.selected_objects, [self.object])

    def test_copy(self):
        bpy.ops.kestrel.check_materials()
        window_manager = types.SimpleNamespace(clipboard="", kestrel_coverage=self.coverage)
        coverage.KESTREL_OT_copy_node_coverage.execute(
            None, types.SimpleNamespace(window_manager=window_manager))
        self.assertEqual(window_manager.clipboard, self.coverage.items[0].text)
