# SPDX-License-Identifier: GPL-3.0-or-later
"""Kestrel, a hybrid render engine: rasterises everything and ray traces what matters most."""

bl_info = {
    "name": "Kestrel",
    "author": "The Kestrel authors",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "Render Properties > Render Engine > Kestrel",
    "description": "Hybrid render engine with a time budget for ray tracing",
    "category": "Render",
}

from . import engine, log, preferences, properties, ui  # noqa: E402 (Blender reads bl_info first)
from .native import loader  # noqa: E402

MODULES = (log, properties, preferences, engine, ui)


def register():
    for module in MODULES:
        module.register()


def unregister():
    for module in reversed(MODULES):
        module.unregister()
    loader.release()
