# SPDX-License-Identifier: GPL-3.0-or-later
"""The system report: what somebody who is to understand a fault has to know of this machine."""

import platform
from pathlib import Path

import bpy

from . import log
from .native import capi, loader


def _library_lines():
    library = loader.library()
    if library is None:
        return [f"Library: none. {loader.error()}"]
    try:
        device = library.device_info()
    except capi.KestrelError as error:
        device = str(error)
    return [f"Library: {library.version()}, interface {capi.ABI_VERSION}, "
            f"{without_home(loader.library_path())}", f"Device: {device}"]


def without_home(path):
    """A path as text that does not tell the user's name."""
    home = str(Path.home())
    return f"~{str(path)[len(home):]}" if str(path).startswith(f"{home}/") else str(path)


def blenders_device():
    """What Blender itself draws with."""
    if bpy.app.background:
        return "none, in background"
    import gpu  # has nothing to say in background
    return f"{gpu.platform.renderer_get()}, {gpu.platform.version_get()}"


def _settings_lines(scene):
    for name in scene.kestrel.bl_rna.properties.keys():
        if name in ("rna_type", "name"):
            continue
        value = getattr(scene.kestrel, name)
        value = tuple(value) if hasattr(value, "__len__") and not isinstance(value, str) else value
        note = "" if scene.kestrel.is_property_set(name) else " (default)"
        yield f"  {name} = {value!r}{note}"


def text(scene):
    """The report for a scene, several lines."""
    kinds = [obj.type for obj in scene.objects]
    counts = ", ".join(f"{kinds.count(kind)} {kind}" for kind in sorted(set(kinds)))
    render = scene.render
    return "\n".join([
        "Kestrel system report",
        f"Add-on: {__package__}",
        *_library_lines(),
        f"Blender: {bpy.app.version_string}, {bpy.app.build_hash.decode()}, "
        f"draws with {blenders_device()}",
        f"Python: {platform.python_version()}",
        f"System: {platform.platform()}",
        f"Scene: engine {render.engine}, {render.resolution_x} x {render.resolution_y} at "
        f"{render.resolution_percentage} %, objects: {counts or 'none'}",
        *_settings_lines(scene),
        "Messages:",
        *(f"  {line}" for line in log.recent() or ["none"])])
