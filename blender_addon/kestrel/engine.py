# SPDX-License-Identifier: GPL-3.0-or-later
"""The render engine: F12 and background rendering, and 3D views in Rendered shading.

Blender makes an engine object for each render and for each 3D view. It calls update() and render()
on a thread of its own, view_update() and view_draw() on its main thread.
"""

import contextlib
import weakref

import bpy
from bpy.app.handlers import persistent

from . import export_scene, final_render, log, passes, render_thread, session, viewport, write_lock
from .native import capi


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

    _final = None     # the final render
    _viewport = None  # the 3D view
    _error = ""       # why the 3D view cannot follow Blender's data

    # ---- what Blender calls ----

    def update(self, data, depsgraph):
        export = export_scene.under_way(self)
        if export is not None:
            export.run(self, depsgraph, final_render.camera_of, final_render.BreakCheck(self))
            return
        if self._final is None:
            self._final = final_render.FinalRender()
        self._final.update(self, depsgraph)

    def render(self, depsgraph):
        if export_scene.under_way(self) is None:
            self._final.render(self, depsgraph)

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
        write_lock.lifted(context.window_manager, lambda: self._draw(context, depsgraph))

    # ---- 3D views ----

    def _draw(self, context, depsgraph):
        with self._keeping_errors():
            self._open_viewport().draw(self, context, depsgraph)
        self._write(self._error or self._viewport.error or self._viewport.status)

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


@persistent
def _forget_sessions(*_arguments):
    viewport.close_all()
    session.drop_all()


@persistent
def _read_all(*_arguments):
    viewport.read_all()


HANDLERS = {**final_render.HANDLERS, "load_pre": _forget_sessions, "undo_post": _read_all,
            "redo_post": _read_all}


def register():
    write_lock.register()
    bpy.utils.register_class(KestrelRenderEngine)
    for name, handler in HANDLERS.items():
        getattr(bpy.app.handlers, name).append(handler)


def unregister():
    for name, handler in HANDLERS.items():
        getattr(bpy.app.handlers, name).remove(handler)
    viewport.close_all()
    render_thread.go_on()
    bpy.utils.unregister_class(KestrelRenderEngine)
    write_lock.unregister()
    session.drop_all()
