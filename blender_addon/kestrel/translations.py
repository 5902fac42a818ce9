# SPDX-License-Identifier: GPL-3.0-or-later
"""Kestrel's own words in other languages, for bpy.app.translations.

Words that Blender's panels use too, such as Sampling, are translated by Blender itself and stand
here only where some version does not know them. Tooltips and messages are English in every language
for now; they go into a language's dictionary like any other words, under the same two contexts.
"""

import bpy

DEFAULT = "*"  # context of names, labels and tooltips
OPERATOR = "Operator"  # context of the names on buttons

# In the order of the interface: (English, German, French).
LANGUAGES = ("de_DE", "fr_FR")
WORDS = (
    # Render tab
    ("Kestrel cannot render", "Kestrel kann nicht rendern", "Kestrel ne peut pas faire de rendu"),
    ("Sampling Presets", "Vorgaben für die Abtastung", "Préréglages d’échantillonnage"),
    ("Viewport Samples", "Abtastungen in der Ansicht", "Échantillons de la vue"),
    ("First Sample", "Erste Abtastung", "Premier échantillon"),
    ("Ray Tracing", "Raytracing", "Lancer de rayons"),
    ("Selection", "Auswahl", "Sélection"),
    ("Most Relevant", "Wichtigste", "Les plus importants"),
    ("Budget (ms)", "Zeitbudget (ms)", "Budget (ms)"),
    ("Selection Inertia", "Trägheit der Auswahl", "Inertie de la sélection"),
    ("Max Depth", "Maximale Tiefe", "Profondeur max."),
    ("Importance Cutoff", "Kleinster Anteil", "Part minimale"),
    ("Environment IOR", "IOR der Umgebung", "IOR de l’environnement"),
    ("Tracer", "Verfolger", "Traceur"),
    ("Embree", "Embree", "Embree"),
    ("Shading", "Schattierung", "Ombrage"),
    ("Shading Model", "Schattierungsmodell", "Modèle d’ombrage"),
    ("Blinn-Phong", "Blinn-Phong", "Blinn-Phong"),
    ("Principled", "Principled", "Principled"),
    ("Shadow Mode", "Schattenart", "Mode d’ombre"),
    ("Hard", "Hart", "Dur"),
    ("Soft", "Weich", "Doux"),
    ("Ambient", "Umgebungslicht", "Lumière ambiante"),
    ("Pixel Filter", "Pixelfilter", "Filtre de pixels"),
    ("Filter Width", "Filterbreite", "Largeur du filtre"),
    ("Blackman-Harris", "Blackman-Harris", "Blackman-Harris"),
    ("Primary", "Sichtbares", "Surfaces visibles"),
    ("Automatic", "Automatisch", "Automatique"),
    ("Rasterized", "Gerastert", "Rastérisé"),
    ("Rays", "Strahlen", "Rayons"),
    ("Final Render", "Endgültiges Rendern", "Rendu final"),
    ("Max Child Particles", "Maximale Kindpartikel", "Particules enfants max."),
    ("Validate Areas", "Flächen prüfen", "Vérifier les aires"),
    # Object, material and light tabs
    ("Relevance", "Wichtigkeit", "Importance"),
    ("Cost", "Aufwand", "Coût"),
    ("Shadows", "Schatten", "Ombres"),
    ("Reflections", "Spiegelungen", "Réflexions"),
    ("Refractions", "Lichtbrechungen", "Réfractions"),
    ("Always", "Immer", "Toujours"),
    ("Never", "Nie", "Jamais"),
    ("Cast Shadows", "Wirft Schatten", "Projette des ombres"),
    ("Cast Shadow", "Wirft Schatten", "Projette une ombre"),
    ("Beam Shape", "Form des Lichtkegels", "Forme du faisceau"),
    ("No output node", "Kein Ausgabeknoten", "Aucun nœud de sortie"),
    # Passes
    ("Optical", "Optik", "Optique"),
    ("Lighting", "Beleuchtung", "Éclairage"),
    ("Reflection", "Spiegelung", "Réflexion"),
    ("Refraction", "Lichtbrechung", "Réfraction"),
    ("Heuristic Mask", "Maske der Auswahl", "Masque de sélection"),
    ("Denoising Normal", "Normale zum Entrauschen", "Normale pour le débruitage"),
    ("Denoising Albedo", "Albedo zum Entrauschen", "Albédo pour le débruitage"),
    ("Levels", "Stufen", "Niveaux"),
    ("Object Id", "Nummer des Objekts", "Numéro de l’objet"),
    ("Material Id", "Nummer des Materials", "Numéro du matériau"),
    ("Reversed Depth", "Umgekehrte Tiefe", "Profondeur inversée"),
    # Node coverage
    ("Node Coverage", "Unterstützte Knoten", "Prise en charge des nœuds"),
    ("All nodes are supported", "Alle Knoten werden unterstützt",
     "Tous les nœuds sont pris en charge"),
    ("Selected Line", "Gewählte Zeile", "Ligne sélectionnée"),
    # Preferences
    ("Version", "Version", "Version"),
    ("Library", "Bibliothek", "Bibliothèque"),
    ("OpenGL Device", "OpenGL-Gerät", "Périphérique OpenGL"),
    ("Image Files", "Bilddateien", "Fichiers d’image"),
)
BUTTONS = (
    ("Add Sampling Preset", "Vorgabe für die Abtastung hinzufügen",
     "Ajouter un préréglage d’échantillonnage"),
    ("Preview", "Vorschau", "Aperçu"),
    ("Balanced", "Ausgewogen", "Équilibré"),
    ("Final", "Endgültig", "Final"),
    ("Copy Kestrel System Report", "Systembericht von Kestrel kopieren",
     "Copier le rapport système de Kestrel"),
    ("Open Kestrel Log", "Protokoll von Kestrel öffnen", "Ouvrir le journal de Kestrel"),
    ("Check Materials", "Materialien prüfen", "Vérifier les matériaux"),
    ("Copy Node Coverage", "Liste kopieren", "Copier la liste"),
    ("Select Material", "Material auswählen", "Sélectionner le matériau"),
    ("Export Kestrel Scene", "Kestrel-Szene exportieren", "Exporter une scène Kestrel"),
    ("Kestrel Scene (.kscene)", "Kestrel-Szene (.kscene)", "Scène Kestrel (.kscene)"),
)
# Names that stay as they are in every language.
NAMES = {"Kestrel", "Embree", "Blinn-Phong", "Blackman-Harris", "Principled"}


def table():
    """{language: {(context, English): translation}}, as Blender takes it."""
    rows = [(DEFAULT, row) for row in WORDS] + [(OPERATOR, row) for row in BUTTONS]
    return {language: {(context, row[0]): row[1 + index] for context, row in rows}
            for index, language in enumerate(LANGUAGES)}


def register():
    bpy.app.translations.register(__package__, table())


def unregister():
    bpy.app.translations.unregister(__package__)
