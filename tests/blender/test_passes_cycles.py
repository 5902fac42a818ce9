# SPDX-License-Identifier: GPL-3.0-or-later
"""Passes that Cycles has too hold what Cycles writes, whoever finds what a pixel shows."""

import math

import numpy as np
from kestrel import compat
from mathutils import Matrix
from support import SceneTest, diffuse, turned

# Pass (Blender's name before 5.0): channels, tolerance, absolute and relative.
COMPARED = {"Depth": ("Z", 2e-4), "Mist": ("Z", 1e-4), "Position": ("XYZ", 1e-3),
            "Normal": ("XYZ", 2e-3), "UV": ("UVA", 1e-3), "IndexOB": ("X", 0.0),
            "IndexMA": ("X", 0.0), "DiffCol": ("RGB", 1e-3), "Emit": ("RGB", 1e-3),
            "Denoising Normal": ("XYZ", 2e-3), "Denoising Albedo": ("RGB", 1e-3)}
TOGGLES = ("z", "mist", "position", "normal", "uv", "object_index", "material_index",
           "diffuse_color", "emit")
SAME_PIXELS = 0.99  # edges may fall into one pixel or the next


class PassesCycles(SceneTest):
    size = (64, 64)

    def setUp(self):
        super().setUp()
        self.layer = self.scene.view_layers[0]
        for name in TOGGLES:
            setattr(self.layer, f"use_pass_{name}", True)
        self.layer.kestrel.passes = {"DenoisingNormal", "DenoisingAlbedo"}
        self.layer.cycles.denoising_store_passes = True

    def objects(self, falloff):
        """A floor with UVs, a cube without, a plane seen from behind, and the sky."""
        floor = diffuse("Floor", (0.8, 0.4, 0.2))
        floor.pass_index = 3
        self.plane("Floor", 6, floor, turned(20)).pass_index = 12
        cube = self.cube("Cube", 1.2, diffuse("Cube", (0.1, 0.6, 0.3)),
                         Matrix.Translation((-0.8, 0, 0.9)) @ turned(30, "Z") @ turned(25))
        cube.pass_index = 32767
        back = self.plane("Back", 1.4, diffuse("Back", (0.3, 0.3, 0.9)),
                          Matrix.Translation((1.1, 0.3, 1.2)) @ turned(165))
        back.scale = (1, -1, 1)
        self.light("SUN", math.pi, (1, 2, 5))
        mist = self.world((0.2, 0.2, 0.2))[0].mist_settings
        mist.start, mist.depth, mist.falloff = 3.5, 6.0, falloff

    def planes_of(self, engine):
        """Each compared pass as height x width x channels."""
        cycles = self.scene.cycles
        cycles.samples, cycles.use_denoising, cycles.use_adaptive_sampling = 1, False, False
        cycles.pixel_filter_type, cycles.filter_width = "BLACKMAN_HARRIS", 0.01
        planes = self.render_planes(engine)
        result = {}
        for old, (channels, _) in COMPARED.items():
            prefix = f"{self.layer.name}.{compat.pass_name(self.scene, old)}."
            result[old] = np.stack([planes[prefix + channel] for channel in channels], axis=-1)
        return result

    def compare(self):
        wanted = self.planes_of("CYCLES")
        self.assertGreater((wanted["Depth"] == 1e10).sum(), 50)  # some sky
        for primary in ("rays", "raster"):
            self.scene.kestrel.primary = primary
            found = self.planes_of("KESTREL")
            for name, (_, tolerance) in COMPARED.items():
                same = np.isclose(found[name], wanted[name], tolerance, tolerance).all(axis=-1)
                self.assertGreaterEqual(same.mean(), SAME_PIXELS, f"{name}, primary {primary}")

    def test_perspective(self):
        self.objects("QUADRATIC")
        self.camera((0.5, -5, 3.5), (0, 0, 0.4), shift_x=0.1)
        self.compare()

    def test_orthographic(self):
        self.objects("INVERSE_QUADRATIC")
        self.camera((0.5, -5, 3.5), (0, 0, 0.4), ortho_scale=5.5)
        self.compare()
