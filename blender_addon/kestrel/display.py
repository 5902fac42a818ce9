# SPDX-License-Identifier: GPL-3.0-or-later
"""What the artist sees while a final render goes on: the picture as it forms, and progress."""

import time

import bpy

from . import compat
from .progress import Memory, status_text

TELL_EVERY_S = 0.1   # at most so often is the status bar written
PRINT_EVERY_S = 1.0  # the same on a terminal, while only numbers change
SHOW_EVERY_S = 0.3   # at most so often is the picture shown
SHOW_SHARE = 0.01    # of the time may go into that


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
