# SPDX-License-Identifier: GPL-3.0-or-later
"""F12, animations and background rendering.

For each view layer Blender calls update() with its data locked, where everything is read, and then
render(). In a window the picture is shown as it forms. The sessions stay for the next frame of an
animation, and longer where the artist wants persistent data.
"""

import contextlib
import json
import os
import time

import bpy
from bpy.app.handlers import persistent

from . import compat, icons, log, passes, render_thread, session, stamp
from .display import Display, Teller
from .native import capi
from .progress import Progress
from .sync import motion

POLL_S = 0.02  # how often Escape is looked for
GRACE_S = 0.1  # the library's to stop; then Blender no longer waits for it

_keys = set()  # of the sessions of final renders


def session_key(scene, view_layer):
    return f"{compat.datablock_key(scene)}/{view_layer.name}"


def layer_place(scene, view_layer):
    """(index, number) of a view layer among those that are rendered."""
    names = [layer.name for layer in scene.view_layers if layer.use]
    if scene.render.use_single_layer or view_layer.name not in names:
        return 0, 1
    return names.index(view_layer.name), len(names)


class Frame(session.Call):
    """A frame being rendered."""

    def __init__(self, target, picture):
        super().__init__("frame", lambda: target.render(
            picture.width, picture.height, self._progress, picture.area))
        self.fraction, self.status = 0.0, "Building"
        self.cancelled = False
        self._session = target

    def _progress(self, fraction, status):
        self.fraction, self.status = fraction, status
        return not self.cancelled

    def cancel(self):
        self.cancelled = True
        self._session.cancel()


class BreakCheck:
    """Raises Cancelled once the artist has stopped the render. Cheap enough for every item."""

    def __init__(self, engine):
        self._engine, self._next = engine, 0.0

    def __call__(self):
        now = time.monotonic()
        if now < self._next:
            return
        self._next = now + POLL_S
        if self._engine.test_break():
            raise capi.Cancelled("The render was cancelled.")


class FinalRender:
    """The view layers that one engine object renders. The engine is handed in with each call: kept
    here, it would outlive what Blender frees."""

    def __init__(self):
        self._session = None
        self._key = None
        self._picture = None
        self._call = None      # of the library, the last
        self._begun = self._read_s = 0.0
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
        self._begun = time.monotonic()
        self._session = None
        self._key = (icons.new_key(engine) if engine.is_preview else
                     session_key(scene, view_layer))
        if not engine.is_preview:
            _keys.add(self._key)
        self._teller.tell(engine, "Reading the scene")
        with self._reporting(engine):
            target = session.acquire(self._key)
            self._picture = self._read(engine, depsgraph, target)
            require_memory(*self._picture.size, passes.enabled(view_layer))
            self._session = target
        self._read_s = time.monotonic() - self._begun

    def _read(self, engine, depsgraph, target):
        if engine.is_preview:
            return icons.export(target, depsgraph, camera_of(engine, depsgraph))

        def commit():
            self._wait(engine, session.Call("commit", target.commit), target.cancel,
                       lambda: self._teller.tell(engine, "Loading images"))

        return motion.export_frame(engine, target, depsgraph, camera_of, log.warning,
                                   check=BreakCheck(engine), commit=commit)

    def render(self, engine, depsgraph):
        """Render what update() has read."""
        if self._session is None:
            return
        with self._reporting(engine):
            view_layer = depsgraph.view_layer
            renderer = self._session.renderer
            renderer.set_passes(item.name for item in passes.enabled(view_layer))
            passes.add(engine, view_layer)
            with self._result(engine, view_layer) as result:
                self._render_frame(engine, result)
                compat.write_passes(result.layers[0],
                                    passes.reader(renderer, *self._picture.size))
            passes.stamp(engine, renderer, view_layer)
            self._stamp(engine, view_layer)
        if engine.is_preview:
            session.drop(self._key)

    @contextlib.contextmanager
    def _result(self, engine, view_layer):
        """Blender's picture of a view layer, to fill in this block. It stays as it is where the
        block raises Cancelled, and is thrown away where it raises anything else."""
        result = engine.begin_result(0, 0, *self._picture.size, layer=view_layer.name)
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
        frame = Frame(self._session, self._picture)
        hidden = bpy.app.background or engine.is_preview
        display = None if hidden else Display(result, self._session.renderer, self._picture.size)

        def meanwhile():
            self._progress.advance(frame.fraction)
            self._teller.tell(engine, frame.status)
            if display and frame.fraction > 0.0:
                display.show(engine)

        try:
            self._wait(engine, frame, frame.cancel, meanwhile)
        except capi.Cancelled:
            if display and frame.fraction > 0.0:
                display.copy()
            raise

    def _wait(self, engine, call, cancel, meanwhile):
        """Until the library is done; raises what it raises. Cancelled, soon, where the artist stops
        the render: even while the library cannot be interrupted."""
        self._call = call
        call.start()
        while call.is_alive():
            call.join(POLL_S)
            meanwhile()
            if engine.test_break():
                cancel()
                call.join(GRACE_S)
                raise capi.Cancelled("The render was cancelled.")
        if call.error is not None:
            raise call.error

    def _stamp(self, engine, view_layer):
        result = engine.get_result()
        stats = json.loads(self._session.renderer.stats())
        total_s = time.monotonic() - self._begun
        for name, text in stamp.fields(self._session.scene.library.version(), view_layer.name,
                                       stats, self._read_s, total_s).items():
            result.stamp_data_add_field(name, text)

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
                if self._call is not None and self._call.is_alive():
                    session.abandon(self._key)
                self._session = None
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


def system_memory():
    """Bytes of the machine, None where the system does not say it."""
    try:
        return os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    except (AttributeError, OSError, ValueError):
        return None


def require_memory(width, height, items):
    """Raise KestrelError where a picture with these passes cannot fit into memory: Kestrel and
    Blender each hold one."""
    needed = 2 * 4 * width * height * sum(len(item.channels) for item in items)
    there = system_memory()
    if there is not None and needed > there:
        raise capi.KestrelError(
            f"A picture of {width} x {height} pixels with {len(items)} passes takes "
            f"{needed / 2 ** 30:.0f} GB of memory; this machine has {there / 2 ** 30:.0f} GB. Lower "
            "the resolution in Output properties, render it in parts with Render Region, or switch "
            "passes off in View Layer properties.")


def release_sessions():
    """Free what final renders have kept."""
    for key in _keys:
        session.drop(key)
    _keys.clear()


@persistent
def _render_begins(*_arguments):
    """Before a picture or an animation, but not an icon."""
    render_thread.hold_back()


@persistent
def _render_over(scene, *_arguments):
    """After a picture or, at its end, an animation; also where it was stopped or went wrong."""
    render_thread.go_on()
    if not scene.render.use_persistent_data:
        release_sessions()


HANDLERS = {"render_init": _render_begins, "render_complete": _render_over,
            "render_cancel": _render_over}
