# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes as the paper's Table 1, and as pictures."""

import math
import unittest

import bpy
import numpy as np
from kestrel.sync import surface as sync_surface
from kestrel.sync.surface import NotPlain, read_surface
from mathutils import Matrix
from support import (SceneTest, diffuse, emission, image, new_material, shader_material, textured)

GLOSSY = "ShaderNodeBsdfGlossy"
try:
    bpy.data.materials.new("Probe").use_nodes = True
    bpy.data.materials["Probe"].node_tree.nodes.new(GLOSSY)
except RuntimeError:
    GLOSSY = "ShaderNodeBsdfAnisotropic"


def read(material, environment_ior=1.0):
    return read_surface(material, environment_ior)


def principled(name, **inputs):
    """Principled BSDF; names of either generation of sockets."""
    material, tree, output = new_material(name)
    node = tree.nodes.new("ShaderNodeBsdfPrincipled")
    renamed = {"Specular": "Specular IOR Level", "Transmission": "Transmission Weight",
               "Emission": "Emission Color"}
    for key, value in inputs.items():
        key = key.replace("_", " ")
        socket = node.inputs[renamed[key] if renamed.get(key, "") in node.inputs else key]
        socket.default_value = (*value, 1.0) if isinstance(value, tuple) else value
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    return material


def checker(name="Checker", alpha=False):
    """4 x 4: left half red, right half green; with alpha the upper half is a hole."""
    pixels = np.ones((4, 4, 4), np.float32)
    pixels[:, :2, :3], pixels[:, 2:, :3] = (1, 0, 0), (0, 1, 0)
    if alpha:
        pixels[2:, :, 3] = 0.0
    return image(name, pixels, non_color=True)


class TableTest(SceneTest):
    """Single shaders."""

    def close(self, actual, expected):
        np.testing.assert_allclose(actual, expected, rtol=1e-4, atol=1e-6)

    def test_diffuse(self):
        surface = read(diffuse("D", (0.1, 0.2, 0.3)))
        self.close(surface.diffuse.color, (0.1, 0.2, 0.3))
        self.close(surface.ambient.color, (0.1, 0.2, 0.3))
        self.assertEqual((surface.reflectivity, surface.opacity), (0.0, 1.0))
        self.assertEqual(surface.specular, (0, 0, 0))

    def test_mirror(self):
        surface = read(shader_material("M", GLOSSY, Color=(0.5, 0.4, 0.2), Roughness=0.0))
        self.close(surface.reflectivity, 0.5)
        self.close(surface.reflection_color, (1.0, 0.8, 0.4))
        self.assertEqual(surface.diffuse.color, (0, 0, 0))
        self.assertEqual(surface.specular, (0, 0, 0))

    def test_rough_metal(self):
        surface = read(shader_material("R", GLOSSY, Color=(0.5, 0.5, 0.5), Roughness=0.5))
        self.close(surface.reflectivity, 0.125)
        self.close(surface.exponent, 30.0)          # 2 / 0.5⁴ - 2
        self.close(surface.specular, [0.375 * 4.0] * 3)  # the rest, times (30 + 2) / 8
        self.close(surface.ambient.color, [0.375] * 3)

    def test_glass(self):
        surface = read(shader_material("G", "ShaderNodeBsdfGlass", Color=(1.0, 0.5, 0.25),
                                       IOR=1.5, Roughness=0.0))
        self.assertEqual((surface.opacity, surface.ior), (0.0, 1.5))
        self.close(surface.reflectivity, 0.04)
        self.close(surface.transmission_color, (1.0, 0.5, 0.25))
        self.assertEqual(surface.diffuse.color, (0, 0, 0))

    def test_transparent_has_the_index_of_the_surroundings(self):
        surface = read(shader_material("T", "ShaderNodeBsdfTransparent", Color=(0.5, 1.0, 1.0)),
                       environment_ior=1.33)
        self.assertEqual((surface.opacity, surface.reflectivity), (0.0, 0.0))
        self.close(surface.ior, 1.33)
        self.close(surface.transmission_color, (0.5, 1.0, 1.0))

    def test_emission(self):
        surface = read(emission("E", (0.5, 0.25, 1.0), 4.0))
        self.close(surface.emission.color, (2.0, 1.0, 4.0))
        self.assertEqual(surface.diffuse.color, (0, 0, 0))

    def test_principled_plastic(self):
        surface = read(principled("P", Base_Color=(0.2, 0.4, 0.6), Roughness=0.5, Specular=0.5,
                                  Metallic=0.0, IOR=1.5))
        self.close(surface.diffuse.color, (0.2, 0.4, 0.6))
        self.close(surface.specular, [0.04 * 4.0] * 3)
        self.assertEqual(surface.reflectivity, 0.0)
        self.assertEqual(surface.opacity, 1.0)

    def test_principled_metal(self):
        surface = read(principled("P", Base_Color=(0.8, 0.4, 0.2), Roughness=0.0, Metallic=1.0))
        self.assertEqual(surface.diffuse.color, (0, 0, 0))
        self.close(surface.reflectivity, 0.8)
        self.close(surface.reflection_color, (1.0, 0.5, 0.25))

    def test_principled_half_metal(self):
        surface = read(principled("P", Base_Color=(0.8, 0.8, 0.8), Roughness=0.0, Metallic=0.5))
        self.close(surface.diffuse.color, [0.4] * 3)
        self.close(surface.reflectivity, 0.4)

    def test_principled_glass(self):
        surface = read(principled("P", Base_Color=(1.0, 0.5, 0.5), Roughness=0.0,
                                  Transmission=0.75, IOR=1.5))
        self.close(surface.opacity, 0.25)
        self.close(surface.ior, 1.5)
        self.close(surface.transmission_color, (1.0, 0.5, 0.5))
        self.close(surface.diffuse.color, (0.25, 0.125, 0.125))

    def test_principled_emission_and_alpha(self):
        surface = read(principled("P", Emission=(1.0, 0.5, 0.0), Emission_Strength=2.0, Alpha=0.3))
        self.close(surface.emission.color, (2.0, 1.0, 0.0))
        self.close(surface.alpha, 0.3)
        self.assertFalse(surface.masked)

    def test_without_nodes(self):
        material = bpy.data.materials.new("Plain")
        if not material.use_nodes:
            material.diffuse_color = (0.1, 0.2, 0.3, 1.0)
            self.close(read(material).diffuse.color, (0.1, 0.2, 0.3))

    def test_without_a_shader(self):
        material, _, _ = new_material("Nothing")
        self.assertEqual(read(material), sync_surface.Surface())


class GraphTest(SceneTest):
    """Several nodes."""

    def mixed(self, first, second, factor=None, kind="ShaderNodeMixShader"):
        material, tree, output = new_material("Mixed")
        mix = tree.nodes.new(kind)
        sockets = mix.inputs[1:] if factor is not None else mix.inputs
        made = []
        for socket, (shader, inputs) in zip(sockets, (first, second)):
            node = tree.nodes.new(shader)
            for name, value in inputs.items():
                node.inputs[name].default_value = value
            tree.links.new(node.outputs[0], socket)
            made.append(node)
        if factor is not None:
            mix.inputs[0].default_value = factor
        tree.links.new(mix.outputs[0], output.inputs["Surface"])
        return material, tree, mix, made

    def test_mix(self):
        material, *_ = self.mixed(("ShaderNodeBsdfDiffuse", {"Color": (1, 0, 0, 1)}),
                                  (GLOSSY, {"Color": (0.8, 0.8, 0.8, 1), "Roughness": 0.0}), 0.25)
        surface = read(material)
        np.testing.assert_allclose(surface.diffuse.color, (0.75, 0, 0))
        self.assertAlmostEqual(surface.reflectivity, 0.2, 5)

    def test_mix_with_transparent(self):
        material, *_ = self.mixed(("ShaderNodeBsdfTransparent", {}),
                                  ("ShaderNodeBsdfDiffuse", {"Color": (1, 1, 1, 1)}), 0.25)
        surface = read(material)
        self.assertAlmostEqual(surface.opacity, 0.25, 5)
        np.testing.assert_allclose(surface.diffuse.color, [0.25] * 3)

    def test_add(self):
        material, *_ = self.mixed(("ShaderNodeBsdfDiffuse", {"Color": (0.5, 0, 0, 1)}),
                                  ("ShaderNodeEmission", {"Color": (0, 1, 0, 1)}),
                                  kind="ShaderNodeAddShader")
        surface = read(material)
        np.testing.assert_allclose(surface.diffuse.color, (0.5, 0, 0))
        np.testing.assert_allclose(surface.emission.color, (0, 1, 0))

    def test_mask_by_mix(self):
        """Transparent and Diffuse mixed by the alpha of the image that colours."""
        material, tree, mix, made = self.mixed(("ShaderNodeBsdfTransparent", {}),
                                               ("ShaderNodeBsdfDiffuse", {}), 0.5)
        node = tree.nodes.new("ShaderNodeTexImage")
        node.image = checker(alpha=True)
        tree.links.new(node.outputs["Color"], made[1].inputs["Color"])
        tree.links.new(node.outputs["Alpha"], mix.inputs[0])
        surface = read(material)
        self.assertTrue(surface.masked)
        self.assertEqual(surface.diffuse.texture.image, node.image)
        np.testing.assert_allclose(surface.diffuse.color, (1, 1, 1))

    def test_alpha_that_no_image_gives_is_not_plain(self):
        material = principled("P")
        tree = material.node_tree
        noise = tree.nodes.new("ShaderNodeTexNoise")
        tree.links.new(noise.outputs[0], tree.nodes["Principled BSDF"].inputs["Alpha"])
        with self.assertRaisesRegex(NotPlain, "Material 'P': .*Noise"):
            read(material)

    def test_groups_reroutes_and_muted_nodes_are_seen_through(self):
        inner = bpy.data.node_groups.new("Inner", "ShaderNodeTree")
        if hasattr(inner, "interface"):
            inner.interface.new_socket("Tint", in_out="INPUT", socket_type="NodeSocketColor")
            inner.interface.new_socket("Shader", in_out="OUTPUT", socket_type="NodeSocketShader")
        else:
            inner.inputs.new("NodeSocketColor", "Tint")
            inner.outputs.new("NodeSocketShader", "Shader")
        start, end = inner.nodes.new("NodeGroupInput"), inner.nodes.new("NodeGroupOutput")
        shader, gamma = inner.nodes.new("ShaderNodeBsdfDiffuse"), inner.nodes.new("ShaderNodeGamma")
        gamma.mute = True
        inner.links.new(start.outputs[0], gamma.inputs[0])
        inner.links.new(gamma.outputs[0], shader.inputs[0])
        inner.links.new(shader.outputs[0], end.inputs[0])
        material, tree, output = new_material("Group")
        group, reroute = tree.nodes.new("ShaderNodeGroup"), tree.nodes.new("NodeReroute")
        group.node_tree = inner
        color = tree.nodes.new("ShaderNodeRGB")
        color.outputs[0].default_value = (0.25, 0.5, 1.0, 1.0)
        tree.links.new(color.outputs[0], reroute.inputs[0])
        tree.links.new(reroute.outputs[0], group.inputs[0])
        tree.links.new(group.outputs[0], output.inputs["Surface"])
        np.testing.assert_allclose(read(material).diffuse.color, (0.25, 0.5, 1.0))

    def test_image_times_colour(self):
        material, tree, output = new_material("Product")
        shader, texture = (tree.nodes.new(f"ShaderNode{kind}") for kind in
                           ("BsdfDiffuse", "TexImage"))
        texture.image = checker()
        mix = tree.nodes.new("ShaderNodeMixRGB")
        mix.blend_type = "MULTIPLY"
        mix.inputs[0].default_value = 1.0
        mix.inputs[2].default_value = (0.5, 0.25, 1.0, 1.0)
        tree.links.new(texture.outputs["Color"], mix.inputs[1])
        tree.links.new(mix.outputs[0], shader.inputs["Color"])
        tree.links.new(shader.outputs[0], output.inputs["Surface"])
        surface = read(material)
        np.testing.assert_allclose(surface.diffuse.color, (0.5, 0.25, 1.0))
        self.assertEqual(surface.diffuse.texture.image, texture.image)

    def test_other_nodes_are_not_plain(self):
        for kind in ("TexNoise", "RGBCurve", "HueSaturation", "ValToRGB"):
            material, tree, output = new_material("Odd")
            shader, node = (tree.nodes.new(f"ShaderNode{k}") for k in ("BsdfDiffuse", kind))
            tree.links.new(node.outputs["Color"], shader.inputs["Color"])
            tree.links.new(shader.outputs[0], output.inputs["Surface"])
            with self.assertRaises(NotPlain):
                read(material)

    def test_images_mapped_in_different_ways_are_not_plain(self):
        material, texture = textured("Two", checker(), "ShaderNodeBsdfPrincipled")
        tree = material.node_tree
        other, mapping = tree.nodes.new("ShaderNodeTexImage"), tree.nodes.new("ShaderNodeMapping")
        other.image = checker("Other")
        mapping.inputs["Scale"].default_value = (2, 2, 2)
        coordinates = tree.nodes.new("ShaderNodeTexCoord")
        tree.links.new(coordinates.outputs["UV"], mapping.inputs["Vector"])
        tree.links.new(mapping.outputs[0], other.inputs["Vector"])
        shader = tree.nodes["Principled BSDF"]
        glow = shader.inputs["Emission Color" if "Emission Color" in shader.inputs else "Emission"]
        tree.links.new(other.outputs["Color"], glow)
        shader.inputs["Emission Strength"].default_value = 1.0
        with self.assertRaisesRegex(NotPlain, "mapped in different ways"):
            read(material)

    def test_mapping(self):
        material, texture = textured("Mapped", checker(), "ShaderNodeBsdfDiffuse")
        mapping = material.node_tree.nodes.new("ShaderNodeMapping")
        mapping.inputs["Scale"].default_value = (2, 3, 1)
        mapping.inputs["Location"].default_value = (0.25, 0.5, 0)
        material.node_tree.links.new(mapping.outputs[0], texture.inputs["Vector"])
        found = read(material).diffuse.texture
        self.assertEqual((found.tiling, found.offset), ((2, 3), (0.25, 0.5)))
        mapping.vector_type = "TEXTURE"
        found = read(material).diffuse.texture
        np.testing.assert_allclose((*found.tiling, *found.offset), (1 / 2, 1 / 3, -1 / 8, -1 / 6),
                                   rtol=1e-6)

    def test_images_do_not_tint_plain_reflections(self):
        material, _ = textured("Gold", checker(), GLOSSY)
        with self.assertRaises(NotPlain):
            read(material)


class PictureTest(SceneTest):
    """Materials beside Cycles and known answers."""

    def setUp(self):
        super().setUp()
        self.camera((0, 0, 9), ortho_scale=4.0)

    def test_texture_lies_as_in_cycles(self):
        pixels = np.random.default_rng(1).random((8, 8, 4)).astype(np.float32)
        pixels[..., 3] = 1.0
        for settings in ({}, {"extension": "EXTEND"}, {"extension": "CLIP"},
                         {"interpolation": "Closest"}):
            with self.subTest(**settings):
                material, texture = textured("T", image("Noise", pixels, non_color=True),
                                             **settings)
                mapping = material.node_tree.nodes.new("ShaderNodeMapping")
                mapping.inputs["Scale"].default_value = (1.5, 1.25, 1)
                mapping.inputs["Location"].default_value = (-0.2, 0.1, 0)
                coordinates = material.node_tree.nodes.new("ShaderNodeTexCoord")
                material.node_tree.links.new(coordinates.outputs["UV"], mapping.inputs["Vector"])
                material.node_tree.links.new(mapping.outputs[0], texture.inputs["Vector"])
                plane = self.plane("Plane", 4, material)
                self.scene.kestrel.samples = 64
                self.scene.kestrel.pixel_filter = "box"
                self.scene.kestrel.filter_width = 1.0
                error = np.abs(self.render() - self.render_cycles(256))[..., :3]
                self.assertLess(error.mean(), 0.01)
                bpy.data.objects.remove(plane)

    def test_mask_cuts_holes(self):
        material = principled("Leaf", Specular=0.0, Roughness=1.0)
        tree = material.node_tree
        texture = tree.nodes.new("ShaderNodeTexImage")
        texture.image, texture.interpolation = checker(alpha=True), "Closest"
        node = next(n for n in tree.nodes if n.type == "BSDF_PRINCIPLED")
        tree.links.new(texture.outputs["Color"], node.inputs["Base Color"])
        tree.links.new(texture.outputs["Alpha"], node.inputs["Alpha"])
        self.plane("Leaf", 4, material)
        self.plane("Behind", 8, emission("Blue", (0, 0, 1)), Matrix.Translation((0, 0, -1)))
        self.light("SUN", math.pi)
        picture = self.render()
        self.assert_color(picture[24, 8], (1, 0, 0), 1e-2)
        self.assert_color(picture[24, 24], (0, 1, 0), 1e-2)
        self.assert_color(picture[8, 8], (0, 0, 1))

    def test_threshold_of_clipped_alpha(self):
        material, texture = textured("Soft", checker(), "ShaderNodeBsdfPrincipled")
        material.blend_method = "CLIP"
        if material.blend_method != "CLIP":
            self.skipTest("Blender has no clipped alpha from 4.2 on")
        pixels = np.ones((4, 4, 4), np.float32)
        pixels[..., 3] = 0.4
        texture.image = image("Thin", pixels)
        tree = material.node_tree
        tree.links.new(texture.outputs["Alpha"], tree.nodes["Principled BSDF"].inputs["Alpha"])
        self.scene.view_layers[0].use_pass_z = True
        self.plane("Plane", 4, material)
        for threshold, depth in ((0.3, 9.0), (0.5, 1e10)):
            material.blend_method, material.alpha_threshold = "CLIP", threshold
            planes = self.render_planes()
            self.assertAlmostEqual(float(planes["ViewLayer.Depth.Z"][16, 16]) / depth, 1.0, 4)

    def test_alpha_blend(self):
        """What is behind shines through as much as the image says, where the artist wants that."""
        pixels = np.ones((4, 4, 4), np.float32)
        pixels[..., 3] = 0.25
        material, texture = textured("Soft", image("Thin", pixels), "ShaderNodeBsdfPrincipled")
        material.blend_method = "BLEND"
        tree = material.node_tree
        tree.links.new(texture.outputs["Alpha"], tree.nodes["Principled BSDF"].inputs["Alpha"])
        self.plane("Plane", 4, material)
        self.plane("Behind", 8, emission("White", (1, 1, 1)), Matrix.Translation((0, 0, -1)))
        self.assert_color(self.render()[16, 16], 0.75, 5e-3)

    def test_mask_by_other_images(self):
        """Holes from an image of another size, by its alpha or brightness, either way round."""
        pixels = np.ones((8, 8, 4), np.float32)
        pixels[4:, :, :] = 0.0
        mask = image("Mask", pixels, non_color=True)
        self.plane("Behind", 8, emission("Blue", (0, 0, 1)), Matrix.Translation((0, 0, -1)))
        for output in ("Alpha", "Color"):
            for inverted in (False, True):
                for colored in (False, True):
                    with self.subTest(output=output, inverted=inverted, colored=colored):
                        plane = self.plane("Leaf", 4, self.leaf(mask, output, inverted, colored))
                        picture = self.render()
                        bpy.data.objects.remove(plane)
                        solid, hole = (8, 24) if inverted else (24, 8)
                        left = (1, 0, 0) if colored else (1, 1, 0)
                        self.assert_color(picture[solid, 8], left)
                        self.assert_color(picture[hole, 8], (0, 0, 1))

    def leaf(self, mask, output_name, inverted, colored):
        material, tree, output = new_material("Leaf")
        clear, shader, mix, holes = (tree.nodes.new(f"ShaderNode{kind}") for kind in (
            "BsdfTransparent", "Emission", "MixShader", "TexImage"))
        shader.inputs["Color"].default_value = (1, 1, 0, 1)
        holes.image, holes.interpolation = mask, "Closest"
        if colored:
            texture = tree.nodes.new("ShaderNodeTexImage")
            texture.image, texture.interpolation = checker(), "Closest"
            tree.links.new(texture.outputs["Color"], shader.inputs["Color"])
        tree.links.new(holes.outputs[output_name], mix.inputs[0])
        first, second = (shader, clear) if inverted else (clear, shader)
        tree.links.new(first.outputs[0], mix.inputs[1])
        tree.links.new(second.outputs[0], mix.inputs[2])
        tree.links.new(mix.outputs[0], output.inputs["Surface"])
        return material

    def test_mirror_shows_what_is_opposite(self):
        self.plane("Mirror", 4, shader_material("M", GLOSSY, Color=(1, 1, 1), Roughness=0.0))
        self.plane("Ceiling", 40, emission("Sky", (0.2, 0.4, 0.8)), Matrix.Translation((0, 0, 20)))
        self.assert_color(self.render()[16, 16], (0.2, 0.4, 0.8))

    def test_constant_alpha_lets_the_rest_through(self):
        self.plane("Film", 4, principled("Film", Base_Color=(0, 0, 0), Specular=0.0, Alpha=0.25))
        self.plane("Behind", 8, emission("White", (1, 1, 1)), Matrix.Translation((0, 0, -1)))
        self.assert_color(self.render()[16, 16], 0.75)

    def test_normal_map_tilts_the_light(self):
        angle = math.radians(40)
        pixels = np.ones((4, 4, 4), np.float32)
        pixels[..., :3] = (0.5 + 0.5 * math.sin(angle), 0.5, 0.5 + 0.5 * math.cos(angle))
        material, tree, output = new_material("Bumpy")
        shader = tree.nodes.new("ShaderNodeBsdfDiffuse")
        shader.inputs["Color"].default_value = (1, 1, 1, 1)
        texture, normal = (tree.nodes.new(f"ShaderNode{kind}") for kind in
                           ("TexImage", "NormalMap"))
        texture.image = image("Tilt", pixels, non_color=True)
        tree.links.new(texture.outputs["Color"], normal.inputs["Color"])
        tree.links.new(normal.outputs["Normal"], shader.inputs["Normal"])
        tree.links.new(shader.outputs[0], output.inputs["Surface"])
        self.plane("Plane", 4, material)
        self.light("SUN", math.pi)
        self.assert_color(self.render()[16, 16], math.cos(angle), 1e-2)

    def test_material_that_casts_no_shadow(self):
        white = diffuse("White", (1, 1, 1))
        self.plane("Floor", 4, white)
        self.plane("Above", 4, diffuse("Above", (1, 1, 1)), Matrix.Translation((0, 0, 3)))
        self.scene.camera.matrix_world.translation.z = 2.0
        self.light("SUN", math.pi)
        self.assert_color(self.render()[16, 16], 0.0)
        bpy.data.materials["Above"].kestrel.casts_shadow = False
        self.assert_color(self.render()[16, 16], 1.0)


class HighlightTest(unittest.TestCase):
    def test_peak_is_the_microfacet_models(self):
        """F0 / (4 r⁴) at normal incidence, GGX and Fresnel of Cycles."""
        for roughness in (0.4, 0.6, 0.9):
            specular, exponent = sync_surface.highlight((0.04,) * 3, roughness)
            self.assertAlmostEqual(specular[0], 0.04 / (4 * roughness ** 4),
                                   4 if exponent > 1 else 1)
