# SPDX-License-Identifier: GPL-3.0-or-later
"""Several UV maps, and colour attributes: values worked out by hand, and pictures by Cycles."""

import math

import numpy as np
from kestrel import session
from mathutils import Matrix
from support import SceneTest, image, new_material, turned

SQUARE = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], np.float32)


class AttributeTest(SceneTest):
    """A plane of 4 x 4 m fills the picture; its corners start at the lower left."""

    def setUp(self):
        super().setUp()
        self.camera((0, 0, 9), ortho_scale=4.0)
        self.object = self.plane("Plane", 4.0)
        self.data = self.object.data
        self.material, self.tree, output = new_material("Material")
        self.data.materials.append(self.material)
        self.surface = output.inputs["Surface"]

    def node(self, kind, **settings):
        made = self.tree.nodes.new(kind)
        for name, value in settings.items():
            setattr(made, name, value)
        return made

    def shader(self, color, kind="ShaderNodeEmission"):
        """A shader whose first input is this socket."""
        made = self.node(kind)
        self.tree.links.new(color, made.inputs[0])
        return made

    def show(self, shader):
        self.tree.links.new(shader.outputs[0], self.surface)

    def uv_map(self, name, uvs):
        layer = self.data.uv_layers.new(name=name)
        layer.data.foreach_set("uv", np.ravel(uvs).astype(np.float32))
        return layer

    def colors(self, name, values, kind="FLOAT_COLOR", domain="CORNER"):
        """A colour attribute of RGB values, scene-linear."""
        made = self.data.color_attributes.new(name, kind, domain)
        made.data.foreach_set("color", np.ravel(
            [(*value, 1.0) for value in values]).astype(np.float32))
        return made

    def texture(self, picture, uv_map=None):
        """The colour of an image, looked up along a UV map."""
        made = self.node("ShaderNodeTexImage", image=picture, interpolation="Closest")
        if uv_map is not None:
            source = self.node("ShaderNodeUVMap", uv_map=uv_map)
            self.tree.links.new(source.outputs[0], made.inputs["Vector"])
        return made.outputs["Color"]

    def random_image(self, seed, non_color=False):
        pixels = np.random.default_rng(seed).random((4, 4, 4)).astype(np.float32)
        pixels[..., 3] = 1.0
        return image(f"Image{seed}", pixels, non_color=non_color)

    def pictures(self):
        """By rasterising and by rays, which must be the same."""
        made = []
        for primary in ("raster", "rays"):
            self.scene.kestrel.primary = primary
            made.append(self.render())
        np.testing.assert_allclose(*made, atol=4e-3)
        return made[1]

    def assert_as_cycles(self, tolerance=4e-3):
        shown = self.pictures()
        cycles = self.render_cycles(4)
        self.assertGreater(np.abs(cycles[..., :3]).mean(), 0.05)
        self.assertLess(np.abs(shown - cycles)[..., :3].mean(), tolerance)


class UvMapTest(AttributeTest):
    def test_image_along_a_named_map(self):
        self.uv_map("Turned", np.roll(SQUARE, 1, axis=0) * 0.5 + 0.25)
        self.show(self.shader(self.texture(self.random_image(1), "Turned")))
        self.assert_as_cycles()

    def test_images_along_two_maps(self):
        self.uv_map("Turned", np.roll(SQUARE, 1, axis=0))
        add = self.node("ShaderNodeAddShader")
        glow = self.shader(self.texture(self.random_image(1), "Turned"))
        matte = self.shader(self.texture(self.random_image(2), "UVMap"), "ShaderNodeBsdfDiffuse")
        self.tree.links.new(glow.outputs[0], add.inputs[0])
        self.tree.links.new(matte.outputs[0], add.inputs[1])
        self.show(add)
        self.light("SUN", math.pi)
        self.assert_as_cycles()

    def test_map_through_an_attribute_node(self):
        self.uv_map("Turned", np.roll(SQUARE, 1, axis=0))
        color = self.texture(self.random_image(1))
        source = self.node("ShaderNodeAttribute", attribute_name="Turned")
        self.tree.links.new(source.outputs["Vector"], color.node.inputs["Vector"])
        self.show(self.shader(color))
        self.assert_as_cycles()

    def test_map_that_the_mesh_lacks(self):
        """All of it shows the image's lower left corner, as in Cycles."""
        picture = self.random_image(1)
        self.show(self.shader(self.texture(picture, "Missing")))
        self.assert_as_cycles()

    def test_two_meshes_with_the_map_in_different_places(self):
        self.uv_map("Turned", np.roll(SQUARE, 1, axis=0))
        other = self.mesh("Other", [(0, -2, 1), (2, -2, 1), (2, 2, 1), (0, 2, 1)], [(0, 1, 2, 3)],
                          self.material)
        layer = other.data.uv_layers.new(name="Turned")
        layer.data.foreach_set("uv", np.ravel(SQUARE))
        self.show(self.shader(self.texture(self.random_image(1), "Turned")))
        self.assert_as_cycles()

    def test_normal_map_along_a_named_map(self):
        """Tangents follow the normal map node's UV map, which here is turned by 90 degrees."""
        self.uv_map("Turned", np.roll(SQUARE, 1, axis=0))
        pixels = np.full((2, 2, 4), (0.8, 0.5, 0.9, 1.0), np.float32)
        color = self.texture(image("Normals", pixels, non_color=True), "Turned")
        matte = self.node("ShaderNodeBsdfDiffuse")
        self.light("SUN", math.pi, (1, 0.5, 1))
        for uv_map in ("Turned", ""):
            with self.subTest(uv_map):
                bump = self.node("ShaderNodeNormalMap", uv_map=uv_map)
                self.tree.links.new(color, bump.inputs["Color"])
                self.tree.links.new(bump.outputs[0], matte.inputs["Normal"])
                self.show(matte)
                self.assert_as_cycles(0.02)

    def test_only_maps_in_use_are_sent(self):
        for i in range(5):
            self.uv_map(f"Map{i}", SQUARE)
        self.show(self.shader(self.texture(self.random_image(1), "Map3")))
        self.render()
        core = next(iter(session._sessions.values()))
        content = next(value for key, value in core.sent.items() if key[0] == 0)
        self.assertEqual(len(content[-1]), 1)

    def test_map_that_comes_into_use_later(self):
        """A change of the material alone brings the mesh's other map along."""
        self.uv_map("Turned", np.roll(SQUARE, 1, axis=0))
        color = self.texture(self.random_image(1), "UVMap")
        self.show(self.shader(color))
        self.render()
        color.node.inputs["Vector"].links[0].from_node.uv_map = "Turned"
        self.assert_as_cycles()


class ColorTest(AttributeTest):
    RAINBOW = ((1.0, 0.1, 0.0), (0.2, 0.8, 0.1), (0.0, 0.3, 0.9), (0.6, 0.5, 0.4))

    def color_node(self, name):
        return self.node("ShaderNodeVertexColor", layer_name=name).outputs["Color"]

    def test_kinds_and_domains(self):
        """Corners and points, bytes and floats: at the corners the colours, between them means."""
        for kind in ("FLOAT_COLOR", "BYTE_COLOR"):
            for domain in ("CORNER", "POINT"):
                name = f"{kind} {domain}"
                self.colors(name, self.RAINBOW, kind, domain)
                self.tree.nodes.clear()
                self.surface = self.node("ShaderNodeOutputMaterial").inputs["Surface"]
                self.show(self.shader(self.color_node(name)))
                with self.subTest(name):
                    picture = self.pictures()
                    for (row, column), color in zip(((31, 0), (31, 31), (0, 31), (0, 0)),
                                                    self.RAINBOW):
                        np.testing.assert_allclose(picture[row, column, :3], color, atol=0.04)
                    self.assert_as_cycles()

    def test_attribute_node_and_faces(self):
        mesh = self.data
        mesh.clear_geometry()
        mesh.from_pydata([(x, y, 0) for y in (-2, 2) for x in (-2, 0, 2)], [],
                         [(0, 1, 4, 3), (1, 2, 5, 4)])
        made = mesh.attributes.new("Faces", "FLOAT_VECTOR", "FACE")
        made.data.foreach_set("vector", [0.9, 0.4, 0.1, 0.2, 0.3, 0.8])
        node = self.node("ShaderNodeAttribute", attribute_name="Faces")
        self.show(self.shader(node.outputs["Color"]))
        picture = self.pictures()
        self.assert_color(picture[16, 8], (0.9, 0.4, 0.1))
        self.assert_color(picture[16, 24], (0.2, 0.3, 0.8))
        self.assert_as_cycles()

    def test_render_colour_without_a_name_and_missing_ones(self):
        self.colors("First", self.RAINBOW)
        self.colors("Second", self.RAINBOW[::-1])
        self.data.color_attributes.render_color_index = next(
            i for i, item in enumerate(self.data.color_attributes) if item.name == "Second")
        shader = self.shader(self.color_node(""))
        self.show(shader)
        self.assert_as_cycles()
        self.tree.links.new(self.color_node("Missing"), shader.inputs[0])
        self.assertEqual(self.pictures()[..., :3].max(), 0.0)

    def test_times_an_image_on_a_lit_surface(self):
        self.colors("Color", self.RAINBOW)
        mix = self.node("ShaderNodeMixRGB", blend_type="MULTIPLY")
        mix.inputs[0].default_value = 1.0
        self.tree.links.new(self.texture(self.random_image(3)), mix.inputs[1])
        self.tree.links.new(self.color_node("Color"), mix.inputs[2])
        self.show(self.shader(mix.outputs[0], "ShaderNodeBsdfDiffuse"))
        self.light("SUN", math.pi)
        self.assert_as_cycles()

    def test_principled_base_colour(self):
        self.colors("Color", self.RAINBOW, "BYTE_COLOR")
        shader = self.node("ShaderNodeBsdfPrincipled")
        for name in ("Specular", "Specular IOR Level"):
            if name in shader.inputs:
                shader.inputs[name].default_value = 0.0
        shader.inputs["Roughness"].default_value = 1.0
        self.tree.links.new(self.color_node("Color"), shader.inputs["Base Color"])
        self.show(shader)
        self.light("SUN", math.pi)
        self.assert_as_cycles(0.02)

    def test_in_a_mirror(self):
        """What rays meet has its colours too."""
        self.colors("Color", self.RAINBOW)
        self.show(self.shader(self.color_node("Color")))
        direct = self.pictures()
        self.object.matrix_world = Matrix.Translation((0, 0, 20)) @ turned(180)
        mirror = self.plane("Mirror", 4.0)
        material, tree, output = new_material("Mirror")
        glossy = tree.nodes.new("ShaderNodeBsdfGlossy")
        glossy.inputs["Color"].default_value = (1, 1, 1, 1)
        glossy.inputs["Roughness"].default_value = 0.0
        tree.links.new(glossy.outputs[0], output.inputs["Surface"])
        mirror.data.materials.append(material)
        np.testing.assert_allclose(self.pictures()[..., :3], direct[::-1, :, :3], atol=4e-3)

    def test_through_a_modifier(self):
        self.colors("Color", self.RAINBOW)
        subdivision = self.object.modifiers.new("Subdivision", "SUBSURF")
        subdivision.subdivision_type, subdivision.render_levels = "SIMPLE", 2
        self.show(self.shader(self.color_node("Color")))
        self.assert_as_cycles(0.02)
