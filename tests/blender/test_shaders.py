# SPDX-License-Identifier: GPL-3.0-or-later
"""Shaders of node programs as pictures beside Cycles': a ball before a checkered floor and wall."""

import math
import os
from pathlib import Path
from unittest import mock

import bpy
import numpy as np
from kestrel.native import capi
from mathutils import Matrix
from support import SceneTest, turned
from test_nodes import Graph

PICTURES = os.environ.get("KESTREL_TEST_PICTURES")  # folder that gets the pairs


def psnr(first, second):
    """dB between pictures of 0 ... 1."""
    error = np.mean((np.clip(first, 0, 1) - np.clip(second, 0, 1)) ** 2)
    return 10.0 * math.log10(1.0 / max(float(error), 1e-12))


class ShaderTest(SceneTest):
    size = (96, 96)

    def setUp(self):
        super().setUp()
        self.camera((0, -5, 1.6), (0, 0, 0.8), lens=55)
        self.scene.kestrel.samples = 32
        self.scene.kestrel.pixel_filter, self.scene.kestrel.filter_width = "box", 1.0
        self.scene.cycles.filter_width = 1.0
        self.light("SUN", 2.5, (1.5, -2, 3))
        room = self.checkered()
        for plane in (self.plane("Floor", 12, room), self.plane(
                "Wall", 12, room, Matrix.Translation((0, 3, 0)) @ turned(90))):
            plane.visible_diffuse = False
        bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, radius=0.8,
                                             location=(0, 0, 0.85))
        self.ball = bpy.context.object
        bpy.ops.object.shade_smooth()

    @staticmethod
    def checkered():
        """Shines in two colours; as nothing diffuse sees it, the sun alone lights the ball."""
        graph = Graph("Room")
        checker = graph.node("TexChecker", {"Vector": graph.coordinates("UV"), "Scale": 24.0,
                                            "Color1": (0.7, 0.6, 0.5), "Color2": (0.1, 0.2, 0.3)})
        emission = graph.node("Emission", {"Color": checker.outputs["Color"]})
        graph.tree.links.new(emission.outputs[0], graph.output.inputs["Surface"])
        return graph.material

    def like_cycles(self, graph, shader, least):
        graph.tree.links.new(shader.outputs[0], graph.output.inputs["Surface"])
        self.ball.data.materials.clear()
        self.ball.data.materials.append(graph.material)
        ours, theirs = self.render()[..., :3], self.render_cycles(64)[..., :3]
        found = psnr(ours, theirs)
        if PICTURES:
            pair = np.concatenate([ours, theirs, 0.5 + 4 * (ours - theirs)], axis=1)
            save(Path(PICTURES) / f"{self._testMethodName}_{found:.1f}.png", pair)
        self.assertGreater(found, least, self._testMethodName)

    def test_only_changed_programs_are_sent_again(self):
        graph = Graph()
        mixed = graph.node("MixRGB", {0: self.noise(graph), 1: (1, 0, 0)})
        graph.show(mixed.outputs[0])
        self.ball.data.materials.append(graph.material)
        sent = []
        send = capi.Scene.set_material
        with mock.patch.object(capi.Scene, "set_material", lambda scene, ident, item: (
                sent.append(item.name.decode()), send(scene, ident, item))):
            counts = []
            for color in ((0, 0, 1, 1), (0, 0, 1, 1), (0, 1, 0, 1)):
                mixed.inputs[2].default_value = color
                sent.clear()
                self.render()
                counts.append(sorted(sent))
        self.assertEqual(counts, [["Node", "Room"], [], ["Node"]])

    def noise(self, graph, scale=3.0, output="Fac"):
        return graph.node("TexNoise", {"Vector": graph.coordinates("Object"),
                                       "Scale": scale}).outputs[output]

    def waves(self, graph):
        parts = graph.node("SeparateXYZ", {0: graph.varied((12, 10, 11), (0, 0, 0), "Object")})
        return graph.math("ADD", *(graph.math("SINE", parts.outputs[i]) for i in (0, 2)))

    def tinted(self, graph):
        """A colour that no table holds."""
        return graph.node("MixRGB", {0: self.noise(graph), 1: (0.9, 0.3, 0.2),
                                     2: (0.2, 0.5, 0.9)}).outputs[0]

    def test_diffuse(self):
        graph = Graph()
        self.like_cycles(graph, graph.node("BsdfDiffuse", {"Color": self.tinted(graph)}), 38)

    def test_emission(self):
        graph = Graph()
        self.like_cycles(graph, graph.node("Emission", {"Color": self.tinted(graph)}), 38)

    def test_glass(self):
        graph = Graph()
        color = graph.node("Gamma", {0: (0.9, 0.95, 1.0), 1: 1.0}).outputs[0]
        self.like_cycles(graph, graph.node("BsdfGlass", {"Color": color, "Roughness": 0.0,
                                                         "IOR": 1.45}), 37)

    def mirror(self, graph, color):
        kind = "BsdfGlossy" if hasattr(bpy.types, "ShaderNodeBsdfGlossy") else "BsdfAnisotropic"
        return graph.node(kind, {"Color": color, "Roughness": 0.0})

    def test_mirror_tinted_point_by_point(self):
        graph = Graph()
        self.like_cycles(graph, self.mirror(graph, self.tinted(graph)), 37)

    def test_varnish_by_fresnel(self):
        graph = Graph()
        matte = graph.node("BsdfDiffuse", {"Color": self.tinted(graph)})
        factor = graph.node("Fresnel", {"IOR": 1.5})
        self.like_cycles(graph, graph.node("MixShader", {
            0: factor.outputs[0], 1: matte.outputs[0],
            2: self.mirror(graph, (1, 1, 1)).outputs[0]}), 37)

    def test_holes_by_noise(self):
        graph = Graph()
        sharp = graph.math("GREATER_THAN", self.noise(graph, 2.0), 0.5)
        matte = graph.node("BsdfDiffuse", {"Color": (0.8, 0.3, 0.2)})
        self.like_cycles(graph, graph.node("MixShader", {
            0: sharp, 1: graph.node("BsdfTransparent").outputs[0], 2: matte.outputs[0]}), 37)

    def test_half_transparent(self):
        graph = Graph()
        matte = graph.node("BsdfDiffuse", {"Color": (0.8, 0.3, 0.2)})
        self.like_cycles(graph, graph.node("MixShader", {
            0: self.noise(graph, 2.0), 1: graph.node("BsdfTransparent").outputs[0],
            2: matte.outputs[0]}), 37)

    def test_glow_added(self):
        graph = Graph()
        matte = graph.node("BsdfDiffuse", {"Color": (0.3, 0.3, 0.8)})
        glow = graph.node("Emission", {"Color": self.tinted(graph), "Strength": 0.4})
        self.like_cycles(graph, graph.node("AddShader", {0: matte.outputs[0],
                                                         1: glow.outputs[0]}), 38)

    def test_bump(self):
        graph = Graph()
        normal = graph.node("Bump", {"Height": self.waves(graph), "Distance": 0.05}).outputs[0]
        self.like_cycles(graph, graph.node("BsdfDiffuse", {"Normal": normal}), 30)

    def test_normal_map(self):
        graph = Graph()
        bent = graph.vectors("MULTIPLY_ADD", self.waves(graph), (0.2, 0.1, 0.0), (0.5, 0.5, 1.0))
        normal = graph.node("NormalMap", {"Color": bent}).outputs[0]
        self.like_cycles(graph, graph.node("BsdfDiffuse", {"Normal": normal}), 31)

    def principled(self, graph, **inputs):
        renamed = {"Specular": "Specular IOR Level", "Transmission": "Transmission Weight",
                   "Emission": "Emission Color", "Clearcoat": "Coat Weight"}
        node = graph.tree.nodes.new("ShaderNodeBsdfPrincipled")
        for name, value in inputs.items():
            name = name.replace("_", " ")
            name = renamed[name] if renamed.get(name, "") in node.inputs else name
            if isinstance(value, bpy.types.NodeSocket):
                graph.tree.links.new(value, node.inputs[name])
            else:
                node.inputs[name].default_value = value
        return node

    def test_plastic(self):
        graph = Graph()
        self.like_cycles(graph, self.principled(graph, Base_Color=self.tinted(graph),
                                                Roughness=0.2), 35)

    def test_metal(self):
        graph = Graph()
        self.like_cycles(graph, self.principled(graph, Base_Color=self.tinted(graph), Metallic=1.0,
                                                Roughness=0.0), 37)

    def test_coat(self):
        graph = Graph()
        self.like_cycles(graph, self.principled(graph, Base_Color=self.tinted(graph),
                                                Roughness=0.6, Clearcoat=1.0), 33)

    def test_principled_glass(self):
        graph = Graph()
        clear = graph.math("ADD", self.noise(graph), 1.0)
        self.like_cycles(graph, self.principled(graph, Transmission=clear, Roughness=0.0), 37)

    def test_principled_alpha(self):
        graph = Graph()
        self.like_cycles(graph, self.principled(graph, Alpha=self.noise(graph, 2.0),
                                                Roughness=0.8), 33)


def save(path, picture):
    """A PNG for people to look at."""
    made = bpy.data.images.new("Pair", picture.shape[1], picture.shape[0], float_buffer=True)
    rgba = np.ones((*picture.shape[:2], 4), np.float32)
    rgba[..., :3] = np.clip(picture[::-1], 0, 1) ** (1 / 2.2)
    made.colorspace_settings.name = "Non-Color"
    made.pixels.foreach_set(rgba.ravel())
    made.filepath_raw, made.file_format = str(path), "PNG"
    made.save()
    bpy.data.images.remove(made)
