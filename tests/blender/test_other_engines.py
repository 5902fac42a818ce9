# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that were saved with another engine render with Kestrel, and those that were saved with
Kestrel open without it and keep its settings."""

import contextlib
import json

import addon_utils
import bpy
import numpy as np
from kestrel.native import loader
from kestrel.sync.settings import BLENDERS_OWN
from support import SceneTest, diffuse, keep, read_planes, rgba, run_blender

FAULTS = ("Traceback", "Error:", "kestrel: error", "kestrel: warning")


def engines():
    """Blender's own engines, under the names that this version gives them."""
    render, available = bpy.context.scene.render, []
    with keep(render, "engine"):
        for name in ("BLENDER_EEVEE", "BLENDER_EEVEE_NEXT", "BLENDER_WORKBENCH", "CYCLES"):
            with contextlib.suppress(TypeError):
                render.engine = name
                available.append(name)
    return available


class OtherEngineTest(SceneTest):
    def still_life(self):
        self.camera((0, -4, 4), (0, 0, 0))
        self.light("SUN", 3.0)
        self.plane(material=diffuse("Grey", (0.5, 0.5, 0.5)), size=9.0)
        self.cube()
        self.world((0.1, 0.1, 0.1))
        self.scene.frame_start = self.scene.frame_end = 1
        settings = self.scene.render.image_settings
        settings.file_format, settings.color_depth, settings.exr_codec = "OPEN_EXR", "32", "ZIP"

    def save(self, engine):
        """Save a file in a Blender that does not know Kestrel; returns its path."""
        addon_utils.disable("kestrel")
        self.addCleanup(addon_utils.enable, "kestrel")
        bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
        self.scene = bpy.context.scene
        self.assertFalse(hasattr(self.scene, "kestrel"))
        self.scene.render.resolution_x, self.scene.render.resolution_y = self.size
        self.still_life()
        self.scene.render.engine = engine
        path = str(self.folder / f"{engine}.blend")
        bpy.ops.wm.save_as_mainfile(filepath=path)
        addon_utils.enable("kestrel")
        return path

    def test_renders_what_another_engine_saved(self):
        self.assertGreaterEqual(len(engines()), 3)
        for engine in engines():
            with self.subTest(engine):
                self.setUp()
                path = self.save(engine)
                done = run_blender(self.folder, path, "-E", "KESTREL", "-o",
                                   str(self.folder / f"{engine}_####"), "-f", "1")
                said = done.stdout + done.stderr
                self.assertEqual(done.returncode, 0, said)
                for fault in FAULTS:
                    self.assertNotIn(fault, said)
                picture = rgba(read_planes(self.folder / f"{engine}_0001.exr"))
                self.assertGreater(picture[..., :3].mean(), 0.1)
                self.assertTrue(np.isfinite(picture).all())

    def test_settings_that_a_file_has_not_are_the_defaults(self):
        path = self.save("CYCLES")
        bpy.ops.wm.open_mainfile(filepath=path)
        scene = bpy.context.scene
        self.assertEqual(scene.render.engine, "CYCLES")
        scene.render.engine = "KESTREL"
        owners = {"scene": scene, "object": bpy.data.objects["Cube"]}
        for row in loader.parameter_table():
            if row["name"] in BLENDERS_OWN:
                continue
            value = getattr(owners[row["scope"]].kestrel, row["name"])
            if row["type"] in ("int", "float"):
                self.assertAlmostEqual(value, float(row["default"]), 5, row["name"])
            elif row["type"] == "enum":
                self.assertEqual(value, row["default"], row["name"])
        self.assertEqual(bpy.context.view_layer.kestrel.passes, set())
        self.assertTrue(bpy.data.materials["Grey"].kestrel.casts_shadow)


class WithoutKestrelTest(SceneTest):
    """A file of Kestrel's goes through a Blender that has no Kestrel, and comes back."""

    SCRIPT = """
import addon_utils, bpy, json
addon_utils.disable("kestrel")
bpy.ops.wm.open_mainfile(filepath={path!r})
scene = bpy.context.scene
print("FOUND", json.dumps([len(bpy.data.objects), hasattr(scene, "kestrel"), scene.render.engine]))
scene.frame_end = 77
bpy.ops.wm.save_as_mainfile(filepath={again!r})
"""

    def test_settings_stay_in_the_file(self):
        self.camera()
        self.cube(material=diffuse("Grey", (0.5, 0.5, 0.5))).kestrel.relevance = 4.0
        self.scene.kestrel.samples, self.scene.kestrel.budget_ms = 7, 12.5
        self.scene.view_layers[0].kestrel.passes = {"Lighting"}
        bpy.data.materials["Grey"].kestrel.casts_shadow = False
        path, again = (str(self.folder / name) for name in ("kestrel.blend", "again.blend"))
        bpy.ops.wm.save_as_mainfile(filepath=path)
        done = run_blender(self.folder, "--python-exit-code", "1", "--python-expr",
                           self.SCRIPT.format(path=path, again=again))
        said = done.stdout + done.stderr
        self.assertEqual(done.returncode, 0, said)
        self.assertNotIn("Traceback", said)
        self.assertRegex(said, "(?i)engine 'KESTREL' not available for scene 'Scene'")
        line = next(line for line in said.splitlines() if line.startswith("FOUND"))
        count, has_settings, engine = json.loads(line.removeprefix("FOUND"))
        self.assertEqual((count, has_settings), (2, False))
        self.assertNotEqual(engine, "KESTREL")
        bpy.ops.wm.open_mainfile(filepath=again)
        scene = bpy.context.scene
        self.assertEqual((scene.frame_end, scene.render.engine), (77, "KESTREL"))
        self.assertEqual((scene.kestrel.samples, scene.kestrel.budget_ms), (7, 12.5))
        self.assertEqual(bpy.data.objects["Cube"].kestrel.relevance, 4.0)
        self.assertEqual(bpy.context.view_layer.kestrel.passes, {"Lighting"})
        self.assertFalse(bpy.data.materials["Grey"].kestrel.casts_shadow)
