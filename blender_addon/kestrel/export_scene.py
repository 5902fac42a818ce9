# SPDX-License-Identifier: GPL-3.0-or-later
"""File > Export > Kestrel Scene: what F12 would render, as a scene file of the kestrel command.

Blender evaluates a scene as renders see it only for a render engine, so the export runs as a render
of one view layer, in which the engine hands what it is given to SceneExport and draws nothing.
"""

import contextlib

import bpy
from bpy_extras.io_utils import ExportHelper

from . import log, session
from .native import capi, loader
from .sync import motion

_export = None  # the SceneExport that the next render is for


class SceneExport:
    """The writing of one file. `error` says what went wrong."""

    def __init__(self, path):
        self.path = path
        self.error = ""
        self.done = False

    def run(self, engine, depsgraph, camera_of, check):
        """Write what the depsgraph shows; the arguments are those of motion.export_frame()."""
        try:
            target = session.Session(loader.require())
            try:
                picture = motion.export_frame(engine, target, depsgraph, camera_of, log.warning,
                                              check=check)
                target.scene.write(self.path, (picture.width, picture.height))
                self.done = True
            finally:
                target.release()
        except capi.KestrelError as error:
            self.error = str(error)
        except Exception as error:
            self.error = log.mistake(error)


def under_way(engine):
    """The export that this engine's render is for, or None: it is a render like any other."""
    return None if engine.is_preview else _export


@contextlib.contextmanager
def _set(owner, **values):
    """Properties that have other values in this block."""
    before = {name: getattr(owner, name) for name in values}
    for name, value in values.items():
        if before[name] != value:
            setattr(owner, name, value)
    try:
        yield
    finally:
        for name, value in before.items():
            if getattr(owner, name) != value:
                setattr(owner, name, value)


def write(path, scene, view_layer):
    """Write what F12 would render of a view layer. Raises KestrelError."""
    global _export
    export = _export = SceneExport(path)
    try:
        with contextlib.ExitStack() as stack:
            stack.enter_context(_set(scene.render, engine="KESTREL", use_single_layer=False,
                                     use_sequencer=False, use_compositing=False))
            for layer in scene.view_layers:
                stack.enter_context(_set(layer, use=layer == view_layer))
            bpy.ops.render.render(scene=scene.name)
    except RuntimeError as error:  # Blender's own reports: there is no camera
        raise capi.KestrelError(export.error or str(error).strip().removeprefix("Error: ")
                                ) from error
    finally:
        _export = None
    if export.error or not export.done:
        raise capi.KestrelError(export.error or "Nothing was rendered, so nothing is exported. "
                                "Wait for the render that is under way, and export again.")


class KESTREL_OT_export_scene(bpy.types.Operator, ExportHelper):
    bl_idname = "kestrel.export_scene"
    bl_label = "Export Kestrel Scene"
    bl_description = ("Write what F12 renders of this scene and view layer to a file that the "
                      "kestrel command renders without Blender. Takes as long as F12 reads the "
                      "scene, and empties the active render slot")

    filename_ext = ".kscene"
    __annotations__ = {"filter_glob": bpy.props.StringProperty(default="*.kscene",
                                                               options={"HIDDEN"})}

    @classmethod
    def poll(cls, _context):
        return loader.library() is not None

    def execute(self, context):
        with log.collecting() as messages:
            try:
                write(self.filepath, context.scene, context.view_layer)
            except capi.KestrelError as error:
                self.report({"ERROR"}, str(error))
                return {"CANCELLED"}
        for text in messages:
            self.report({"WARNING"}, text)
        self.report({"INFO"}, f"The scene is in '{self.filepath}', its arrays in the file beside "
                              "it that ends in .bin. Keep both together.")
        return {"FINISHED"}


CLASSES = (KESTREL_OT_export_scene,)


def draw_in_export(self, _context):
    if loader.library() is not None:
        self.layout.operator(KESTREL_OT_export_scene.bl_idname, text="Kestrel Scene (.kscene)")


def register():
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.TOPBAR_MT_file_export.append(draw_in_export)


def unregister():
    bpy.types.TOPBAR_MT_file_export.remove(draw_in_export)
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
