# SPDX-License-Identifier: GPL-3.0-or-later
"""Ray visibility, holdouts, indirect-only collections and the transparent film, beside Cycles."""

import bpy
import numpy as np
from mathutils import Matrix
from support import SceneTest, diffuse, emission, shader_material, turned

MIRROR = {"kind": "ShaderNodeBsdfGlossy", "Color": (1.0, 1.0, 1.0), "Roughness": 0.0}
GLASS = {"kind": "ShaderNodeBsdfGlass", "Color": (1.0, 1.0, 1.0), "Roughness": 0.0, "IOR": 1.45}


class RayVisibilityTest(SceneTest):
    """Seen from the front: a lamp card before a mirror wall, and its shadow on the floor."""

    def setUp(self):
        super().setUp()
        self.world((0.2, 0.4, 0.6))
        self.camera((0, -6, 3), target=(0, 0, 0.7), lens=40.0)
        self.plane("Floor", 12, diffuse("Floor", (0.8, 0.8, 0.8)))
        self.plane("Mirror", 3, shader_material("Mirror", **MIRROR),
                   Matrix.Translation((0, 2.5, 1)) @ turned(90))
        self.box = self.cube("Box", 0.8, diffuse("Red", (0.9, 0.1, 0.1)),
                             Matrix.Translation((-0.5, 0, 0.5)))
        self.light("SUN", 3.0, (2, -2, 4), (0, 0, 0))

    def collection_layer(self):
        """The box alone in a collection; returns its settings in the view layer."""
        collection = bpy.data.collections.new("Box")
        self.scene.collection.children.link(collection)
        self.scene.collection.objects.unlink(self.box)
        collection.objects.link(self.box)
        return bpy.context.view_layer.layer_collection.children["Box"]

    def assert_like_cycles(self):
        """Nearly all pixels: diffuse light between surfaces and the edges differ."""
        self.scene.world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.0
        self.scene.kestrel.samples = 16
        mine, cycles = self.render(), self.render_cycles(16)
        close = (np.abs(mine - cycles) < 0.03).all(axis=-1)
        self.assertGreater(close.mean(), 0.93)
        return mine

    def test_switches_act_as_in_cycles(self):
        whole = self.render()
        for switch in ("visible_camera", "visible_shadow", "visible_glossy"):
            with self.subTest(switch):
                setattr(self.box, switch, False)
                self.assertGreater(np.abs(self.assert_like_cycles() - whole).max(), 0.2)
                setattr(self.box, switch, True)

    def test_transmission(self):
        self.plane("Glass", 4, shader_material("Glass", **GLASS),
                   Matrix.Translation((0, -2, 1)) @ turned(90))
        whole = self.render()
        self.box.visible_transmission = False
        gone = self.render()
        self.assertGreater((np.abs(gone - whole).max(axis=-1) > 0.1).mean(), 0.02)
        self.box.visible_transmission, self.box.visible_camera = True, False
        np.testing.assert_array_equal(self.render(), whole)

    def test_holdout(self):
        self.box.is_holdout = True
        picture = self.assert_like_cycles()
        hole = picture[..., 3] == 0.0
        self.assertGreater(hole.mean(), 0.01)
        self.assert_color(picture[hole], 0.0)

    def test_collection_holdout_and_indirect_only(self):
        self.box.is_holdout = True
        expected = self.render()
        self.box.is_holdout = False
        layer = self.collection_layer()
        layer.holdout = True
        np.testing.assert_array_equal(self.render(), expected)
        layer.holdout = False
        self.box.visible_camera = False
        expected = self.render()
        self.box.visible_camera, layer.indirect_only = True, True
        np.testing.assert_array_equal(self.render(), expected)

    def test_instances_follow_object_and_instancer(self):
        layer = self.collection_layer()
        collection = layer.collection
        layer.exclude = True
        empty = self.link("Empty", None)
        empty.instance_type, empty.instance_collection = "COLLECTION", collection
        whole = self.render()
        for owner in (self.box, empty):
            owner.visible_camera = False
            self.assertGreater(np.abs(self.render() - whole).max(), 0.2)
            owner.visible_camera = True
        np.testing.assert_array_equal(self.render(), whole)


class FilmTest(SceneTest):
    def test_transparent_film_is_that_of_cycles(self):
        """A solid, a veil, a glass and a mirror before the world."""
        self.world((0.2, 0.4, 0.6))
        veil = shader_material("Veil", "ShaderNodeBsdfTransparent", Color=(1.0, 1.0, 1.0))
        if hasattr(veil, "blend_method"):
            veil.blend_method = "BLEND"
        self.scene.render.film_transparent = True
        self.camera((0, 0, 5), ortho_scale=5.0)
        for x, material in ((-1.5, emission("Solid", (1, 0.5, 0))), (-0.5, veil),
                            (0.5, shader_material("Glass", **GLASS)),
                            (1.5, shader_material("Mirror", **MIRROR))):
            self.plane(f"Plane{x}", 0.8, material, Matrix.Translation((x, 0, 0)))
        mine, cycles = self.render(), self.render_cycles(64)
        for x in (6, 12, 19, 25, 1):
            with self.subTest(x=x):
                self.assertAlmostEqual(mine[16, x, 3], cycles[16, x, 3], 2)
                if x != 19:  # Kestrel's glass reflects no light of its own at its front
                    self.assert_color(mine[16, x], cycles[16, x, :3], 0.01)
        self.scene.render.film_transparent = False
        self.assertTrue((self.render()[..., 3] == 1.0).all())
