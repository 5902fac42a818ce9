# SPDX-License-Identifier: GPL-3.0-or-later
"""What the artist is told while a final render goes on."""

import re
import unittest
import unittest.mock

import bpy
from kestrel import display
from kestrel.progress import KNOWN_AFTER_S, Memory, Progress, status_text, time_text
from support import SceneTest, run_blender


class Clock:
    def __init__(self):
        self.now = 100.0

    def __call__(self):
        return self.now


class ProgressTest(unittest.TestCase):
    def setUp(self):
        self.clock = Clock()
        self.progress = Progress(self.clock)

    def run_layer(self, index, count, seconds, speed=lambda fraction: 1.0):
        """Render a layer in steps of 50 ms; lists of (fraction, remaining) and of times."""
        self.progress.begin_layer(index, count)
        told, fraction = [], 0.0
        while fraction < 1.0:
            self.clock.now += 0.05
            fraction = min(fraction + speed(fraction) * 0.05 / seconds, 1.0)
            self.progress.advance(fraction)
            told.append((self.progress.fraction, self.progress.remaining_s, self.clock.now))
        return told

    def test_never_goes_back_over_layers(self):
        told = [item for index in range(3) for item in self.run_layer(index, 3, 2.0)]
        fractions = [item[0] for item in told]
        self.assertEqual(fractions, sorted(fractions))
        self.assertLess(fractions[0], 0.02)
        self.assertEqual(fractions[-1], 1.0)
        self.progress.advance(0.5)  # a report that comes late
        self.assertEqual(self.progress.fraction, 1.0)

    def test_time_left_is_right_at_a_steady_pace(self):
        told = self.run_layer(0, 1, 20.0)
        end = told[-1][2]
        self.assertIsNone(told[3][1])
        known = [(left, now) for _, left, now in told if left is not None]
        self.assertLess(known[0][1] - told[0][2], KNOWN_AFTER_S + 0.2)
        for left, now in known:
            self.assertAlmostEqual(left, end - now, delta=0.3)

    def test_time_left_does_not_jump(self):
        """Tiles of sky go four times as fast as the others."""
        told = self.run_layer(0, 1, 20.0, lambda f: 2.0 if int(f * 20) % 2 else 0.5)
        left = [item[1] for item in told if item[1] is not None]
        jumps = [abs(b - a) for a, b in zip(left, left[1:])]
        self.assertLess(max(jumps), 1.0)
        self.assertLess(left[-1], 0.5)

    def test_time_before_the_first_pixel_does_not_count(self):
        self.progress.begin_layer(0, 1)
        self.clock.now += 60.0  # building
        self.progress.advance(0.0)
        told = self.run_layer(0, 1, 4.0)
        left = [item[1] for item in told if item[1] is not None]
        self.assertLess(max(left), 4.0)

    def test_texts(self):
        self.assertEqual(time_text(0.0), "00:00.00")
        self.assertEqual(time_text(59.999), "01:00.00")
        self.assertEqual(time_text(3723.456), "1:02:03.46")
        memory = Memory()
        self.assertGreater(memory.used, 10.0)
        self.assertGreaterEqual(memory.peak, memory.used)
        memory.used, memory.peak = 12.5, 20.0
        self.assertEqual(status_text("Scene, ViewLayer", "Sample 3/16", 61.5, memory),
                         "Remaining:01:01.50 | Mem:12.50M, Peak:20.00M | Scene, ViewLayer | "
                         "Sample 3/16")
        memory.used = 0.0
        self.assertEqual(status_text("Scene, ViewLayer", "Sample 3/16", None, memory),
                         "Scene, ViewLayer | Sample 3/16")


class StatusTest(SceneTest):
    size = (300, 300)

    def test_blender_is_told(self):
        self.camera()
        self.cube()
        self.scene.kestrel.samples = 64
        self.scene.view_layers.new("Second")
        path = str(self.folder / "scene.blend")
        bpy.ops.wm.save_as_mainfile(filepath=path)
        done = run_blender(
            self.folder, path, "-E", "KESTREL", "-o", str(self.folder / "out_"), "--python-expr",
            "from kestrel import display; display.PRINT_EVERY_S = 0.0", "-f", "1")
        for layer in self.scene.view_layers:
            place = f"{self.scene.name}, {layer.name} | "
            mine = [text for text in done.stdout.splitlines() if place in text]
            self.assertTrue(any("Reading the scene" in text for text in mine), done.stdout)
            samples = [int(found[1]) for text in mine
                       for found in [re.search(r"\| Sample (\d+)/64", text)] if found]
            self.assertGreater(len(samples), 1)
            self.assertEqual(samples, sorted(samples))
            self.assertTrue(all("Mem:" in text for text in mine))

    def test_pictures_are_shown_in_windows_alone(self):
        self.camera()
        self.scene.kestrel.samples = 64
        with unittest.mock.patch.object(display.Display, "__init__",
                                        side_effect=AssertionError("shown")):
            self.assertEqual(self.render().shape, (300, 300, 4))
