# SPDX-License-Identifier: GPL-3.0-or-later
"""Only what changed is sent again, and what is there in the end is what a fresh export sends."""

import random
import time

import bpy
import numpy as np
from kestrel import object_table, session, sync
from kestrel.native import capi
from kestrel.object_table import ObjectTable
from mathutils import Matrix
from support import SceneTest, emission

MOVE_S = 0.005        # one object among ten thousand instances
INSTANCES_S = 2.0     # a hundred thousand of them, from nothing to a committed scene


class FollowTest(SceneTest):
    """Follows a scene as a 3D view does."""

    def setUp(self):
        super().setUp()
        self.camera()
        self.space = next(area.spaces.active for screen in bpy.data.screens
                          for area in screen.areas if area.type == "VIEW_3D")
        self.core = session.acquire("followed")
        self.addCleanup(session.drop, "followed")
        self.walks, self.seconds = 0, 0.0
        self.calls = []

    def follow(self):
        """From now on."""
        self.export(self.core, bpy.context.evaluated_depsgraph_get(), everything=True)
        for name in ("set_mesh", "set_objects", "set_object_transforms", "set_light"):
            original = getattr(self.core.scene, name)
            setattr(self.core.scene, name, lambda idents, *rest, n=name, f=original: (
                self.calls.append((n, np.size(idents))), f(idents, *rest)))

        def after(_scene, depsgraph):
            self.calls.clear()
            begin = time.perf_counter()
            self.export(self.core, depsgraph, everything=False, other_objects=False)
            self.seconds = time.perf_counter() - begin
        bpy.app.handlers.depsgraph_update_post.append(after)
        self.addCleanup(bpy.app.handlers.depsgraph_update_post.remove, after)

    def export(self, core, depsgraph, **options):
        sync.export_viewport(core, depsgraph, self.space, lambda _text: None, **options)

    def update(self):
        bpy.context.view_layer.update()

    def assert_fresh(self):
        """What was sent by and by is what a fresh export sends."""
        fresh = session.acquire("fresh")
        try:
            self.export(fresh, bpy.context.evaluated_depsgraph_get())
            self.assertEqual(content(self.core.objects), content(fresh.objects))
            self.assertEqual(self.core.sent, fresh.sent)
        finally:
            session.drop("fresh")


def content(table):
    """{id: (description, place)}"""
    return {ident: (table.descriptions[number], tuple(place)) for ident, number, place in
            zip(table.ids.tolist(), table.numbers.tolist(), table.places.tolist())}


class ChangeTest(FollowTest):
    def setUp(self):
        super().setUp()
        self.red = emission("Red", (1.0, 0.0, 0.0))
        self.first = self.cube("First", 1.0, self.red)
        self.second = self.cube("Second", 0.5, matrix=Matrix.Translation((3, 0, 0)))
        self.second.data = self.first.data
        self.lamp = self.light("POINT", 10)

    def test_moved_object(self):
        self.follow()
        self.first.location.x = 5.0
        self.update()
        self.assertEqual(self.calls, [("set_object_transforms", 1)])
        self.assert_fresh()
        self.first.location.x = 5.0
        self.update()
        self.assertEqual(self.calls, [])  # it is where it was

    def test_moved_parent(self):
        self.second.parent = self.first
        self.follow()
        self.first.location.x = 5.0
        self.update()
        self.assertEqual(self.calls, [("set_object_transforms", 2)])
        self.assert_fresh()

    def test_moved_light(self):
        self.follow()
        self.lamp.location.x = 5.0
        self.update()
        self.assertEqual(self.calls, [("set_light", 1)])
        self.assert_fresh()

    def test_moved_light_that_is_hidden(self):
        self.lamp.hide_set(True)
        self.follow()
        self.lamp.location.x = 5.0
        self.update()
        self.assert_fresh()
        self.lamp.hide_set(False)
        self.update()
        self.assert_fresh()

    def test_moved_part_of_an_instanced_collection(self):
        collection = bpy.data.collections.new("Parts")
        collection.objects.link(self.first)
        empty = self.link("Instancer", None, Matrix.Translation((0, 4, 0)))
        empty.instance_type, empty.instance_collection = "COLLECTION", collection
        self.follow()
        self.first.location.x = 5.0
        self.update()
        self.assertIn(("set_object_transforms", 2), self.calls)
        self.assert_fresh()
        empty.location.x = -1.0
        self.update()
        self.assertIn(("set_object_transforms", 1), self.calls)
        self.assert_fresh()

    def test_moved_object_that_a_texture_follows(self):
        empty = self.link("Guide", None)
        tree = self.red.node_tree
        coordinates = tree.nodes.new("ShaderNodeTexCoord")
        coordinates.object = empty
        noise = tree.nodes.new("ShaderNodeTexNoise")
        shader = next(node for node in tree.nodes if node.type == "EMISSION")
        tree.links.new(coordinates.outputs["Object"], noise.inputs["Vector"])
        tree.links.new(noise.outputs[0], shader.inputs["Color"])
        self.follow()

        def materials():
            return {key: value for key, value in self.core.sent.items()
                    if key[0] == capi.KIND_MATERIAL}
        before = materials()
        empty.location.x = 1.0
        self.update()
        self.assertNotEqual(materials(), before)
        self.assert_fresh()

    def test_deformed_mesh(self):
        self.follow()
        self.first.data.vertices[0].co.x -= 1.0
        self.first.data.update()
        self.update()
        self.assertEqual(self.calls, [("set_mesh", 1)])
        self.assert_fresh()

    def test_all_sorts(self):
        self.follow()
        changes = [
            lambda: self.first.hide_set(True),
            lambda: self.first.hide_set(False),
            lambda: setattr(self.second, "hide_viewport", True),
            lambda: setattr(self.second, "visible_shadow", False),
            lambda: setattr(self.second, "hide_viewport", False),
            lambda: self.cube("Third", 0.2, self.red),
            lambda: setattr(self.first, "pass_index", 3),
            lambda: setattr(self.first, "name", "Renamed"),
            lambda: self.first.modifiers.new("Array", "ARRAY"),
            lambda: setattr(self.first.modifiers[0], "count", 4),
            lambda: setattr(self.first, "scale", (2, 1, 1)),
            lambda: self.first.modifiers.clear(),
            lambda: self.second.data.materials.clear(),
            lambda: setattr(self.second, "data", self.second.data.copy()),
            lambda: setattr(self.lamp.data, "energy", 3.0),
            lambda: setattr(self.lamp.data, "type", "SUN"),
            lambda: setattr(self.first, "instance_type", "FACES"),
            lambda: setattr(self.second, "parent", self.first),
            lambda: setattr(self.second, "location", (1, 0, 0)),
            lambda: setattr(self.second, "parent", None),
            lambda: bpy.data.objects.remove(self.second),
            lambda: bpy.data.objects.remove(self.lamp),
            lambda: bpy.data.materials.remove(self.red),
        ]
        for index, change in enumerate(changes):
            with self.subTest(index=index):
                change()
                self.update()
                self.assert_fresh()


class SpeedTest(FollowTest):
    def instances(self, count):
        """So many instances of a cube, on the vertices of a mesh."""
        side = int(count ** 0.5) + 1
        numbers = np.arange(count)
        points = np.stack([numbers % side, numbers // side, 0 * numbers], axis=1)
        mesh = bpy.data.meshes.new("Points")
        mesh.from_pydata(points.tolist(), [], [])
        parent = self.link("Points", mesh)
        self.cube("Instance", 0.2).parent = parent
        parent.instance_type = "VERTS"

    def test_moving_one_object_among_ten_thousand_instances(self):
        self.instances(10_000)
        self.cube("Lone", 1.0)
        self.follow()
        times = []
        for step in range(20):
            bpy.data.objects["Lone"].location.z = 1.0 + step
            self.update()
            times.append(self.seconds)
            self.assertEqual(self.calls, [("set_object_transforms", 1)])
        print(f"{1e3 * np.median(times):.2f} ms (at most {1e3 * max(times):.2f})")
        self.assertLess(np.median(times), MOVE_S)
        self.assert_fresh()

    def test_moving_one_of_ten_thousand_objects(self):
        mesh = bpy.data.meshes.new("Triangle")
        mesh.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [], [(0, 1, 2)])
        objects = [self.link(f"Object {i}", mesh, Matrix.Translation((i % 100, i // 100, 0)))
                   for i in range(10_000)]
        self.follow()
        times = []
        for step in range(20):
            objects[step].location.z = 1.0
            self.update()
            times.append(self.seconds)
            self.assertEqual(self.calls, [("set_object_transforms", 1)])
        print(f"{1e3 * np.median(times):.2f} ms (at most {1e3 * max(times):.2f})")
        self.assertLess(np.median(times), MOVE_S)

    def test_a_hundred_thousand_instances(self):
        self.instances(100_000)
        depsgraph = bpy.context.evaluated_depsgraph_get()
        begin = time.perf_counter()
        sync.export_depsgraph(self.core, depsgraph, self.scene.camera.evaluated_get(depsgraph),
                              lambda _text: None)
        seconds = time.perf_counter() - begin
        print(f"{seconds:.2f} s")
        self.assertGreaterEqual(len(self.core.objects.ids), 100_000)
        self.assertLess(seconds, INSTANCES_S)


class Recorder:
    """A capi.Scene that keeps its objects."""

    def __init__(self):
        self.objects = {}

    def set_objects(self, idents, places, *description):
        for ident, place in zip(idents.tolist(), places.tolist()):
            self.objects[ident] = description, tuple(place)

    def set_object_transforms(self, idents, places):
        for ident, place in zip(idents.tolist(), places.tolist()):
            self.objects[ident] = self.objects[ident][0], tuple(place)

    def remove(self, _kind, idents):
        for ident in idents.tolist():
            del self.objects[ident]


class TableTest(SceneTest):
    def random_table(self, chance):
        descriptions = [("a",), ("b",), ("c",), ("d",)]
        chance.shuffle(descriptions)
        descriptions = descriptions[:chance.randint(1, 4)]
        ids = chance.sample(range(1, 30), chance.randint(0, 20))
        return ObjectTable(
            np.array(ids, np.uint64),
            np.array([[chance.randint(0, 1)] * 12 for _ in ids], np.float32).reshape(-1, 12),
            np.array([chance.randrange(len(descriptions)) for _ in ids], np.int64),
            dict(enumerate(descriptions)))

    def test_any_table_after_any_other(self):
        chance = random.Random(7)
        scene, before = Recorder(), ObjectTable()
        for _ in range(500):
            table = self.random_table(chance)
            expected = content(table)
            table.send(scene, before)
            self.assertEqual(content(table), expected)
            self.assertEqual(scene.objects, expected)
            before = table

    def test_same_table_sends_nothing(self):
        chance = random.Random(8)
        scene, before = Recorder(), self.random_table(chance)
        before.send(scene, ObjectTable())
        again = ObjectTable(before.ids.copy(), before.places.copy(), before.numbers.copy(),
                            dict(before.descriptions))
        self.assertEqual(again.send(scene, before), 0)

    def test_ids_of_instances_are_distinct(self):
        paths = np.full((100_000, 8), 0x7FFFFFFF, np.int32)
        paths[:, 0] = np.arange(100_000)
        paths[:, 1] = np.arange(100_000) // 7
        ids = object_table.instance_ids(np.full(100_000, 5, np.uint64), paths)
        self.assertEqual(len(set(ids.tolist())), 100_000)
        same = object_table.distinct(np.array([5, 0, 5, 5, 1], np.uint64))
        self.assertEqual(len(set(same.tolist())), 5)
        self.assertNotIn(0, same.tolist())
        self.assertEqual(same[0], 5)
