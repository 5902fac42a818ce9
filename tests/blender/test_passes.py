# SPDX-License-Identifier: GPL-3.0-or-later
"""Every pass is offered to the compositor and written, with the right values."""

import math

import bpy
import numpy as np
from kestrel import compat, passes, session
from mathutils import Matrix
from support import SceneTest, diffuse, emission, shader_material


class PassTest(SceneTest):
    def setUp(self):
        super().setUp()
        self.layer = self.scene.view_layers[0]

    def switch_all_on(self):
        for item in passes.PASSES:
            if item.toggle:
                setattr(self.layer, item.toggle, True)
        self.layer.kestrel.passes = {item.name for item in passes.OPTIONAL}

    def pass_of(self, planes, name):
        """A pass as height x width x channels."""
        item = next(p for p in passes.PASSES if p.name == name)
        prefix = f"{self.layer.name}.{compat.pass_name(self.scene, item.blender_name)}."
        return np.stack([planes[prefix + channel] for channel in item.channels], axis=-1)

    def test_table_is_the_librarys(self):
        self.camera()
        self.render()
        core = next(iter(session._sessions.values()))
        offered = core.renderer.passes()
        self.assertEqual({item.name for item in passes.PASSES}, set(offered))
        for item in passes.PASSES:
            self.assertTrue(offered[item.name].startswith(item.channels), item.name)

    def test_all_are_written(self):
        self.camera((0, 0, 5))
        self.light("SUN", math.pi)
        grey = diffuse("Grey", (0.5, 0.25, 0.125))
        plane = self.plane("Plane", 1, grey)
        plane.pass_index, grey.pass_index = 7, 9
        mist = self.world((0, 0, 0))[0].mist_settings
        mist.start, mist.depth, mist.falloff = 4.0, 5.0, "LINEAR"
        self.switch_all_on()
        planes = self.render_planes()
        written = passes.enabled(self.layer)
        self.assertEqual({item.name for item in passes.PASSES} - {item.name for item in written},
                         {f"Crypto{kind}{depth:02}" for kind in ("Object", "Material", "Asset")
                          for depth in range(3, 8)})  # six levels
        middle = {item.name: self.pass_of(planes, item.name)[16, 16] for item in written}
        corner = {item.name: self.pass_of(planes, item.name)[0, 0] for item in written}
        half = 0.5 * 36 / 50 * 5 / 32  # half a pixel on the plane, which is one metre wide
        for name, value in (("Combined", (0.5, 0.25, 0.125, 1)), ("Normal", (0, 0, 1)),
                            ("Depth", [5.0]), ("Emission", (0, 0, 0)),
                            ("Ambient", (0.5, 0.25, 0.125)), ("Diffuse", (0.5, 0.25, 0.125)),
                            ("Specular", (0, 0, 0, 0)), ("Optical", (0, 1, 1)),
                            ("Lighting", (0.5, 0.25, 0.125)), ("Shadow", (1, 1, 1)),
                            ("Reflection", (0, 0, 0)), ("Refraction", (0, 0, 0)),
                            ("HeuristicMask", [1.0]), ("ObjectId", [1.0]),
                            ("Mist", [0.2]), ("ObjectIndex", [7.0]), ("MaterialIndex", [9.0]),
                            ("DenoisingAlbedo", (0.5, 0.25, 0.125)),
                            ("DenoisingNormal", (0, 0, -1)), ("UV", (0.5 + half, 0.5 - half, 1))):
            np.testing.assert_allclose(middle[name], value, atol=1e-3, err_msg=name)
        self.assertLess(np.abs(middle["Position"]).max(), 0.1)
        self.assertEqual(corner["Depth"][0], 1e10)
        self.assertEqual(corner["Mist"][0], 1.0)
        for name in ("ObjectId", "ObjectIndex", "MaterialIndex", "UV", "Normal", "Position",
                     "DenoisingAlbedo", "DenoisingNormal", "Diffuse", "CryptoObject00"):
            self.assertEqual(np.abs(corner[name]).max(), 0.0, name)
        self.assertEqual(corner["ReversedDepth"][0], 0.0)
        self.assertGreater(middle["ReversedDepth"][0], 0.0)

    def test_effects(self):
        """A mirror on the left, glass on the right, a shadow on the floor between."""
        self.camera((0, 0, 9), ortho_scale=4.0)
        self.plane("Floor", 8, diffuse("White", (1, 1, 1)))
        self.plane("Roof", 1, diffuse("Roof", (1, 1, 1)), Matrix.Translation((0, 0, 1)))
        glass = shader_material("Glass", "ShaderNodeBsdfGlass", IOR=1.0, Roughness=0.0)
        self.plane("Glass", 1, glass, Matrix.Translation((1.4, 0, 0.5)))
        self.light("SUN", math.pi, (0.5, 0, 1))
        self.switch_all_on()
        planes = self.render_planes()
        shadow = self.pass_of(planes, "Shadow")[..., 0]
        self.assertLess(shadow.min(), 0.2)
        self.assertEqual(shadow[2, 2], 1.0)
        self.assertGreater(self.pass_of(planes, "Refraction")[16, 27].min(), 0.1)

    def test_only_what_is_switched_on(self):
        self.camera()
        self.layer.use_pass_z = False
        names = {name.split(".")[1] for name in self.render_planes() if "." in name}
        self.assertEqual(names, {"Combined"})
        self.layer.kestrel.passes = {"Lighting"}
        self.layer.use_pass_shadow = True
        names = {name.split(".")[1] for name in self.render_planes() if "." in name}
        self.assertEqual(names, {"Combined", "Lighting", "Shadow"})

    def test_switches_that_kestrel_has_nothing_for(self):
        self.camera()
        self.world((1, 1, 1))
        self.layer.use_pass_glossy_direct = self.layer.use_pass_environment = True
        planes = self.render_planes()
        self.assertEqual(planes[f"{self.layer.name}.Combined.R"].min(), 1.0)

    def test_compositor_has_the_sockets(self):
        self.switch_all_on()
        tree, picture = self.compositor()
        layers, denoise = (tree.nodes.new(kind) for kind in ("CompositorNodeRLayers",
                                                             "CompositorNodeDenoise"))
        self.layer.update_render_passes()
        offered = {socket.name for socket in layers.outputs if socket.enabled}
        self.assertLessEqual({item.blender_name for item in passes.OPTIONAL}, offered)
        for name, source in (("Image", "Image"), ("Normal", "Denoising Normal"),
                             ("Albedo", "Denoising Albedo")):
            tree.links.new(layers.outputs[source], denoise.inputs[name])
        tree.links.new(denoise.outputs["Image"], picture)
        self.camera((0, 0, 5))
        self.plane("Glow", 9, emission("Glow", (0.25, 0.5, 0.75)))
        self.assert_color(self.render(), (0.25, 0.5, 0.75), 1e-2)

    def test_each_view_layer_has_its_own(self):
        self.camera((0, 0, 9), ortho_scale=4.0)
        for index, (name, color) in enumerate((("A", (1, 0, 0)), ("B", (0, 1, 0)))):
            collection = bpy.data.collections.new(name)
            self.scene.collection.children.link(collection)
            plane = self.plane(name, 8, emission(name, color))
            self.scene.collection.objects.unlink(plane)
            collection.objects.link(plane)
        second = self.scene.view_layers.new("Second")
        self.layer.layer_collection.children["B"].exclude = True
        second.layer_collection.children["A"].exclude = True
        second.kestrel.passes = {"ObjectId"}
        planes = self.render_planes()
        self.assertEqual(planes[f"{self.layer.name}.Combined.R"].min(), 1.0)
        self.assertEqual(planes["Second.Combined.G"].min(), 1.0)
        self.assertEqual(planes["Second.ObjectId.X"].min(), 1.0)
        self.assertNotIn(f"{self.layer.name}.ObjectId.X", planes)
