# SPDX-License-Identifier: GPL-3.0-or-later
"""Lights in Blender's units: a white matte plane is as bright as by formula, and as in Cycles."""

import math
import unittest

import bpy
from kestrel import compat
from mathutils import Matrix
from support import SceneTest, diffuse, turned


class LightTest(SceneTest):
    size = (8, 8)

    def setUp(self):
        super().setUp()
        self.plane(size=40, material=diffuse("White", (1, 1, 1)))

    def middle(self, picture):
        return picture[3:5, 3:5, :3].mean(axis=(0, 1))

    def view(self, x=0.0):
        """Look straight down at a tiny patch at (x, 0)."""
        self.camera((x, 0, 9), (x, 0, 0), ortho_scale=0.02)

    def test_sun(self):
        self.view()
        self.light("SUN", 3.0, color=(1.0, 0.5, 0.25))
        self.assert_color(self.middle(self.render()),
                          [3.0 / math.pi * c for c in (1.0, 0.5, 0.25)])

    def test_sun_from_the_side(self):
        self.view()
        self.light("SUN", 2.0).matrix_world = turned(60)
        self.assert_color(self.middle(self.render()), 2.0 / math.pi * 0.5)

    def test_point(self):
        self.view()
        self.light("POINT", 100.0, (0, 0, 2))
        self.assert_color(self.middle(self.render()), 100.0 / (4 * math.pi ** 2) / 4)

    def test_spot_on_its_axis(self):
        self.view()
        self.light("SPOT", 100.0, (0, 0, 2), spot_size=0.8, spot_blend=0.3)
        self.assert_color(self.middle(self.render()), 100.0 / (4 * math.pi ** 2) / 4)

    def test_spot_has_a_cone(self):
        self.light("SPOT", 100.0, (0, 0, 2), spot_size=math.radians(60), spot_blend=0.0)
        inside, outside = 2 * math.tan(math.radians(28)), 2 * math.tan(math.radians(32))
        self.view(inside)
        self.assertGreater(self.middle(self.render()).min(), 0.1)
        self.view(outside)
        self.assert_color(self.middle(self.render()), 0.0)

    def test_area_light_far_away(self):
        self.view()
        self.light("AREA", 1000.0, (0, 0, 8), size=0.1)
        self.assert_color(self.middle(self.render()), 1000.0 / (4 * math.pi) / 64)

    def test_lights_are_as_bright_as_in_cycles(self):
        self.view(0.4)
        self.light("SUN", 1.5).matrix_world = turned(30)
        self.light("POINT", 60.0, (1, 1, 2), color=(1, 0.3, 0.2))
        self.assert_color(self.middle(self.render()), self.middle(self.render_cycles(1024)), 2e-3)

    def test_color_by_nodes(self):
        self.view()
        light = self.light("SUN", 1.0).data
        light.use_nodes = True
        node = next(n for n in light.node_tree.nodes if n.type == "EMISSION")
        node.inputs["Color"].default_value = (0.5, 1.0, 0.0, 1.0)
        node.inputs["Strength"].default_value = 2.0
        self.assert_color(self.middle(self.render()), [c / math.pi for c in (1.0, 2.0, 0.0)])

    def test_shadow_switch(self):
        self.view()
        self.plane("Blocker", 1, matrix=Matrix.Translation((0, 0, 1)))
        bpy.data.objects["Blocker"].matrix_world.translation.x = 0.0
        light = self.light("SUN", 3.0).data
        self.camera((0, 0, 0.5), ortho_scale=0.02)
        self.assert_color(self.middle(self.render()), 0.0)
        light.use_shadow = False
        self.assert_color(self.middle(self.render()), 3.0 / math.pi)

    def test_hidden_light_is_dark(self):
        self.view()
        self.light("SUN", 3.0).hide_render = True
        self.assert_color(self.middle(self.render()), 0.0)


class NewerLightTest(unittest.TestCase):
    """What lights of newer Blenders have on top, on a stand-in that has it in any version."""

    def test_exposure_and_temperature(self):
        class Light:
            exposure = 2.0
            use_temperature = True
            temperature_color = (1.0, 0.5, 0.25)
        self.assertEqual(list(compat.light_factor(Light())), [4.0, 2.0, 1.0])
        self.assertEqual(list(compat.light_factor(object())), [1.0, 1.0, 1.0])
