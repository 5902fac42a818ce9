# SPDX-License-Identifier: GPL-3.0-or-later
"""Cryptomatte: ids by the specification, true coverage, metadata that files keep, and mattes that
Blender's own compositor picks."""

import json
import struct

import bpy
import exr
import numpy as np
from mathutils import Matrix
from support import SceneTest, diffuse, rgba

SAMPLES = 64
KINDS = ("object", "material", "asset")


def rotated(value, bits):
    return (value << bits | value >> (32 - bits)) & 0xffffffff


def murmur3(text):
    """MurmurHash3_x86_32 with seed 0, after its public description."""
    data = text.encode("utf-8")
    h = 0
    blocks = len(data) // 4
    for index in range(blocks):
        k, = struct.unpack_from("<I", data, 4 * index)
        k = rotated(k * 0xcc9e2d51 & 0xffffffff, 15) * 0x1b873593 & 0xffffffff
        h = (rotated(h ^ k, 13) * 5 + 0xe6546b64) & 0xffffffff
    k = int.from_bytes(data[4 * blocks:], "little")
    h ^= rotated(k * 0xcc9e2d51 & 0xffffffff, 15) * 0x1b873593 & 0xffffffff
    h ^= len(data)
    for shift, factor in ((16, 0x85ebca6b), (13, 0xc2b2ae35), (16, 1)):
        h = (h ^ h >> shift) * factor & 0xffffffff
    return h


def matte_id(name):
    """The id of a name: its hash's bits as a float, with an exponent from 1 to 254."""
    bits = murmur3(name)
    exponent = min(max(bits >> 23 & 255, 1), 254)
    return np.frombuffer(struct.pack("<I", bits & 0x807fffff | exponent << 23), "<f4")[0]


class CryptomatteTest(SceneTest):
    """A picture whose pixels are one metre wide: Left ends in the middle of column 16, where Right
    begins; Far lies behind both and sticks out above."""

    size = (32, 32)

    def setUp(self):
        super().setUp()
        self.layer = self.scene.view_layers[0]
        self.camera((0, 0, 50), ortho_scale=32.0)
        settings = self.scene.kestrel
        settings.samples, settings.pixel_filter, settings.filter_width = SAMPLES, "box", 1.0
        warm, cold = diffuse("Wärme \"1\"", (1, 0.5, 0)), diffuse("Cold", (0, 0.5, 1))
        at = Matrix.Translation
        parent = self.link("House", None)
        for name, x, material in (("Left", -7.5, warm), ("Right", 8.5, cold)):
            wall = self.plane(name, 16, material, at((x, -4, 1)))
            wall.parent = parent
        self.plane("Far", 24, None, at((0.5, 1.25, 0)))
        for kind in KINDS:
            setattr(self.layer, f"use_pass_cryptomatte_{kind}", True)

    def shares(self, planes, kind, passes=3):
        """Function from a name to the share that it covers of each pixel."""
        prefix = f"{self.layer.name}.Crypto{kind.title()}"
        slots = [(planes[f"{prefix}{index:02}.{a}"], planes[f"{prefix}{index:02}.{b}"])
                 for index in range(passes) for a, b in ("rg", "ba")]
        for first, second in zip(slots, slots[1:]):
            self.assertTrue((first[1] >= second[1]).all(), "not sorted")

        def share_of(name):
            return sum(np.where(ids == matte_id(name), weights, 0.0) for ids, weights in slots)
        return share_of

    def test_ids_and_coverage(self):
        planes = self.render_planes()
        share = self.shares(planes, "object")
        left, right, far = share("Left"), share("Right"), share("Far")
        # Row 0 is on top: Left and Right reach from y = -12 to 4, Far from -10.75 to 13.25.
        np.testing.assert_allclose(left[15, 1:16], 1.0)
        np.testing.assert_allclose(right[15, 17:32], 1.0)
        for matte in (left, right):
            self.assertAlmostEqual(matte[15, 16], 0.5, delta=2 / SAMPLES)
        self.assertEqual(far[15].max(), 0.0)
        np.testing.assert_allclose(far[8, 5:28], 1.0)
        self.assertAlmostEqual(far[2, 10], 0.25, delta=2 / SAMPLES)  # y from 13 to 14
        self.assertAlmostEqual(far[8, 28], 0.5, delta=2 / SAMPLES)   # x from 12 to 13
        self.assertEqual((left + right + far)[0].max(), 0.0)

    def test_materials_and_assets(self):
        planes = self.render_planes()
        objects, materials, assets = (self.shares(planes, kind) for kind in KINDS)
        np.testing.assert_array_equal(materials("Wärme \"1\""), objects("Left"))
        np.testing.assert_array_equal(materials("Cold"), objects("Right"))
        np.testing.assert_array_equal(materials("default_surface"), objects("Far"))
        np.testing.assert_allclose(assets("House"), objects("Left") + objects("Right"))
        np.testing.assert_array_equal(assets("Far"), objects("Far"))

    def test_clear_surfaces_cover_in_part(self):
        veil = bpy.data.objects["Left"].active_material
        tree = veil.node_tree
        mix, clear = (tree.nodes.new(kind) for kind in ("ShaderNodeMixShader",
                                                         "ShaderNodeBsdfTransparent"))
        solid = next(node for node in tree.nodes if node.type == "BSDF_DIFFUSE")
        output = next(node for node in tree.nodes if node.type == "OUTPUT_MATERIAL")
        mix.inputs[0].default_value = 0.25
        tree.links.new(solid.outputs[0], mix.inputs[1])
        tree.links.new(clear.outputs[0], mix.inputs[2])
        tree.links.new(mix.outputs[0], output.inputs[0])
        share = self.shares(self.render_planes(), "object")
        np.testing.assert_allclose(share("Left")[12:16, 2:9], 0.75, atol=1e-4)
        np.testing.assert_allclose(share("Far")[15, 5:9], 0.25, atol=1e-4)  # behind it
        self.assertEqual(share("Far")[15, :4].max(), 0.0)

    def test_levels(self):
        self.layer.pass_cryptomatte_depth = 2
        planes = self.render_planes()
        self.assertFalse([name for name in planes if "CryptoObject01" in name])
        share = self.shares(planes, "object", passes=1)
        self.assertAlmostEqual(share("Left")[15, 16], 0.5, delta=2 / SAMPLES)

    def test_file_says_what_the_ids_mean(self):
        self.render_planes()
        attributes, _ = exr.read_header((self.folder / "KESTREL.exr").read_bytes())
        for kind, names in (("Object", {"Left", "Right", "Far"}), ("Asset", {"House", "Far"}),
                            ("Material", {"Wärme \"1\"", "Cold", "default_surface"})):
            layer = f"{self.layer.name}.Crypto{kind}"
            key = f"cryptomatte/{murmur3(layer):08x}"[:-1]
            self.assertEqual(attributes[f"{key}/name"].decode(), layer)
            self.assertEqual(attributes[f"{key}/hash"].decode(), "MurmurHash3_32")
            self.assertEqual(attributes[f"{key}/conversion"].decode(), "uint32_to_float32")
            manifest = json.loads(attributes[f"{key}/manifest"].decode())
            self.assertLessEqual(names, set(manifest))
            for name, digits in manifest.items():
                self.assertEqual(bytes.fromhex(digits)[::-1], matte_id(name).tobytes(), name)

    def test_compositor_picks_the_matte(self):
        wanted = self.shares(self.render_planes(), "object")("Left")
        tree, picture = self.compositor()
        node = tree.nodes.new("CompositorNodeCryptomatteV2")
        node.scene = self.scene
        node.layer_name = f"{self.layer.name}.CryptoObject"
        node.matte_id = "Left"
        layers = tree.nodes.new("CompositorNodeRLayers")
        tree.links.new(layers.outputs["Image"], node.inputs["Image"])
        tree.links.new(node.outputs["Matte"], picture)
        np.testing.assert_allclose(rgba(self.render_planes(file_format="OPEN_EXR"))[..., 0], wanted,
                                   atol=1e-5)
