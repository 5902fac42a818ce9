# SPDX-License-Identifier: GPL-3.0-or-later
"""Every panel draws in every context, every setting is explained, presets hold what they say."""

import types
from pathlib import Path
from unittest import mock

import bpy
import fake_layout
from kestrel import ui
from kestrel.native import loader
from kestrel.ui import presets, render
from support import SceneTest, diffuse

DESCRIPTION_MIN = 25  # characters of a tooltip that says something
GROUPS = ("Scene", "Object", "ViewLayer", "Material")


def kestrel_properties():
    """(what, RNA property) of each setting of Kestrel's."""
    for kind in GROUPS:
        group = getattr(bpy.types, kind).bl_rna.properties["kestrel"].fixed_type
        for prop in group.properties:
            if prop.identifier not in ("rna_type", "name"):
                yield f"{kind}.{prop.identifier}", prop


class PanelCase(SceneTest):
    """Draws panels in every context."""

    def context(self, obj=None, **more):
        """What a Properties editor knows, with `obj` active."""
        data = obj.data if obj else None
        known = {
            "engine": "KESTREL", "scene": self.scene, "view_layer": self.scene.view_layers[0],
            "object": obj, "active_object": obj, "world": self.scene.world,
            "preferences": bpy.context.preferences, "window_manager": bpy.context.window_manager, "material_slot": None,
            "space_data": types.SimpleNamespace(bl_rna=bpy.types.SpaceProperties.bl_rna),
            "material": obj.active_material if obj else None,
            "light": data if isinstance(data, bpy.types.Light) else None,
            "camera": data if isinstance(data, bpy.types.Camera) else None}
        return types.SimpleNamespace(**{**known, **more})

    def contexts(self):
        material = diffuse("Grey", (0.5, 0.5, 0.5))
        plain = bpy.data.materials.new("Plain")
        plain.use_nodes = False
        cube = self.cube(material=material)
        yield self.context()
        yield self.context(cube, material_slot=cube.material_slots[0])
        yield self.context(self.cube("Plain", material=plain))
        yield self.context(self.cube("Bare"))
        yield self.context(self.link("Empty", None))
        yield self.context(self.camera())
        for kind in ("POINT", "SUN", "SPOT", "AREA"):
            yield self.context(self.light(kind, 1.0))
        node_light = self.light("POINT", 1.0, use_nodes=True)
        yield self.context(node_light)
        self.world((0.1, 0.1, 0.1))
        self.scene.view_layers[0].use_pass_mist = True
        yield self.context(material=material)
        self.scene.world.use_nodes = False
        yield self.context()
        self.scene.kestrel.selection = "none"
        yield self.context(preferences=types.SimpleNamespace(
            view=types.SimpleNamespace(show_developer_ui=True)))

    def drawn(self, contexts):
        """Names of the panels that were drawn, each with its words."""
        found = {}
        for context in contexts:
            for panel in ui.CLASSES:
                if not issubclass(panel, bpy.types.Panel):
                    continue
                if not hasattr(panel, "poll") or panel.poll(context):
                    found.setdefault(panel, set()).update(fake_layout.draw(panel, context))
        return found


class PanelTest(PanelCase):
    def test_every_panel_draws_in_every_context(self):
        found = self.drawn(self.contexts())
        panels = {cls for cls in ui.CLASSES if issubclass(cls, bpy.types.Panel)}
        self.assertEqual(panels - set(found), {render.KESTREL_RENDER_PT_library})
        self.assertIn("Power", found[ui.light.KESTREL_LIGHT_PT_light])
        self.assertIn("Samples", found[render.KESTREL_RENDER_PT_sampling_viewport])

    def test_without_a_library_the_panel_says_why(self):
        reason = "There is no library here. Install it."
        with mock.patch.object(loader, "_library", None), \
                mock.patch.object(loader, "_error", reason):
            found = self.drawn(self.contexts())
        words = found[render.KESTREL_RENDER_PT_library]
        self.assertEqual(" ".join(sorted(words, key=reason.index)), reason)
        self.assertNotIn(render.KESTREL_RENDER_PT_sampling, found)
        self.assertIn(ui.light.KESTREL_LIGHT_PT_light, found)

    def test_other_engines_show_none_of_them(self):
        for panel in ui.CLASSES:
            if issubclass(panel, ui.common.KestrelPanel):
                self.assertFalse(panel.poll(self.context(engine="CYCLES")), panel)

    def test_parents_are_registered_before_their_children(self):
        names = [cls.__name__ for cls in ui.CLASSES]
        for index, cls in enumerate(ui.CLASSES):
            parent = getattr(cls, "bl_parent_id", "")
            self.assertTrue(not parent or parent in names[:index] or
                            not parent.startswith("KESTREL"), cls)

    def test_every_setting_is_explained(self):
        found = list(kestrel_properties())
        self.assertGreater(len(found), 20)
        for what, prop in found:
            self.assertGreaterEqual(len(prop.description), DESCRIPTION_MIN, what)
            self.assertFalse(prop.description.endswith("."), what)  # Blender adds it
            if prop.type == "ENUM":
                for item in prop.enum_items:
                    self.assertTrue(item.name, what)
                    self.assertGreater(len(item.description), 10, f"{what}: {item.identifier}")

    def test_choices_of_one_are_not_shown(self):
        properties = self.scene.kestrel.bl_rna.properties
        self.assertTrue(ui.common.offers_choice(properties["selection"]))
        self.assertTrue(ui.common.offers_choice(properties["samples"]))
        one = types.SimpleNamespace(type="ENUM", enum_items=[
            types.SimpleNamespace(identifier=name) for name in ("auto", "embree")])
        self.assertFalse(ui.common.offers_choice(one))


class PresetTest(SceneTest):
    def settings(self):
        return {name: getattr(self.scene.kestrel, name) for name in presets.VALUES}

    def execute(self, path):
        bpy.ops.script.execute_preset(filepath=str(path),
                                      menu_idname=presets.KESTREL_PT_sampling_presets.__name__)
        return self.settings()

    def test_shipped_presets_grow_finer(self):
        self.scene.kestrel.property_unset("samples")
        defaults = self.settings()
        found = [self.execute(presets.SHIPPED / f"{name}.py") for name in presets.NAMES]
        self.assertEqual({path.stem for path in presets.SHIPPED.glob("*.py")}, set(presets.NAMES))
        self.assertEqual(found[1], defaults)
        for coarse, fine in zip(found, found[1:]):
            for name in ("samples", "viewport_samples", "max_depth"):
                self.assertLess(coarse[name], fine[name])
            self.assertGreater(coarse["importance_cutoff"], fine["importance_cutoff"])
        self.assertGreater(found[0]["budget_ms"], 0.0)
        self.assertEqual(found[2]["budget_ms"], 0.0)

    def test_an_artists_own(self):
        folder = self.folder / "scripts"
        self.scene.kestrel.samples, self.scene.kestrel.budget_ms = 33, 7.5
        wanted = self.settings()
        with mock.patch.object(bpy.utils, "user_resource", side_effect=self.user_resource):
            bpy.ops.render.kestrel_sampling_preset_add(name="My Own")
        path = folder / "presets" / presets.SUBFOLDER / "My_Own.py"
        self.execute(presets.SHIPPED / "Final.py")
        self.assertEqual(self.execute(path), wanted)
        with mock.patch.object(bpy.utils, "preset_paths", return_value=[str(path.parent)]):
            words = fake_layout.draw(presets.KESTREL_PT_sampling_presets, None)
        self.assertEqual([w for w in words if w not in ("Add Sampling Preset", "Preset Name")][:4],
                         [*presets.NAMES, "My Own"])

    def user_resource(self, _kind, path="", create=False):
        made = self.folder / "scripts" / Path(path)
        if create:
            made.mkdir(parents=True, exist_ok=True)
        return str(made)
