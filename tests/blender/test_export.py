# SPDX-License-Identifier: GPL-3.0-or-later
"""File > Export > Kestrel Scene: the file renders as F12 does."""

import json
import os
import subprocess
import types
from unittest import mock

import bpy
import fake_layout
import numpy as np
from kestrel import export_scene, session
from kestrel.native import loader
from mathutils import Matrix
from support import SceneTest, diffuse, emission, image, look_at, read_planes, rgba, textured


class ExportTest(SceneTest):
    size = (64, 48)
    keeps_sessions = False

    def setUp(self):
        super().setUp()
        self.scene.kestrel.samples = 4
        self.camera((1.3, -6, 3), (0.1, 0, 0.4), shift_x=0.05)

    # ---- scenes ----

    def fill(self):
        """What there is to lose: lights, textures of every kind, instances, motion, modifiers."""
        self.world((0.1, 0.2, 0.3), 0.7)
        self.light("POINT", 90.0, (1, -2, 3))
        self.light("SUN", 1.7, (-2, -1, 3))
        self.light("SPOT", 150.0, (2, 1, 4), spot_size=0.9, spot_blend=0.3)
        pixels = np.random.default_rng(3).random((8, 8, 4))
        pixels[..., 3] = 1.0
        painted, _ = textured("Painted", image("Painted", pixels))
        data, _ = textured("Data", image("Data", pixels * 2.0, is_float=True, non_color=True))
        saved, _ = textured("Saved", self.saved(pixels))
        packed, _ = textured("Packed", self.saved(pixels, pack=True))
        self.plane("Floor", 8, painted)
        for index, material in enumerate((data, saved, packed)):
            self.plane(f"Card {index}", 1.2, material,
                       look_at((1.4 * index - 1.4, 0.8, 0.9), (0, 9, 0)))
        smooth = self.cube("Smooth", 1.0, diffuse("Red", (0.8, 0.1, 0.05)),
                           Matrix.Translation((-1.6, -0.4, 0.6)))
        modifier = smooth.modifiers.new("Subdivision", "SUBSURF")
        modifier.levels, modifier.render_levels = 0, 2
        smooth.kestrel.relevance = 2.5
        collection = bpy.data.collections.new("Group")
        collection.objects.link(bpy.data.objects.new("Part", smooth.data))
        for index in range(3):
            instance = self.link(f"Instance {index}", None, Matrix.Translation(
                (1.0 + 0.7 * index, -0.8, 0.3 + 0.2 * index)) @ Matrix.Scale(0.4, 4))
            instance.instance_type, instance.instance_collection = "COLLECTION", collection
        self.cube("Seen by F12 alone", 0.5, emission("Glow", (0.2, 0.9, 0.4)),
                  Matrix.Translation((0.2, -1.2, 0.3))).hide_viewport = True
        self.cube("Seen in the viewport alone", 3.0).hide_render = True

    def saved(self, pixels, pack=False):
        path = str(self.folder / f"image{pack:d}.png")
        picture = image("Saved", pixels)
        picture.filepath_raw, picture.file_format = path, "PNG"
        picture.save()
        bpy.data.images.remove(picture)
        picture = bpy.data.images.load(path)
        if pack:
            picture.pack()
            os.unlink(path)
        return picture

    # ---- files ----

    def export(self, name="scene.kscene"):
        path = self.folder / name
        self.assertEqual(bpy.ops.kestrel.export_scene(filepath=str(path)), {"FINISHED"})
        return path

    def files(self, path):
        return path.read_bytes(), path.with_name(path.name + ".bin").read_bytes()

    def by_command(self, path):
        """RGBA of a scene file through the kestrel command."""
        command = os.environ.get("KESTREL_TEST_COMMAND", "")
        if not os.path.isfile(command):
            self.skipTest("there is no kestrel command in this build")
        out = self.folder / "command.exr"
        run = subprocess.run([command, "render", str(path), "-o", str(out)], text=True,
                             stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
        self.assertEqual(run.returncode, 0, run.stdout)
        return rgba(read_planes(out))

    def assert_renders_as_f12(self):
        path = self.export()
        expected, found = self.render(), self.by_command(path)
        self.assertEqual(found.shape, expected.shape)  # the size is the scene's, too
        self.assertGreater(expected[..., :3].std(), 0.02, "there is something to see")
        # The command's files hold half floats.
        np.testing.assert_array_equal(found, expected.astype(np.float16).astype(np.float32))

    # ---- tests ----

    def test_renders_as_f12(self):
        self.fill()
        self.assert_renders_as_f12()

    def test_renders_as_f12_with_blur(self):
        self.fill()
        render = self.scene.render
        render.use_motion_blur = True
        if hasattr(self.scene, "eevee") and hasattr(self.scene.eevee, "use_motion_blur"):
            self.scene.eevee.use_motion_blur = True
        dof = self.scene.camera.data.dof
        dof.use_dof, dof.focus_distance, dof.aperture_fstop = True, 5.0, 0.5
        for frame, x in ((0, -2.5), (2, -0.5)):
            for obj in (bpy.data.objects["Smooth"], self.scene.camera):
                obj.location.x = x if obj.type == "MESH" else 1.3 + 0.05 * x
                obj.keyframe_insert("location", frame=frame)
        self.scene.frame_set(1)
        self.assert_renders_as_f12()
        self.assertEqual(self.scene.frame_current, 1)

    def test_renders_as_f12_in_orthographic_views(self):
        self.fill()
        camera = self.scene.camera.data
        camera.type, camera.ortho_scale = "ORTHO", 5.0
        self.scene.render.film_transparent = True
        bpy.data.objects["Card 1"].is_holdout = True
        bpy.data.objects["Smooth"].visible_shadow = False
        self.assert_renders_as_f12()

    def test_the_same_scene_gives_the_same_bytes(self):
        self.fill()
        first = self.files(self.export("first.kscene"))
        bpy.data.objects["Floor"].location.z = -0.1
        self.assertNotEqual(self.files(self.export("moved.kscene"))[0], first[0])
        bpy.data.objects["Floor"].location.z = 0.0
        # Objects are gone through in another order, and Cycles is the scene's engine.
        floor = bpy.data.objects["Floor"]
        self.scene.collection.objects.unlink(floor)
        self.scene.collection.objects.link(floor)
        self.scene.render.engine = "CYCLES"
        self.assertEqual(self.files(self.export("again.kscene")), first)
        self.assertEqual(self.scene.render.engine, "CYCLES")

    def test_is_the_view_layer_that_the_artist_sees(self):
        self.cube("Cube")
        hidden = bpy.data.collections.new("Hidden")
        self.scene.collection.children.link(hidden)
        hidden.objects.link(bpy.data.objects.new("Other", bpy.data.objects["Cube"].data))
        layer = self.scene.view_layers.new("Other Layer")
        layer.layer_collection.children["Hidden"].exclude = True
        layer.use = False  # F12 leaves it out; the artist looks at it nevertheless
        for used, expected in ((self.scene.view_layers[0], ["Cube", "Other"]), (layer, ["Cube"])):
            with bpy.context.temp_override(scene=self.scene, view_layer=used):
                document = json.loads(self.export().read_text(encoding="utf-8"))
            self.assertEqual(sorted(item["name"] for item in document["objects"]), expected)

    def test_leaves_nothing_behind(self):
        self.fill()
        self.export()
        self.assertEqual(session.count(), 0)
        self.assertIsNone(export_scene.under_way(mock.Mock(is_preview=False)))
        render = self.scene.render
        self.assertTrue(render.use_compositing and render.use_sequencer)

    def test_a_missing_folder_is_an_error_that_helps(self):
        self.cube()
        path = self.folder / "missing" / "scene.kscene"
        with self.assertRaisesRegex(RuntimeError, "no folder .*missing'. Create it, or choose"):
            bpy.ops.kestrel.export_scene(filepath=str(path))
        self.assertEqual(session.count(), 0)
        self.export()  # as if nothing had happened

    def test_no_camera_is_an_error_that_helps(self):
        self.cube()
        self.scene.camera = None
        with self.assertRaisesRegex(RuntimeError, "(?i)camera"):
            bpy.ops.kestrel.export_scene(filepath=str(self.folder / "scene.kscene"))
        self.assertEqual(os.listdir(self.folder), [])

    def test_is_in_the_menu_with_a_library_alone(self):
        def menu():
            drawn = types.SimpleNamespace(layout=fake_layout.Layout())
            export_scene.draw_in_export(drawn, bpy.context)
            return drawn.layout.texts

        self.assertTrue(bpy.ops.kestrel.export_scene.poll())
        self.assertEqual(menu(), ["Kestrel Scene (.kscene)"])
        with mock.patch.object(loader, "_library", None), \
                mock.patch.object(loader, "_error", "It is gone. Install it."):
            self.assertFalse(bpy.ops.kestrel.export_scene.poll())
            self.assertEqual(menu(), [])
