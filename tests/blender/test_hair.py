# SPDX-License-Identifier: GPL-3.0-or-later
"""Hair: curves objects and particle systems, against the tubes that they stand for."""

import math
import time

import bpy
import numpy as np
from kestrel import session, sync, tubes
from mathutils import Matrix
from support import SceneTest, diffuse, emission, image, look_at, textured, turned


def hair_curves(strands, radius=None):
    """Curves data of these strands, each a list of as many points."""
    if not hasattr(bpy.data.hair_curves.new("Hair"), "add_curves"):
        return None
    curves = bpy.data.hair_curves.new("Hair")
    curves.add_curves([len(strand) for strand in strands])
    curves.points.foreach_set("position", np.ravel(strands).astype(np.float32))
    if radius is not None:
        values = np.full(len(curves.points), radius, np.float32)
        curves.points.foreach_set("radius", values)
    return curves


class TubeTest(SceneTest):
    """The geometry alone."""

    def test_straight_tube_is_the_cylinder(self):
        points = np.array([[0, 0, 0], [0, 0, 2], [0, 0, 3]], np.float32)
        made = tubes.tubes(points, np.full(3, 0.5, np.float32), [3], 9)
        self.assertEqual(len(made.triangles), 2 * 2 * 9)
        corners = made.positions[made.triangles]
        faces = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        centre = corners.mean(axis=1)
        self.assertTrue(((faces * centre)[:, :2].sum(axis=1) > 0).all())  # they look outwards
        np.testing.assert_allclose(made.normals[:, 2], 0, atol=1e-6)
        np.testing.assert_allclose(np.linalg.norm(made.normals, axis=1), 1, atol=1e-5)
        # Its girth is the circle's: over all directions it looks as wide.
        area = 0.5 * np.linalg.norm(faces, axis=1).sum()
        self.assertAlmostEqual(area, 2 * math.pi * 0.5 * 3, 4)

    def test_what_is_left_out(self):
        """Points on their own, pieces without length, and the half of a piece that ends in a tip."""
        points = np.array([[5, 5, 5], [0, 0, 0], [0, 0, 0], [0, 0, 1]], np.float32)
        made = tubes.tubes(points, np.array([1, 1, 1, 0], np.float32), [1, 3], 3)
        self.assertEqual(len(made.triangles), 3)
        self.assertEqual(set(made.curves), {1})
        self.assertTrue(np.isfinite(made.normals).all())

    def test_smoothing_goes_through_the_points(self):
        points = np.array([[0, 0, 0], [1, 1, 0], [2, 0, 0], [7, 7, 7], [8, 8, 8]], np.float32)
        radii = np.array([1, 2, 3, 4, 5], np.float32)
        fine, fine_radii, counts = tubes.smooth(points, radii, [3, 2], 4)
        self.assertEqual(counts.tolist(), [9, 5])
        np.testing.assert_allclose(fine[[0, 4, 8, 9, 13]], points, atol=1e-6)
        np.testing.assert_allclose(fine_radii[[0, 4, 8, 9, 13]], radii, atol=1e-6)
        np.testing.assert_allclose(fine[9:, 0], fine[9:, 1], atol=1e-6)  # straight stays straight

    def test_frames_do_not_twist(self):
        """Along a helix, neighbouring rings are turned against each other by no more than the
        helix itself turns."""
        t = np.linspace(0, 4 * np.pi, 200)
        points = np.stack([np.cos(t), np.sin(t), 0.2 * t], axis=1).astype(np.float32)
        made = tubes.tubes(points, np.full(200, 0.05, np.float32), [200], 3)
        rings = made.positions.reshape(200, 3, 3) - points[:, None]
        along = (rings[1:] * rings[:-1]).sum(axis=2) / (rings[1:] ** 2).sum(axis=2)
        self.assertGreater(along.min(), math.cos(0.08))

    def test_many_strands_are_coarser(self):
        self.assertEqual(tubes.fineness(8, 4), (9, 4))
        self.assertEqual(tubes.fineness(10**7, 4), (3, 1))
        sides, steps = tubes.fineness(40_000, 4)
        self.assertLessEqual(2 * sides * steps * 40_000, tubes.MAX_TRIANGLES)


class PictureTest(SceneTest):
    size = (64, 64)

    def setUp(self):
        super().setUp()
        self.white = diffuse("White", (1, 1, 1))
        self.camera((0, 0, 9), ortho_scale=4.0)
        self.light("SUN", math.pi, (1, 2, 4))

    def cylinder(self, radius, length):
        """Along X, as a bevelled curve."""
        curve = bpy.data.curves.new("Cylinder", "CURVE")
        curve.dimensions, curve.bevel_depth, curve.bevel_resolution = "3D", radius, 30
        spline = curve.splines.new("POLY")
        spline.points.add(1)
        spline.points.foreach_set("co", [-length / 2, 0, 0, 1, length / 2, 0, 0, 1])
        curve.materials.append(self.white)
        return self.link("Cylinder", curve)

    def thick_hair(self, length=3.0, diameter=1.0):
        """One strand along X from a tiny emitter that is hidden, as a particle system."""
        emitter = self.mesh("Emitter", [(0, 1e-5, 1e-5), (0, -1e-5, 1e-5), (0, 0, -1e-5)],
                            [(0, 1, 2)], self.white, Matrix.Translation((-length / 2, 0, 0)))
        emitter.modifiers.new("Hair", "PARTICLE_SYSTEM")
        settings = emitter.particle_systems[0].settings
        settings.type, settings.count, settings.hair_length = "HAIR", 1, length
        settings.use_close_tip = False
        settings.root_radius = settings.tip_radius = 1.0
        settings.radius_scale = diameter
        emitter.show_instancer_for_render = False
        return emitter

    def assert_same(self, first, second):
        """Two pictures of one cylinder, nine-sided and round."""
        shown, expected = (picture[..., 0] for picture in (first, second))
        lit = expected > 0.01
        self.assertGreater(lit.mean(), 0.05)
        self.assertLess(((shown > 0.01) != lit).mean(), 0.02)
        self.assertLess(np.abs(shown - expected).mean(), 0.012)

    def test_one_thick_hair_is_a_cylinder(self):
        """Silhouette, shading and shadow."""
        self.plane("Wall", 8, self.white, Matrix.Translation((0, 0, -1)))
        hair = self.thick_hair()
        shown = self.render()
        hair.hide_render = True
        self.cylinder(0.5, 3.0)
        expected = self.render()
        self.assert_same(shown, expected)
        self.assertGreater((expected[..., 0] < 0.01).mean(), 0.05)  # the shadow

    def test_curves_object(self):
        data = hair_curves([[(-1.5, 0, 0), (0, 0, 0), (1.5, 0, 0)]], 0.5)
        if data is None:  # 3.4 can fill curves only through operators
            bpy.ops.object.curves_random_add()
            obj = bpy.context.object
            obj.data.materials.append(self.white)
            picture = self.render()[..., 0]
            self.assertGreater((picture > 0.01).mean(), 0.05)
            return
        data.materials.append(self.white)
        obj = self.link("Hair", data)
        shown = self.render()
        obj.hide_render = True
        self.cylinder(0.5, 3.0)
        self.assert_same(shown, self.render())

    def test_hair_has_the_material_of_its_slot(self):
        emitter = self.thick_hair()
        emitter.data.materials.append(emission("Red", (1, 0, 0)))
        emitter.particle_systems[0].settings.material = 2
        self.assert_color(self.render()[32, 32], (1, 0, 0))
        self.scene.view_layers[0].material_override = emission("Green", (0, 1, 0))
        self.assert_color(self.render()[32, 32], (0, 1, 0))

    def test_hair_moves_with_its_object_and_can_be_hidden(self):
        emitter = self.thick_hair(2.0)
        emitter.matrix_world = Matrix.Translation((0, 0, 0)) @ turned(90, "Z") @ (
            Matrix.Translation((-1, 0, 0)))
        picture = self.render()[..., 0] > 0.01
        self.assertTrue(picture[18, 32] and picture[46, 32])
        self.assertFalse(picture[32, 18] or picture[32, 46])
        emitter.modifiers[0].show_render = False
        self.assertEqual((self.render()[..., 0] > 0.01).sum(), 0)

    def test_radii_from_root_to_tip(self):
        """A cone: as wide as the setting at its root, nothing at its tip."""
        emitter = self.thick_hair()
        settings = emitter.particle_systems[0].settings
        settings.tip_radius = 0.0
        picture = self.render()[..., 0] > 0.01
        widths = picture.sum(axis=0)
        np.testing.assert_allclose(widths[[12, 24, 36, 48]] / 16.0,
                                   [1 - (column / 16.0 - 0.5) / 3.0
                                    for column in (12.5, 24.5, 36.5, 48.5)], atol=0.13)

    def test_children_take_the_place_of_their_parents(self):
        emitter = self.plane("Emitter", 2, self.white)
        emitter.modifiers.new("Hair", "PARTICLE_SYSTEM")
        settings = emitter.particle_systems[0].settings
        settings.type, settings.count = "HAIR", 10
        settings.child_type, settings.rendered_child_count = "INTERPOLATED", 7
        sent = []

        def count_triangles():
            session.drop_all()
            sent.clear()
            original = session.capi.Scene.set_mesh

            def set_mesh(scene, ident, name, positions, triangles, *rest):
                sent.append((name, len(triangles)))
                original(scene, ident, name, positions, triangles, *rest)
            session.capi.Scene.set_mesh = set_mesh
            try:
                self.render()
            finally:
                session.capi.Scene.set_mesh = original
            return dict(sent)["Emitter, Hair"]
        of_children = count_triangles()
        settings.use_parent_particles = True
        of_all = count_triangles()
        settings.child_type = "NONE"
        of_parents = count_triangles()
        self.assertEqual(of_children, 7 * of_parents)
        self.assertEqual(of_all, 8 * of_parents)

    def test_hair_takes_the_emitters_texture(self):
        """Each strand has the colour of the image where it grows, children too."""
        pixels = np.ones((1, 2, 4), np.float32)
        pixels[0, 0, :3], pixels[0, 1, :3] = (1, 0, 0), (0, 1, 0)
        material, _ = textured("Halves", image("Halves", pixels, non_color=True),
                               interpolation="Closest")
        emitter = self.plane("Emitter", 4, material)
        emitter.modifiers.new("Hair", "PARTICLE_SYSTEM")
        settings = emitter.particle_systems[0].settings
        settings.type, settings.count, settings.hair_length = "HAIR", 100, 0.1
        settings.radius_scale = 0.2
        settings.child_type, settings.rendered_child_count = "INTERPOLATED", 5
        emitter.show_instancer_for_render = False
        picture = self.render()
        left, right = picture[:, 2:30], picture[:, 34:62]
        self.assertGreater((left[..., 0] > 0.5).mean(), 0.3)
        self.assertEqual(left[..., 1].max(), 0.0)
        self.assertGreater((right[..., 1] > 0.5).mean(), 0.3)
        self.assertEqual(right[..., 0].max(), 0.0)

    def test_hair_looks_as_in_cycles(self):
        """A tuft of 400 tapering strands: as much of it is covered, and as brightly."""
        emitter = self.plane("Emitter", 2, self.white)
        emitter.modifiers.new("Hair", "PARTICLE_SYSTEM")
        settings = emitter.particle_systems[0].settings
        settings.type, settings.count, settings.hair_length = "HAIR", 400, 1.0
        settings.radius_scale, settings.brownian_factor = 0.05, 0.3
        settings.use_close_tip = False
        settings.tip_radius = 0.3
        emitter.show_instancer_for_render = False
        self.scene.kestrel.samples = 16
        self.scene.camera.matrix_world = look_at((3, -4, 2.5), (0, 0, 0.4))
        ours, cycles = self.render(), self.render_cycles(32)
        self.assertAlmostEqual((ours[..., 0] > 0.02).mean(), (cycles[..., 0] > 0.02).mean(),
                               delta=0.03)
        self.assertAlmostEqual(ours[..., 0].mean() / cycles[..., 0].mean(), 1.0, delta=0.15)


class SpeedTest(SceneTest):
    def test_ten_thousand_hairs(self):
        self.camera((0, -4, 2))
        emitter = self.plane("Emitter", 2)
        emitter.modifiers.new("Hair", "PARTICLE_SYSTEM")
        settings = emitter.particle_systems[0].settings
        settings.type, settings.count = "HAIR", 10_000
        depsgraph = bpy.context.evaluated_depsgraph_get()
        camera = self.scene.camera.evaluated_get(depsgraph)
        begin = time.perf_counter()
        sync.export_depsgraph(session.acquire("hair"), depsgraph, camera, self.fail)
        took = time.perf_counter() - begin
        session.drop("hair")
        print(f"ten thousand hairs: {took * 1000:.0f} ms")
        self.assertLess(took, 5.0)
