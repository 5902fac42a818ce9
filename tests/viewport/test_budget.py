# SPDX-License-Identifier: GPL-3.0-or-later
"""While the view moves, frames keep to the budget among many mirrors and glasses, and the status
text says what was selected and where the time went."""

import json
import time
import unittest
from unittest import mock

import numpy as np
from kestrel import render_thread
from kestrel.render_thread import FRAME_MS, RenderThread
from mathutils import Matrix
from support import shader_material
from viewport_support import ViewportTest

STEPS = 40
WARM_UP = 15         # frames in which the cost of rays and the resolution are learnt
TOLERANCE = 1.25     # on other people's machines
STATUS_S = 2e-4      # a frame's share


class BudgetTest(ViewportTest):
    def many_mirrors(self):
        """Five rows of mirrors and glasses on a floor."""
        self.still_life()
        kinds = (shader_material("Silver", "ShaderNodeBsdfGlossy", Color=(0.9, 0.9, 0.9),
                                 Roughness=0.0),
                 shader_material("Glass", "ShaderNodeBsdfGlass", Color=(1.0, 1.0, 1.0), IOR=1.4))
        for number in range(25):
            self.cube(f"Cube {number}", 0.5, kinds[number % 2], Matrix.Translation(
                (number % 5 - 2.0, number // 5 - 2.0, 0.3)) @ Matrix.Rotation(number, 4, "Z"))

    def watch_frames(self):
        """A list that grows with every frame made while something changes: (milliseconds, what
        the library says of it)."""
        frames = []
        original = RenderThread._frame

        def frame(thread, view, size, settings, progress):
            begin = time.perf_counter()
            result = original(thread, view, size, settings, progress)
            if settings["budget_ms"]:
                frames.append((1e3 * (time.perf_counter() - begin),
                               json.loads(thread._session.renderer.stats())))
            return result

        patch = mock.patch.object(RenderThread, "_frame", frame)
        patch.start()
        self.addCleanup(patch.stop)
        return frames

    def test_mirrors_and_glass(self):
        self.many_mirrors()
        self.look()
        self.render_shading()
        yield self.settled
        frames, texts = self.watch_frames(), set()
        step = 0
        while len(frames) < WARM_UP + STEPS:
            step += 1
            self.look(azimuth_deg=30.0 + 2.0 * step)
            self.area.tag_redraw()
            before = len(frames)
            yield lambda: len(frames) > before
            texts.add(self.viewport.status)
        budget_ms = self.scene.kestrel.budget_ms or 20.0
        steady = frames[WARM_UP:]
        frame_ms = float(np.median([ms for ms, _ in steady]))
        trace_ms = float(np.median([stats["stages_ms"]["trace"] for _, stats in steady]))
        print(f"moving among mirrors: frame {frame_ms:.1f} ms, ray tracing {trace_ms:.1f} ms, "
              f"{max(texts, key=len)!r}")
        self.assertLess(trace_ms, TOLERANCE * budget_ms)
        self.assertLess(frame_ms, TOLERANCE * max(FRAME_MS, 2.0 * budget_ms))
        self.assertTrue(any("objects ray traced" in text for text in texts), texts)
        yield self.settled
        self.assertRegex(self.viewport.status, r"^Sample 8/8 \| \d+ ms$")

    def test_status_is_cheap(self):
        self.many_mirrors()
        self.look()
        self.render_shading()
        yield self.settled
        thread = self.viewport._thread
        thread._told_at = 0.0
        begin = time.perf_counter()
        text = thread._frame_text()
        seconds = time.perf_counter() - begin
        print(f"status text: {1e6 * seconds:.0f} us at most every "
              f"{render_thread.TELL_EVERY_S} s; {text!r}")
        frames_between = render_thread.TELL_EVERY_S / (1e-3 * FRAME_MS)
        self.assertLess(seconds / frames_between, STATUS_S)


class TextTest(unittest.TestCase):
    def test_what_it_says(self):
        stats = {"objects": [{"effects": ["shadows"]}, {"effects": []}, {"effects": ["shadows"]}],
                 "stages_ms": {"raster": 6.2, "trace": 11.9, "blend": 1.0}}
        self.assertEqual(render_thread.frame_text(stats),
                         " | 2 of 3 objects ray traced | raster 6, trace 12 ms")
