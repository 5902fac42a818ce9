# SPDX-License-Identifier: GPL-3.0-or-later
"""The interface speaks the artist's language: every word of Kestrel's is translated by Kestrel or,
where it is Blender's, by Blender, or is a name."""

import bpy
import fake_layout
from kestrel import coverage, export_scene, operators, properties, translations, ui
from test_panels import PanelCase, kestrel_properties

# Blender's own words that one of the languages writes as English does.
SAME = {"Albedo", "Angle", "Asset", "Cryptomatte", "Debug", "Diffuse", "Emission", "Film",
        "Material", "Normal", "Passes", "Performance", "Position", "Start", "Surface", "Threads",
        "Transmission", "Transparent", "Type", "UV", "Z"}


class TranslationTest(PanelCase):
    def setUp(self):
        super().setUp()
        view = bpy.context.preferences.view
        if not bpy.app.translations.locales:
            self.skipTest("this Blender was installed without its languages")
        before = view.language, view.use_translate_interface, view.use_translate_tooltips
        self.addCleanup(self.set_language, *before)

    @staticmethod
    def set_language(language, interface, tooltips=False):
        view = bpy.context.preferences.view
        view.language = language
        view.use_translate_interface, view.use_translate_tooltips = interface, tooltips

    def words(self):
        """(context, word) of everything that Kestrel shows on panels, menus and buttons."""
        found = set()
        for cls in (ui.CLASSES + operators.CLASSES + export_scene.CLASSES +
                    coverage.OPERATORS):
            context = (translations.OPERATOR if issubclass(cls, bpy.types.Operator) else
                       translations.DEFAULT)
            found.add((context, cls.bl_label))
        for _, prop in kestrel_properties():
            found.add((prop.translation_context, prop.name))
            if prop.type == "ENUM":
                found |= {(prop.translation_context, item.name) for item in prop.enum_items}
        for texts in self.drawn(self.contexts()).values():
            found |= {(translations.DEFAULT, text) for text in texts}
        buttons = {row[0] for row in translations.BUTTONS}
        return {(context, word) for context, word in found
                if word and not (context == translations.DEFAULT and word in buttons)}

    def test_every_word_has_a_translation(self):
        words = self.words()
        self.assertGreater(len(words), 80)
        for index, language in enumerate(translations.LANGUAGES):
            self.set_language(language, True)
            missing = {word for context, word in words
                       if bpy.app.translations.pgettext_iface(word, context) == word
                       and (context, word) not in translations.table()[language]}
            self.assertEqual(sorted(missing - translations.NAMES - SAME), [],
                             f"{language}: add these words to translations.py")

    def test_labels_change_with_the_language(self):
        for language, ray_tracing in (("de_DE", "Raytracing"), ("fr_FR", "Lancer de rayons")):
            self.set_language(language, True)
            self.assertEqual(bpy.app.translations.pgettext_iface("Ray Tracing"), ray_tracing)
            self.assertEqual(bpy.app.translations.pgettext_iface("Selection Inertia"),
                             translations.table()[language][("*", "Selection Inertia")])
        self.set_language("de_DE", True)
        self.assertEqual(
            bpy.app.translations.pgettext_iface("Copy Kestrel System Report", "Operator"),
            "Systembericht von Kestrel kopieren")
        self.set_language("de_DE", False)
        self.assertEqual(bpy.app.translations.pgettext_iface("Ray Tracing"), "Ray Tracing")

    def test_no_word_stands_twice(self):
        for rows in (translations.WORDS, translations.BUTTONS):
            self.assertEqual(len({row[0] for row in rows}), len(rows))
            for row in rows:
                self.assertEqual(len(row), 1 + len(translations.LANGUAGES))
                self.assertTrue(all(row))

    def test_labels_of_passes_are_words(self):
        self.assertEqual(properties.label_of_pass("HeuristicMask"), "Heuristic Mask")
        texts = fake_layout.Layout()
        texts.prop(self.scene.kestrel, "samples")
        self.assertEqual(texts.texts, ["Samples"])
