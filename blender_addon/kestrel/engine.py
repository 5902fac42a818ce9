# SPDX-License-Identifier: GPL-3.0-or-later
"""The render engine: F12, background rendering, and 3D views in Rendered shading.

For F12 Blender calls update() with its data locked and then render(), once for each view layer.
Everything that is read from Blender is read in update(). Each 3D view has an engine object of its
own, whose view_update() and view_draw() Blender calls on its main thread.
"""

import contextlib
import threading
import weakref

import bpy
from bpy.app.handlers import persistent

from . import compat, icons, log, passes, session, sync, viewport
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
        except Exception as error:  # raised again on Blender's thread
            self.error = error

    def cancel(self):
        self.cancelled = True
        self._session.renderer.cancel()


class Redraw:
    """Asks Blender to draw an engine's 3D view again, from any thread, while there is one. The
    engine object itself is not kept alive."""

    def __init__(self, engine):
        self._engine = weakref.ref(engine)

    def __call__(self):
        engine = self._engine()
        if engine is None:
            return
        with contextlib.suppress(ReferenceError):  # Blender has just freed the view
            engine.tag_redraw()


class KestrelRenderEngine(bpy.types.RenderEngine):
    bl_idname = "KESTREL"
    bl_label = "Kestrel"
    bl_use_preview = True
    bl_use_eevee_viewport = True
    bl_use_shading_nodes_custom = False

    _session = None
    _key = None
    _size = (0, 0)
    _viewport = None
    _error = ""  # why the 3D view cannot follow Blender's data

    # ---- what Blender calls ----

    def update(self, data, depsgraph):
        self._session = None
        self._key = (icons.new_key(self) if self.is_preview else
                     session_key(depsgraph.scene, depsgraph.view_layer))
        self.update_stats("", "Reading the scene")
        with self._reporting():
            target = session.acquire(self._key)
            camera = self._camera(depsgraph)
            self._size = (icons.export(target, depsgraph, camera) if self.is_preview else
                          sync.export_depsgraph(target, depsgraph, camera, log.warning))
            self._session = target

    def render(self, depsgraph):
        if self._session is None:
            return
        with self._reporting():
            self._session.renderer.set_passes(
                item.name for item in passes.enabled(depsgraph.view_layer))
            self._render_frame()
            if not self.test_break():
                self._write_result(depsgraph.view_layer)
        if self.is_preview:
            session.drop(self._key)

    def update_render_passes(self, scene=None, renderlayer=None):
        passes.register(self, scene, renderlayer)

    def view_update(self, context, depsgraph):
        if depsgraph.scene != context.scene:
            return  # another window's
        with self._keeping_errors():
            if self._viewport is not None and (self._error or self._viewport.error):
                self._viewport.close()
            self._error = ""
            self._open_viewport().update(depsgraph, context.space_data)

    def view_draw(self, context, depsgraph):
        with self._keeping_errors():
            self._open_viewport().draw(self, context, depsgraph)
        self._write(self._error or self._viewport.error or self._viewport.status)

    # ---- 3D views ----

    def _open_viewport(self):
        if self._viewport is None or not self._viewport.is_open:
            self._viewport = viewport.Viewport(Redraw(self))
            # No __del__(): its `self` may be gone for Blender already, and with it this attribute.
            weakref.finalize(self, self._viewport.close).atexit = False
        return self._viewport

    def _write(self, text):
        """Into the 3D view's corner."""
        self.update_stats(text, "")

    @contextlib.contextmanager
    def _keeping_errors(self):
        """What goes wrong in this block is written into the 3D view until Blender's data change,
        and then all is read afresh."""
        with log.collecting() as messages:
            try:
                yield
            except capi.KestrelError as error:
                self._error = str(error)
            except Exception as error:
                self._error = log.mistake(error)
        for text in messages:
            self.report({"WARNING"}, text)

    # ---- F12 ----

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

    @contextlib.contextmanager
    def _reporting(self):
        """Tell the artist what goes wrong in this block, and start afresh the next time.

        No exception may leave it: its traceback would keep objects of the depsgraph alive, which
        Blender is about to free.
        """
        with log.collecting() as messages:
            try:
                yield
            except capi.Cancelled:
                pass
            except capi.KestrelError as error:
                self._fail(str(error))
            except Exception as error:
                self._fail(log.mistake(error))
        for text in messages:
            self.report({"WARNING"}, text)

    def _fail(self, text):
        """Say it wherever the artist may look: status bar, image editor, terminal. An icon stays
        empty."""
        session.drop(self._key)
        self._session = None
        if self.is_preview:
            return
        log.error(text)
        self.report({"ERROR"}, text)
        self.error_set(text)


@persistent
def _forget_sessions(*_arguments):
    viewport.close_all()
    session.drop_all()


@persistent
def _read_all(*_arguments):
    viewport.read_all()


HANDLERS = {"load_pre": _forget_sessions, "undo_post": _read_all, "redo_post": _read_all}


def register():
    bpy.utils.register_class(KestrelRenderEngine)
    for name, handler in HANDLERS.items():
        getattr(bpy.app.handlers, name).append(handler)


def unregister():
    for name, handler in HANDLERS.items():
        getattr(bpy.app.handlers, name).remove(handler)
    viewport.close_all()
    bpy.utils.unregister_class(KestrelRenderEngine)
    session.drop_all()
