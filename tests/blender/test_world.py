# SPDX-License-Identifier: GPL-3.0-or-later
"""The world as background and as ambient light."""

import math

import bpy
import numpy as np
from kestrel.sync.image import mean_radiance
from support import SceneTest, diffuse, image


class WorldTest(SceneTest):
    def environment(self, pixels, rotation_z=None, vector_type="POINT"):
        """World of an equirectangular image, height x width x 4, first row at the bottom."""
        world, background = self.world((0, 0, 0))
        if hasattr(world, "cycles"):
            world.cycles.sampling_method = "NONE"  # takes seconds, and nothing is lit
        nodes, links = world.node_tree.nodes, world.node_tree.links
        texture = nodes.new("ShaderNodeTexEnvironment")
        texture.image = image("Environment", pixels, non_color=True, is_float=True)
        links.new(texture.outputs["Color"], background.inputs["Color"])
        if rotation_z is not None:
            mapping, coordinates = (nodes.new(f"ShaderNode{kind}") for kind in
                                    ("Mapping", "TexCoord"))
            mapping.vector_type = vector_type
            mapping.inputs["Rotation"].default_value = (0.2, -0.3, rotation_z)
            links.new(coordinates.outputs["Generated"], mapping.inputs["Vector"])
            links.new(mapping.outputs["Vector"], texture.inputs["Vector"])

    def gradient(self):
        """Smooth in every direction, all corners of the sphere different."""
        v, u = np.mgrid[0:32, 0:64] / np.array([32, 64]).reshape(2, 1, 1)
        turn = 2 * math.pi * u
        pixels = np.ones((32, 64, 4), np.float32)
        pixels[..., 0] = 0.5 + 0.5 * np.cos(turn)
        pixels[..., 1] = 0.5 + 0.5 * np.sin(turn)
        pixels[..., 2] = v
        return pixels

    def test_no_world_is_black(self):
        self.camera()
        self.assert_color(self.render(), 0.0)

    def test_color_and_strength(self):
        self.camera()
        self.world((0.1, 0.2, 0.4), 2.0)
        self.assert_color(self.render(), (0.2, 0.4, 0.8))

    def test_uniform_world_lights_by_its_radiance(self):
        self.camera()
        self.world((0.5, 1.0, 2.0), 0.5)
        self.plane(size=20, material=diffuse("Grey", (0.5, 0.5, 0.25)))
        self.assert_color(self.render(), (0.125, 0.25, 0.25))

    def test_environment_lies_as_in_cycles(self):
        for arguments in ((), (0.7,), (0.7, "TEXTURE")):
            for target in ((1, 0.2, 0.1), (-1, -2, 0.5), (0, 1, -0.7)):
                with self.subTest(arguments=arguments, target=target):
                    self.environment(self.gradient(), *arguments)
                    self.camera((0, 0, 0), target, lens=18.0)
                    error = np.abs(self.render() - self.render_cycles(4))[..., :3]
                    self.assertLess(error.mean(), 0.003)
                    self.assertLess(np.quantile(error, 0.98), 0.02)

    def test_ambient_light_of_an_environment_is_its_mean(self):
        """Upper half of the sphere white, lower half black: mean a half, whatever the image's
        shape; a cap of 60 degrees around the pole: a quarter."""
        for share, mean in ((1 / 2, 0.5), (1 / 3, 0.25)):
            pixels = np.zeros((60, 8, 4), np.float32)
            pixels[round(60 * (1 - share)):] = 1.0
            np.testing.assert_allclose(mean_radiance(image("Cap", pixels, is_float=True)),
                                       [mean] * 3, rtol=2e-3)
        self.camera()
        self.environment(pixels)
        self.plane(size=20, material=diffuse("White", (1, 1, 1)))
        self.assert_color(self.render(), 0.25, 5e-3)

    def test_world_without_nodes(self):
        self.camera()
        world = bpy.data.worlds.new("Plain")
        world.color = (0.3, 0.2, 0.1)
        self.scene.world = world
        if not world.use_nodes:
            self.assert_color(self.render(), (0.3, 0.2, 0.1))
