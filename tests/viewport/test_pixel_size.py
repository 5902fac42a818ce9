# SPDX-License-Identifier: GPL-3.0-or-later
"""The automatic pixel size, with made-up times."""

import unittest

from kestrel.pixel_size import COARSEST, RETRY_S, PixelSize


class PixelSizeTest(unittest.TestCase):
    def follow(self, ms_of_size, frames=50):
        size = PixelSize()
        values = []
        for frame in range(frames):
            values.append(size.value)
            size.learn(ms_of_size(size.value), 20.0, 40.0, 0.04 * frame)
        return values

    def test_fast_scenes_are_sharp(self):
        self.assertEqual(self.follow(lambda size: 5.0 + 15.0 / size ** 2)[-1], 1)

    def test_budget_does_not_keep_it_coarse(self):
        self.assertEqual(self.follow(lambda size: 20.0 + 10.0 / size ** 2)[-1], 1)

    def test_slow_scenes_stay_in_time(self):
        values = self.follow(lambda size: 320.0 / size ** 2)
        self.assertEqual(values[-1], 4)
        slow = sum(320.0 / v ** 2 > 40.0 for v in values)
        self.assertLessEqual(slow, 50 * 0.04 / RETRY_S + 1)

    def test_very_slow_scenes_are_as_coarse_as_allowed(self):
        self.assertEqual(self.follow(lambda size: 1e5 / size ** 2)[-1], COARSEST)
