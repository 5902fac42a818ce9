# SPDX-License-Identifier: GPL-3.0-or-later
"""The render engine: F12 and background rendering.

Blender calls update() with its data locked and then render(), once for each view layer. Everything
that is read from Blender is read in update().
"""

import threading

import bpy
from bpy.app.handlers import persistent

from . import compat, log, passes, session, sync
from .native import capi

POLL_S = 0.05  # how often the status bar is written and Escape is looked for


def session_key(scene, view_layer):
    return f"{compat.datablock_key(scene)}/{view_layer.name}"


class Frame(threading.Thread):
    """A frame being rendered: the library works on this thread while Blender's one reports."""

    def __init__(self, target, width, height):
        super().__init__(name="Kestrel frame")
        self.fraction, self.status = 0.0, ""
        self.error = None
        self.cancelled = False
        self._session, self._size = target, (width, height)

    def _progress(self, fraction, status):
        self.fraction, self.status = fraction, status
        return not self.cancelled

    def run(self):
        try:
            self._session.render(*self._size, self._progress)
        except capi.KestrelError as error:
            self.error = error

    def cancel(self):
        self.cancelled = True
        self._session.renderer.cancel()


class KestrelRenderEngine(bpy.types.RenderEngine):
    bl_idname = "KESTREL"
    bl_label = "Kestrel"
    bl_use_preview = False
    bl_use_eevee_viewport = True
    bl_use_shading_nodes_custom = False

    _session = None
    _key = None
    _size = (0, 0)

    def update(self, data, depsgraph):
        self._session = None
        self._key = session_key(depsgraph.scene, depsgraph.view_layer)
        self.update_stats("", "Reading the scene")
        with log.collecting() as messages:
            try:
                target = session.acquire(self._key)
                self._size = sync.export_depsgraph(
                    target, depsgraph, self._camera(depsgraph), log.warning)
                self._session = target
            except capi.KestrelError as error:
                session.drop(self._key)
                self._fail(str(error))
        self._report(messages)

    def render(self, depsgraph):
        if self._session is None:
            return
        with log.collecting() as messages:
            try:
                self._render_frame()
                if not self.test_break():
                    self._write_result(depsgraph.view_layer)
            except capi.Cancelled:
                pass
            except capi.KestrelError as error:
                self._fail(str(error))
        self._report(messages)

    def update_render_passes(self, scene=None, renderlayer=None):
        passes.register(self, scene, renderlayer)

    # ---- steps ----

    def _camera(self, depsgraph):
        camera = self.camera_override or depsgraph.scene_eval.camera
        return camera.evaluated_get(depsgraph) if camera else None

    def _render_frame(self):
        frame = Frame(self._session, *self._size)
        frame.start()
        while frame.is_alive():
            frame.join(POLL_S)
            self.update_progress(frame.fraction)
            self.update_stats("", frame.status)
            if not frame.cancelled and self.test_break():
                frame.cancel()
        if frame.error is not None:
            raise frame.error

    def _write_result(self, view_layer):
        passes.add(self, view_layer)
        result = self.begin_result(0, 0, *self._size, layer=view_layer.name)
        compat.write_passes(result.layers[0], passes.reader(self._session.renderer, *self._size))
        self.end_result(result)

    def _fail(self, text):
        """Say it wherever the artist may look: status bar, image editor, terminal."""
        log.error(text)
        self.report({"ERROR"}, text)
        self.error_set(text)

    def _report(self, messages):
        for text in messages:
            self.report({"WARNING"}, text)


@persistent
def _forget_sessions(*_arguments):
    session.drop_all()


def register():
    bpy.utils.register_class(KestrelRenderEngine)
    bpy.app.handlers.load_pre.append(_forget_sessions)


def unregister():
    bpy.app.handlers.load_pre.remove(_forget_sessions)
    bpy.utils.unregister_class(KestrelRenderEngine)
    session.drop_all()
