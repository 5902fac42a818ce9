# SPDX-License-Identifier: GPL-3.0-or-later
"""Sampling presets: those that come with Kestrel, from rough to fine, and the artist's own."""

from pathlib import Path

import bpy
from bl_operators.presets import AddPresetBase
from bl_ui.utils import PresetPanel

from .common import ENGINE

SUBFOLDER = "kestrel/sampling"
SHIPPED = Path(__file__).resolve().parents[1] / "presets" / SUBFOLDER
NAMES = ("Preview", "Balanced", "Final")
# Settings that a preset holds.
VALUES = ("viewport_samples", "samples", "selection", "budget_ms", "max_depth",
          "importance_cutoff", "pixel_filter", "filter_width")


class KESTREL_PT_sampling_presets(PresetPanel, bpy.types.Panel):
    bl_label = "Sampling Presets"
    COMPAT_ENGINES = {ENGINE}
    preset_subdir = SUBFOLDER
    preset_operator = "script.execute_preset"
    preset_add_operator = "render.kestrel_sampling_preset_add"

    @staticmethod
    def post_cb(context, _path=""):
        """Let 3D views know, as Blender tells them of changes to its own settings alone."""
        render = context.scene.render
        render.filter_size = render.filter_size

    def draw(self, _context):
        layout = self.layout
        layout.emboss = "PULLDOWN_MENU"
        layout.operator_context = "EXEC_DEFAULT"
        column = layout.column(align=True)
        for name in NAMES:
            chosen = column.operator(self.preset_operator, text=name)
            chosen.filepath = str(SHIPPED / f"{name}.py")
            chosen.menu_idname = type(self).__name__
        layout.separator()
        folders = bpy.utils.preset_paths(SUBFOLDER)
        # Kestrel's own folder, of which nothing is taken, spares a complaint that there is none.
        self.path_menu(folders or [str(SHIPPED)], self.preset_operator,
                       filter_ext=lambda ext: bool(folders) and ext == ".py",
                       display_name=lambda path: bpy.path.display_name(path, title_case=False),
                       add_operator=self.preset_add_operator)


class KESTREL_OT_sampling_preset_add(AddPresetBase, bpy.types.Operator):
    """Add or remove a sampling preset"""
    bl_idname = "render.kestrel_sampling_preset_add"
    bl_label = "Add Sampling Preset"
    preset_menu = "KESTREL_PT_sampling_presets"
    preset_subdir = SUBFOLDER
    # Whole paths, as names that presets may define are unknown to Blender 4.3 under Python 3.13.
    preset_values = [f"bpy.context.scene.kestrel.{name}" for name in VALUES]


CLASSES = (
    KESTREL_PT_sampling_presets,
    KESTREL_OT_sampling_preset_add,
)
