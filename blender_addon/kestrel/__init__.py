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

import sys  # noqa: E402 (Blender reads bl_info first)


def _forget_modules():
    """Drop the modules of an earlier version: after an update, a running Blender executes this file
    anew and would find those in its place."""
    prefix = __name__ + "."
    for name in [name for name in sys.modules if name.startswith(prefix)]:
        del sys.modules[name]
        globals().pop(name.removeprefix(prefix), None)


_forget_modules()

from . import (coverage, engine, export_scene, log, operators, preferences,  # noqa: E402
               properties, rivals, translations, ui)
from .native import loader  # noqa: E402

MODULES = (log, translations, properties, operators, coverage, export_scene, preferences, engine,
           ui)
IDLE_MODULES = (rivals,)  # of one that stands back for another Kestrel

print_node_coverage = coverage.print_node_coverage  # for the command line
_registered = []


def register():
    for module in IDLE_MODULES if rivals.active() else MODULES:
        module.register()
        _registered.append(module)


def unregister():
    while _registered:
        _registered.pop().unregister()
    loader.release()
