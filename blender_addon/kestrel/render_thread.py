# SPDX-License-Identifier: GPL-3.0-or-later
"""The thread that makes a viewport's pictures.

While something changes: one sample a frame, within the budget, at a coarser resolution where that
is needed. Once still: every pixel, everything ray traced, samples added up until there are enough.
"""

import json
import threading
import time
from dataclasses import dataclass

import numpy as np

from . import log
from .native import capi
from .pixel_size import PixelSize

SETTLE_S = 0.15       # without a change, until the view counts as still
SHOW_EVERY_S = 0.1    # at most so often is a still view drawn again
CALL_S = 0.1          # samples that together take about this long are rendered in one call
FRAME_MS = 40.0       # a frame while something changes should take no longer
TELL_EVERY_S = 0.2    # at most so often are a frame's statistics read
MOST_UNITS = 200      # of a scene whose statistics are read at all: that takes 0.2 ms
STOP_S = 0.05         # at most so long is a pause once the thread is to end

_alone = threading.Event()  # no final render is running
_alone.set()


def hold_back():
    """Let no viewport begin another frame until go_on(): a final render needs the cores."""
    _alone.clear()


def go_on():
    _alone.set()


@dataclass(frozen=True)
class Quality:
    """How a viewport is rendered."""
    budget_ms: float  # for ray tracing in a frame while something changes
    samples: int      # once still
    pixel_size: int   # while something changes; 0: automatic


@dataclass(frozen=True)
class Picture:
    """A finished picture; nobody changes its pixels any more."""
    pixels: np.ndarray  # float32 (height * width, 4), scene-linear, row 0 at the bottom
    width: int
    height: int
    view: object        # sync.view.View that it shows
    samples: int        # 0: a frame made while something changed


class RenderThread(threading.Thread):
    """Renders the newest request. `redraw()` is called from here when there is news."""

    def __init__(self, session, redraw):
        super().__init__(name="Kestrel viewport", daemon=True)
        self.editing = threading.Lock()  # held while the core's scene is changed
        self.picture = None  # the newest one
        self.status = "Waiting"
        self.error = ""      # what keeps the picture from being made
        self._session, self._redraw = session, redraw
        self._news = threading.Condition()
        self._request = None    # (View, Quality)
        self._generation = 0    # of request and scene
        self._taken = 0         # the generation that was last rendered, None: none was
        self._stopping = False
        self._refining = False  # the frame under way is given up when something changes
        self._auto_size = PixelSize()
        self._told = ""         # what frame_text() said last,
        self._told_at = 0.0     # and when, on time.monotonic()

    # ---- for the main thread: none of these waits for a frame ----

    def look(self, view, quality):
        """Show this from now on."""
        if self._request != (view, quality):
            self._change((view, quality))

    def scene_changed(self):
        self._change(None)

    def _change(self, request):
        with self._news:
            self._request = request or self._request
            self._generation += 1
            self._news.notify()
        if self._refining:
            self._session.renderer.cancel()

    def stop(self):
        """End the thread, and wait for that: as long as it takes to give up a frame."""
        with self._news:
            self._stopping = True
            self._news.notify()
        self._session.renderer.cancel()
        if threading.current_thread() is not self:
            self.join()

    @property
    def settled(self):
        """Whether the picture that was asked for is finished."""
        picture, request = self.picture, self._request
        return (picture is not None and request is not None and self._generation == self._taken
                and picture.view == request[0] and picture.samples == request[1].samples)

    # ---- the thread ----

    def run(self):
        while self._changed_within(None):
            try:
                self._session.renderer.set_passes(["Combined"])
                self._move()
                while self._changed_within(SETTLE_S):
                    self._move()
                if not self._stopping:
                    self._refine()
            except capi.Cancelled:
                self._taken = None  # what was to be seen is still due
            except capi.KestrelError as error:
                self._tell("", str(error))
            except Exception as error:
                self._tell("", log.mistake(error))

    def _changed_within(self, seconds):
        """Wait for a change, None: for ever; whether there is one. False when stopping."""
        with self._news:
            self._news.wait_for(lambda: self._stopping or (
                self._request is not None and self._generation != self._taken), seconds)
            return not self._stopping and self._generation != self._taken

    def _take(self):
        with self._news:
            self._taken = self._generation
            return self._request

    def _tell(self, status, error=""):
        self.status, self.error = status, error
        self._redraw()

    def _pause(self):
        """Wait while a final render is running."""
        if not _alone.is_set():
            self._tell("Waiting for the final render")
        while not (self._stopping or _alone.wait(STOP_S)):
            pass

    def _frame(self, view, size, settings, progress):
        """Render; returns (pixels in the library's memory, milliseconds of rendering)."""
        with self.editing:
            scene = self._session.scene
            scene.set_camera(view.camera())
            for name, value in settings.items():
                scene.set_setting(name, str(value))
            scene.commit()
        begin = time.perf_counter()
        self._session.render(*size, progress)
        pixels = self._session.renderer.read_pass("Combined", *size)
        return pixels, 1e3 * (time.perf_counter() - begin)

    def _move(self):
        """A frame in time, seen through to its end: else none would be shown while things move."""
        self._pause()
        view, quality = self._take()
        pixel_size = quality.pixel_size or self._auto_size.value
        size = tuple(max(1, -(-side // pixel_size)) for side in view.size)
        pixels, ms = self._frame(
            view, size, {"budget_ms": quality.budget_ms, "samples": 1, "first_sample": 0},
            lambda _fraction, _status: not self._stopping)
        if not quality.pixel_size and self.picture is not None:  # the first builds what all use
            self._auto_size.learn(ms, quality.budget_ms, max(FRAME_MS, 2.0 * quality.budget_ms),
                                  time.monotonic())
        self.picture = Picture(pixels.copy(), *size, view, 0)
        coarse = f" | Pixel size {pixel_size}" if pixel_size > 1 else ""
        self._tell(f"Moving | {ms:.0f} ms{coarse}{self._frame_text()}")

    def _frame_text(self):
        """What frame_text() says of the last frame, or of one a moment ago."""
        now = time.monotonic()
        if len(self._session.objects.descriptions) > MOST_UNITS:
            self._told = ""
        elif now - self._told_at >= TELL_EVERY_S:
            self._told, self._told_at = frame_text(json.loads(self._session.renderer.stats())), now
        return self._told

    def _refine(self):
        """Add up samples until there are enough or something changes."""
        view, quality = self._request
        total, done, count, shown = None, 0, 1, 0.0
        self._refining = True
        try:
            while done < quality.samples:
                self._pause()
                if self._interrupted():
                    return
                pixels, ms = self._frame(
                    view, view.size, {"budget_ms": 0, "samples": count, "first_sample": done},
                    lambda _fraction, _status: not self._interrupted())
                total = pixels * np.float32(count) if total is None else np.add(
                    total, pixels * np.float32(count), out=total)
                done += count
                now = time.monotonic()
                if done == quality.samples or now - shown > SHOW_EVERY_S:
                    self.picture = Picture(total / np.float32(done), *view.size, view, done)
                    shown = now
                    self._tell(f"Sample {done}/{quality.samples} | {ms / count:.0f} ms")
                if self._interrupted():
                    return
                count = min(max(int(1e3 * CALL_S * count / ms), 1), quality.samples - done)
        finally:
            self._refining = False

    def _interrupted(self):
        return self._stopping or self._generation != self._taken


def frame_text(stats):
    """Which objects a frame ray traced and where its time went, to be added to a line."""
    objects, stages = stats["objects"], stats["stages_ms"]
    traced = sum(bool(item["effects"]) for item in objects)
    return (f" | {traced} of {len(objects)} objects ray traced | raster {stages['raster']:.0f}, "
            f"trace {stages['trace']:.0f} ms")
