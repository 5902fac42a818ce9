# SPDX-License-Identifier: GPL-3.0-or-later
"""F12, animations and background rendering.

For each view layer Blender calls update() with its data locked, where everything is read, and then
render(). In a window the picture is shown as it forms. The sessions stay for the next frame of an
animation, and longer where the artist wants persistent data.
"""

import contextlib
import threading
import time

import bpy

from . import compat, icons, log, passes, session, sync
from .native import capi
from .progress import Memory, Progress, status_text

POLL_S = 0.02          # how often Escape is looked for
TELL_EVERY_S = 0.1     # at most so often is the status bar written
PRINT_EVERY_S = 1.0    # the same on a terminal, while only numbers change
SHOW_EVERY_S = 0.3     # at most so often is the picture shown as it forms
SHOW_SHARE = 0.01      # of the time may go into that


def session_key(scene, view_layer):
    return f"{compat.datablock_key(scene)}/{view_layer.name}"


def layer_place(scene, view_layer):
    """(index, number) of a view layer among those that are rendered."""
    names = [layer.name for layer in scene.view_layers if layer.use]
    if scene.render.use_single_layer or view_layer.name not in names:
        return 0, 1
    return names.index(view_layer.name), len(names)


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


class Display:
    """Shows a view layer's Combined pass as far as it is, so seldom that it costs next to
    nothing."""

    def __init__(self, result, renderer, size):
        self._result, self._renderer = result, renderer
        self._writer = compat.CombinedWriter(result.layers[0], size[0] * size[1])
        self._begun = self._last = time.monotonic()
        self._spent = 0.0  # seconds of this thread's work

    def copy(self):
        """Copy what there is into the result."""
        self._renderer.read_so_far("Combined", self._writer.pixels)
        self._writer.write()

    def show(self, engine):
        """Show what there is, unless it was done a moment ago."""
        now = time.monotonic()
        if (now - self._last < SHOW_EVERY_S or
                self._spent > SHOW_SHARE * (now - self._begun)):
            return
        begun = time.thread_time()
        self.copy()
        engine.update_result(self._result)
        self._spent += time.thread_time() - begun
        self._last = time.monotonic()


class Teller:
    """Writes progress where Blender shows it."""

    def __init__(self, scene, view_layer, progress):
        self._place = f"{scene.name}, {view_layer.name}"
        self._progress, self._memory = progress, Memory()
        self._last, self._stage = 0.0, None

    def tell(self, engine, stage):
        now = time.monotonic()
        every = PRINT_EVERY_S if bpy.app.background else TELL_EVERY_S
        if now - self._last < every and (bpy.app.background or stage == self._stage):
            return
        self._last, self._stage = now, stage
        self._memory.measure()
        if self._memory.used:
            engine.update_memory_stats(memory_used=self._memory.used,
                                       memory_peak=self._memory.peak)
        engine.update_progress(self._progress.fraction)
        engine.update_stats("", status_text(self._place, stage, self._progress.remaining_s,
                                            self._memory))


class FinalRender:
    """The view layers that one engine object renders. The engine is handed in with each call: kept
    here, it would outlive what Blender frees."""

    def __init__(self):
        self._session = None
        self._key = None
        self._size = (0, 0)
        self._progress = Progress()
        self._teller = None

    def update(self, engine, depsgraph):
        """Read everything of a view layer."""
        scene, view_layer = depsgraph.scene, depsgraph.view_layer
        index, count = layer_place(scene, view_layer)
        if index == 0:
            self._progress = Progress()
        self._progress.begin_layer(index, count)
        self._teller = Teller(scene, view_layer, self._progress)
        self._session = None
        self._key = (icons.new_key(engine) if engine.is_preview else
                     session_key(scene, view_layer))
        self._teller.tell(engine, "Reading the scene")
        with self._reporting(engine):
            target = session.acquire(self._key)
            camera = camera_of(engine, depsgraph)
            self._size = (icons.export(target, depsgraph, camera) if engine.is_preview else
                          sync.export_depsgraph(target, depsgraph, camera, log.warning))
            self._session = target

    def render(self, engine, depsgraph):
        """Render what update() has read."""
        if self._session is None:
            return
        with self._reporting(engine):
            view_layer = depsgraph.view_layer
            self._session.renderer.set_passes(item.name for item in passes.enabled(view_layer))
            passes.add(engine, view_layer)
            with self._result(engine, view_layer) as result:
                self._render_frame(engine, result)
                compat.write_passes(result.layers[0],
                                    passes.reader(self._session.renderer, *self._size))
            passes.stamp(engine, self._session.renderer, view_layer)
        if engine.is_preview:
            session.drop(self._key)

    @contextlib.contextmanager
    def _result(self, engine, view_layer):
        """Blender's picture of a view layer, to fill in this block. It stays as it is where the
        block raises Cancelled, and is thrown away where it raises anything else."""
        result = engine.begin_result(0, 0, *self._size, layer=view_layer.name)
        whole, merge = False, False
        try:
            yield result
            whole = merge = True
        except capi.Cancelled:
            merge = True
            raise
        finally:
            engine.end_result(result, cancel=not whole, do_merge_results=merge)

    def _render_frame(self, engine, result):
        frame = Frame(self._session, *self._size)
        hidden = bpy.app.background or engine.is_preview
        display = None if hidden else Display(result, self._session.renderer, self._size)
        frame.start()
        while frame.is_alive():
            frame.join(POLL_S)
            self._progress.advance(frame.fraction)
            self._teller.tell(engine, frame.status or "Building")
            if display and frame.fraction > 0.0 and not frame.cancelled:
                display.show(engine)
            if not frame.cancelled and engine.test_break():
                frame.cancel()
        if isinstance(frame.error, capi.Cancelled) and display and frame.fraction > 0.0:
            display.copy()
        if frame.error is not None:
            raise frame.error

    @contextlib.contextmanager
    def _reporting(self, engine):
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
                self._fail(engine, str(error))
            except Exception as error:
                self._fail(engine, log.mistake(error))
        for text in messages:
            engine.report({"WARNING"}, text)

    def _fail(self, engine, text):
        """Say it wherever the artist may look: status bar, image editor, terminal. An icon stays
        empty."""
        session.drop(self._key)
        self._session = None
        if engine.is_preview:
            return
        log.error(text)
        engine.report({"ERROR"}, text)
        engine.error_set(text)


def camera_of(engine, depsgraph):
    """The evaluated camera, or None."""
    camera = engine.camera_override or depsgraph.scene_eval.camera
    return camera.evaluated_get(depsgraph) if camera else None
