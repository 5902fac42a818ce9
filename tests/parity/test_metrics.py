# SPDX-License-Identifier: GPL-3.0-or-later
"""Known answers of `metrics.py` and round trips of `exr.py`; plain unittest, needs numpy."""

import os
import sys
import tempfile
import unittest

import numpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import cases
import exr
import metrics


def noise(seed, shape=(40, 37, 3)):
    return numpy.random.default_rng(seed).random(shape, numpy.float32)


class Psnr(unittest.TestCase):
    def test_equal_pictures_have_no_error(self):
        self.assertEqual(metrics.psnr(noise(1), noise(1)), float("inf"))

    def test_constant_difference(self):
        # 0.5 and 0.6 after the gamma: mean square error 0.01, 20 dB.
        a, b = (numpy.full((12, 12, 3), value ** 2.2) for value in (0.5, 0.6))
        self.assertAlmostEqual(metrics.psnr(a, b), 20.0, places=9)

    def test_black_against_white_is_zero_db(self):
        self.assertAlmostEqual(metrics.psnr(numpy.zeros((4, 4, 3)), numpy.ones((4, 4, 3))), 0.0)

    def test_values_outside_the_range_are_clamped(self):
        a, b = numpy.full((4, 4, 3), 7.0), numpy.ones((4, 4, 3))
        a[0], b[0] = -3.0, 0.0
        self.assertEqual(metrics.psnr(a, b), float("inf"))

    def test_mask_limits_the_mean(self):
        a, b = numpy.zeros((4, 4, 3)), numpy.zeros((4, 4, 3))
        b[0, 0] = 1.0
        mask = numpy.zeros((4, 4), bool)
        mask[0, :2] = True
        self.assertAlmostEqual(metrics.psnr(a, b, mask), 10 * numpy.log10(2), places=9)
        self.assertEqual(metrics.psnr(a, b, ~mask), float("inf"))
        with self.assertRaises(ValueError):
            metrics.psnr(a, b, numpy.zeros((4, 4), bool))

    def test_sizes_must_agree(self):
        with self.assertRaises(ValueError):
            metrics.psnr(numpy.zeros((4, 4, 3)), numpy.zeros((4, 5, 3)))


class Ssim(unittest.TestCase):
    def test_equal_pictures(self):
        self.assertAlmostEqual(metrics.ssim(noise(2), noise(2)), 1.0, places=12)

    def test_constant_pictures_leave_the_luminance_term(self):
        a, b = (numpy.full((16, 16, 3), value ** 2.2) for value in (0.4, 0.6))
        expected = (2 * 0.4 * 0.6 + metrics.C1) / (0.4 ** 2 + 0.6 ** 2 + metrics.C1)
        self.assertAlmostEqual(metrics.ssim(a, b), expected, places=9)

    def test_window_agrees_with_a_direct_sum(self):
        a, b = noise(3, (11, 11, 3)), noise(4, (11, 11, 3))
        x, y = (metrics.display(picture) @ metrics.LUMINANCE for picture in (a, b))
        weights = numpy.outer(metrics.gaussian_window(), metrics.gaussian_window())
        mx, my = (weights * x).sum(), (weights * y).sum()
        vx, vy = (weights * (x - mx) ** 2).sum(), (weights * (y - my) ** 2).sum()
        cov = (weights * (x - mx) * (y - my)).sum()
        expected = ((2 * mx * my + metrics.C1) * (2 * cov + metrics.C2)
                    / ((mx * mx + my * my + metrics.C1) * (vx + vy + metrics.C2)))
        self.assertAlmostEqual(metrics.ssim(a, b), expected, places=9)

    def test_noise_lowers_it_and_symmetry_holds(self):
        a, b = noise(5), noise(6)
        self.assertLess(metrics.ssim(a, b), 0.3)
        self.assertAlmostEqual(metrics.ssim(a, b), metrics.ssim(b, a), places=12)

    def test_too_small(self):
        with self.assertRaises(ValueError):
            metrics.ssim(numpy.zeros((10, 20, 3)), numpy.zeros((10, 20, 3)))


class Exr(unittest.TestCase):
    def round_trip(self, pixels):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "picture.exr")
            exr.write(path, pixels)
            return exr.read(path)

    def test_round_trip_keeps_halves(self):
        smooth = numpy.linspace(0, 4, 35 * 21 * 3, dtype=numpy.float16).reshape(35, 21, 3)
        for pixels in (smooth, noise(7).astype(numpy.float16), numpy.zeros((1, 1, 3))):
            numpy.testing.assert_array_equal(self.round_trip(pixels), pixels.astype(numpy.float32))

    def test_other_files_are_refused(self):
        with tempfile.NamedTemporaryFile(suffix=".exr") as file:
            file.write(b"not a picture at all")
            file.flush()
            with self.assertRaises(ValueError):
                exr.read(file.name)


class References(unittest.TestCase):
    def test_every_case_has_a_reference(self):
        for case in cases.CASES:
            with self.subTest(case.name):
                picture = exr.read(cases.reference_path(case.name))
                self.assertEqual(picture.shape, (225, 400, 3))
                self.assertTrue(numpy.isfinite(picture).all())
                self.assertGreater(picture.mean(), 0.02)


if __name__ == "__main__":
    unittest.main()
