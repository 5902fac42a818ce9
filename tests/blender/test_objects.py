# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects, instances and their geometry."""

import ctypes
import unittest.mock

import bpy
import numpy as np
from kestrel import compat, session
from kestrel.sync import object as sync_object
from mathutils import Matrix
from support import SceneTest, diffuse, emission, new_material, turned


class UnitTest(SceneTest):
    """Which objects are selected together, and with which settings."""

    def units(self):
        self.render()
        return {item["name"]: item for item in self.stats()["objects"]}

    def collection_of_cubes(self, count=2):
        collection = bpy.data.collections.new("Cubes")
        for i in range(count):
            cube = self.cube(f"Cube{i}", 0.5, matrix=Matrix.Translation((i - 0.5, 0, 0)))
            self.scene.collection.objects.unlink(cube)
            collection.objects.link(cube)
        return collection

    def instancer(self, name, collection, x):
        empty = self.link(name, None, Matrix.Translation((x, 0, 0)))
        empty.instance_type, empty.instance_collection = "COLLECTION", collection
        return empty

    def test_objects_are_units_of_their_own(self):
        self.camera()
        self.plane("Floor")
        self.cube("Box", 0.3)
        self.assertEqual(set(self.units()), {"Floor", "Box"})

    def test_instances_are_units_of_their_instancer(self):
        self.camera((0, 0, 12))
        collection = self.collection_of_cubes()
        self.instancer("Left", collection, -1.5)
        self.instancer("Right", collection, 1.5).kestrel.relevance = 5.0
        units = self.units()
        self.assertEqual(set(units), {"Left", "Right"})
        self.assertEqual(units["Left"]["relevance"] > 0, True)
        core = next(iter(session._sessions.values()))
        meshes = {ident for (kind, ident) in core.sent if kind == 0}
        self.assertEqual(len(meshes), 2)  # one a cube, shared by the instancers

    def test_relevance_reaches_the_heuristic(self):
        self.camera((0, 0, 8))
        self.scene.kestrel.selection_inertia = 0.0
        for name, x in (("A", -1.0), ("B", 1.0)):
            self.plane(name, 1, matrix=Matrix.Translation((x, 0, 0)))
        bpy.data.objects["B"].kestrel.relevance = 4.0
        units = self.units()
        ratio = units["B"]["R"] / units["A"]["R"] if "R" in units["A"] else (
            units["B"]["relevance"] / units["A"]["relevance"])
        self.assertAlmostEqual(ratio, 4.0, 2)
        bpy.data.objects["B"].kestrel.relevance = 1.0
        units = self.units()
        ratio = units["B"]["R"] / units["A"]["R"] if "R" in units["A"] else (
            units["B"]["relevance"] / units["A"]["relevance"])
        self.assertAlmostEqual(ratio, 1.0, 2)

    def test_lone_instance_that_comes_first(self):
        """Blender frees such an instance as soon as it hands it out."""
        collection = self.collection_of_cubes(1)
        collection.objects[0].data.materials.append(diffuse("Glow", (1, 1, 1)))
        self.instancer("AnEmpty", collection, 0.5).show_instancer_for_render = False
        self.camera((0, 0, 6))
        self.light("SUN", np.pi)
        original = sync_object.sync_mesh

        def overwrite_what_is_free(*arguments):
            libc = ctypes.CDLL(None)
            libc.malloc.restype = ctypes.c_void_p
            for size in range(16, 1024, 8):
                for block in [libc.malloc(size) for _ in range(40)]:
                    ctypes.memset(block, 0xff, size)
                    libc.free(ctypes.c_void_p(block))
            return original(*arguments)
        with unittest.mock.patch.object(sync_object, "sync_mesh", overwrite_what_is_free):
            self.assertEqual(set(self.units()), {"AnEmpty"})
            self.assert_color(self.render()[16, 16], 1.0)

    def test_vertex_instances(self):
        self.camera((0, 0, 8))
        parent = self.plane("Parent", 2)
        child = self.cube("Child", 0.5, emission("Glow", (1, 1, 1)))
        child.parent = parent
        parent.instance_type = "VERTS"
        parent.show_instancer_for_render = False
        units = self.units()
        self.assertEqual(set(units), {"Parent"})
        lit = self.render()[..., 0] > 0.5
        self.assertTrue(lit[11, 11] and lit[11, 20] and lit[20, 11] and lit[20, 20])
        self.assertFalse(lit[16, 16])  # neither the instancer nor the original


class GeometryTest(SceneTest):
    def area(self, picture=None):
        """Share of the picture that glows."""
        picture = self.render() if picture is None else picture
        return (picture[..., 0] > 0.5).mean()

    def setUp(self):
        super().setUp()
        self.glow = emission("Glow", (1, 1, 1))
        self.camera((0, 0, 9), ortho_scale=4.0)

    def test_mesh_without_uv_faces_or_material(self):
        self.mesh("Empty", [], [])
        self.mesh("Edge", [(0, 0, 0), (1, 0, 0)], [])
        self.plane("NoUv", 2, self.glow, uv=False)
        self.mesh("NoMaterial", [(0, 0, -1), (1, 0, -1), (0, 1, -1)], [(0, 1, 2)])
        self.assertAlmostEqual(self.area(), 0.25, 2)

    def test_polygons_with_many_corners(self):
        """A concave polygon keeps its shape: an L of three quarters of 2 x 2."""
        self.mesh("L", [(-1, -1, 0), (1, -1, 0), (1, 0, 0), (0, 0, 0), (0, 1, 0), (-1, 1, 0)],
                  [(0, 1, 2, 3, 4, 5)], self.glow)
        self.assertAlmostEqual(self.area(), 0.75 * 0.25, 2)

    def test_modifiers_count(self):
        plane = self.plane("Plane", 1, self.glow)
        array = plane.modifiers.new("Array", "ARRAY")
        array.count, array.relative_offset_displace = 2, (-1.0, 0.0, 0.0)
        copy = self.link("Copy", plane.data, Matrix.Translation((0, 1, 0)))  # without it
        self.assertAlmostEqual(self.area(), 3 / 16, 2)
        copy.hide_render = True
        self.assertAlmostEqual(self.area(), 2 / 16, 2)

    def test_modifiers_for_the_viewport_only_do_not(self):
        array = self.plane("Plane", 1, self.glow).modifiers.new("Array", "ARRAY")
        array.show_render = False
        self.assertAlmostEqual(self.area(), 1 / 16, 2)

    def test_hidden_objects_and_collections(self):
        self.plane("Object", 1, self.glow).hide_render = True
        hidden = bpy.data.collections.new("Hidden")
        self.scene.collection.children.link(hidden)
        plane = self.plane("InCollection", 1, self.glow)
        self.scene.collection.objects.unlink(plane)
        hidden.objects.link(plane)
        hidden.hide_render = True
        self.assertEqual(self.area(), 0.0)

    def test_material_slots(self):
        red, green = emission("Red", (1, 0, 0)), emission("Green", (0, 1, 0))
        plane = self.mesh("Two", [(x, y, 0) for y in (-1, 1) for x in (-2, 0, 2)],
                          [(0, 1, 4, 3), (1, 2, 5, 4)], red)
        plane.data.materials.append(green)
        plane.data.polygons[1].material_index = 1
        picture = self.render()
        self.assert_color(picture[16, 8], (1, 0, 0))
        self.assert_color(picture[16, 24], (0, 1, 0))
        plane.data.polygons[1].material_index = 7  # beyond the last slot: the last one
        self.assert_color(self.render()[16, 24], (0, 1, 0))
        plane.material_slots[0].link = "OBJECT"
        plane.material_slots[0].material = self.glow
        self.assert_color(self.render()[16, 8], (1, 1, 1))

    def test_material_override(self):
        self.plane("Plane", 2, emission("Black", (0, 0, 0)))
        self.scene.view_layers[0].material_override = self.glow
        self.assertAlmostEqual(self.area(), 0.25, 2)

    def test_other_kinds_of_geometry(self):
        curve = bpy.data.curves.new("Curve", "CURVE")
        curve.dimensions, curve.fill_mode = "2D", "BOTH"
        spline = curve.splines.new("POLY")
        spline.points.add(3)
        for point, place in zip(spline.points, ((-1, -1), (1, -1), (1, 1), (-1, 1))):
            point.co = (*place, 0, 1)
        spline.use_cyclic_u = True
        text = bpy.data.curves.new("Text", "FONT")
        text.body, text.size = "I", 3.0
        ball = bpy.data.metaballs.new("Ball")
        ball.elements.new()
        ball.render_resolution = 0.2
        for data, least in ((curve, 0.24), (text, 0.02), (ball, 0.05)):
            with self.subTest(type(data).__name__):
                obj = self.link("Shape", data)
                data.materials.append(self.glow)
                self.assertGreater(self.area(), least)
                twin = self.link("Twin", data, Matrix.Translation((0, 0, -1)))
                self.render()
                bpy.data.objects.remove(twin)
                bpy.data.objects.remove(obj)

    def test_negative_scale_is_lit_from_the_same_side(self):
        self.plane("Plane", 4, diffuse("White", (1, 1, 1)), Matrix.Diagonal((-1, 1, 1, 1)))
        self.light("SUN", np.pi)
        self.assert_color(self.render()[16, 16], (1, 1, 1))

    def test_smooth_and_flat_normals(self):
        self.scene.view_layers[0].use_pass_normal = True
        ridge = self.mesh("Ridge", [(-2, -2, 0), (0, -2, 1), (2, -2, 0), (-2, 2, 0), (0, 2, 1),
                                    (2, 2, 0)], [(0, 1, 4, 3), (1, 2, 5, 4)], self.glow)
        flat = self.normal_x()
        slope = 1 / 5 ** 0.5
        np.testing.assert_allclose(flat[16, [4, 12, 19, 27]], [-slope, -slope, slope, slope],
                                   atol=1e-3)
        ridge.data.polygons.foreach_set("use_smooth", [True, True])
        ridge.data.update()
        smooth = self.normal_x()
        self.assertLess(abs(smooth[16, 15]), 0.05)
        self.assertLess(smooth[16, 2], -0.3)
        if hasattr(ridge.data, "use_auto_smooth"):
            ridge.data.use_auto_smooth, ridge.data.auto_smooth_angle = True, 0.5
            np.testing.assert_allclose(self.normal_x(), flat, atol=1e-3)

    def normal_x(self):
        planes = self.render_planes()
        return next(plane for name, plane in planes.items() if name.endswith("Normal.X"))

    def test_uv_map_that_rendering_uses(self):
        from support import image, textured
        pixels = np.zeros((2, 2, 4), np.float32)
        pixels[:, 0] = (1, 0, 0, 1)
        pixels[:, 1] = (0, 1, 0, 1)
        material, _ = textured("Map", image("Halves", pixels, non_color=True),
                               interpolation="Closest")
        plane = self.plane("Plane", 4, material)
        second = plane.data.uv_layers.new(name="Mirrored")
        second.data.foreach_set("uv", [1, 0, 0, 0, 0, 1, 1, 1])
        self.assert_color(self.render()[16, 4], (1, 0, 0))
        plane.data.uv_layers["Mirrored"].active_render = True
        self.assert_color(self.render()[16, 4], (0, 1, 0))


class AgainTest(SceneTest):
    """A second frame of the same scene sends what changed and drops what is gone."""

    def setUp(self):
        super().setUp()
        self.camera((0, 0, 9), ortho_scale=4.0)
        self.box = self.plane("Plane", 1, emission("Glow", (1, 1, 1)))

    def left_and_right(self):
        picture = self.render()[..., 0]
        return picture[16, 8] > 0.5, picture[16, 24] > 0.5

    def test_moved_changed_and_deleted(self):
        self.box.location.x = -1.0
        self.assertEqual(self.left_and_right(), (True, False))
        core = next(iter(session._sessions.values()))
        self.box.location.x = 1.0
        self.assertEqual(self.left_and_right(), (False, True))
        self.assertIs(next(iter(session._sessions.values())), core)
        self.box.data.vertices.foreach_set("co", np.ravel(
            [(-2.5, -.5, 0), (-1.5, -.5, 0), (-1.5, .5, 0), (-2.5, .5, 0)]))
        self.box.data.update()
        self.assertEqual(self.left_and_right(), (True, False))
        material = self.box.data.materials[0]
        material.node_tree.nodes["Emission"].inputs["Strength"].default_value = 0.0
        self.assertEqual(self.left_and_right(), (False, False))
        material.node_tree.nodes["Emission"].inputs["Strength"].default_value = 1.0
        bpy.data.objects.remove(self.box)
        self.assertEqual(self.left_and_right(), (False, False))
        self.assertEqual([key for key in core.sent if key[0] == 0], [])

    def test_objects_share_their_mesh(self):
        self.link("Twin", self.box.data, Matrix.Translation((1, 0, 0)))
        changed = self.link("Changed", self.box.data, Matrix.Translation((-1, 0, 0)))
        changed.modifiers.new("Array", "ARRAY")
        self.render()
        core = next(iter(session._sessions.values()))
        self.assertEqual(len([key for key in core.sent if key[0] == 0]), 2)

    def test_corner_arrays_are_those_that_blender_gives_corner_by_corner(self):
        def add(name, smooth, split, modifier):
            bpy.ops.mesh.primitive_uv_sphere_add(segments=16, ring_count=8)
            obj = bpy.context.object
            obj.name = name
            for polygon in obj.data.polygons:
                polygon.use_smooth = smooth(polygon.index)
            if hasattr(obj.data, "use_auto_smooth"):  # until 4.0
                obj.data.use_auto_smooth = split
            if modifier:
                obj.modifiers.new(modifier, modifier)
            return obj
        cases = [add("Smooth", lambda _: True, False, None),
                 add("Flat", lambda _: False, False, None),
                 add("Mixed", lambda i: i % 3 > 0, False, "SUBSURF"),
                 add("Split", lambda i: i % 2 > 0, True, "ARRAY")]
        depsgraph = bpy.context.evaluated_depsgraph_get()
        for obj in cases:
            mesh = obj.evaluated_get(depsgraph).data
            normals = compat.corner_normals(mesh)
            self.assertEqual(compat.corner_vertices(mesh).tolist(),
                             [loop.vertex_index for loop in mesh.loops])
            self.assertEqual(compat.corner_totals(mesh).tolist(),
                             [polygon.loop_total for polygon in mesh.polygons])
            mesh.calc_loop_triangles()
            self.assertEqual(compat.triangle_corners(mesh).reshape(-1, 3).tolist(),
                             [list(triangle.loops) for triangle in mesh.loop_triangles])
            self.assertEqual(compat.triangle_polygons(mesh).tolist(),
                             [triangle.polygon_index for triangle in mesh.loop_triangles])
            if obj.name == "Flat":
                self.assertIsNone(normals)
                continue
            if hasattr(mesh, "calc_normals_split"):
                mesh.calc_normals_split()
            expected = [tuple(loop.normal) for loop in mesh.loops]
            np.testing.assert_allclose(normals, expected, atol=1e-6)

    def test_unchanged_is_not_sent_again(self):
        self.light("POINT", 10)
        self.render()
        core = next(iter(session._sessions.values()))
        calls = []
        for name in ("set_mesh", "set_objects", "set_material", "set_light"):
            original = getattr(core.scene, name)
            setattr(core.scene, name, lambda *a, n=name, f=original: (calls.append(n), f(*a)))
        self.render()
        self.assertEqual(calls, [])
        self.box.scale.x = 2.0
        self.render()
        self.assertEqual(calls, [])  # only its matrix changed
        self.assertGreater((self.render()[..., 0] > 0.5).mean(), 0.11)

    def test_without_an_output_node(self):
        material, _, output = new_material("NoOutput")
        material.node_tree.nodes.remove(output)
        self.plane("Other", 1, material, turned(180))
        self.render()
