# SPDX-License-Identifier: GPL-3.0-or-later
"""Exporting a scene file while a 3D view shows Rendered shading."""

import json

import bpy
from viewport_support import ViewportTest


class ExportTest(ViewportTest):
    def export(self, name):
        path = self.folder / name
        with self.context():
            self.assertEqual(bpy.ops.kestrel.export_scene(filepath=str(path)), {"FINISHED"})
        return json.loads(path.read_text(encoding="utf-8"))

    def written_by_view(self):
        path = self.folder / "view.kscene"
        self.viewport._session.scene.write(str(path))
        return json.loads(path.read_text(encoding="utf-8"))

    def test_the_view_shows_what_is_exported_and_goes_on(self):
        red = self.still_life()
        self.camera((4, -6, 3))
        self.look()
        self.render_shading()
        yield self.settled
        exported, shown = self.export("scene.kscene"), self.written_by_view()
        for key in ("objects", "meshes", "materials", "textures", "lights", "world"):
            self.assertEqual(exported[key], shown[key], key)
        self.assertEqual(exported["buffer"], shown["buffer"])
        before = self.pixels()
        red.location.x += 0.4
        yield lambda: not self.settled()
        yield self.settled
        self.assertTrue((self.pixels() != before).any())
        self.assertNotEqual(self.written_by_view()["objects"], shown["objects"])
        self.assertEqual(self.export("again.kscene")["objects"],
                         self.written_by_view()["objects"])
