# SPDX-License-Identifier: GPL-3.0-or-later
"""PSNR and SSIM of scene-linear pictures, as `numpy` arrays of height x width x 3.

Both clamp RGB to 0..1 and raise it to 1/2.2 first. PSNR is in dB with peak 1; SSIM is the mean over
all pixels whose 11 x 11 Gaussian window (sigma 1.5) lies inside the picture, on Rec. 709 luminance.
"""

import numpy

GAMMA = 1.0 / 2.2
WINDOW_PX, SIGMA_PX = 11, 1.5
LUMINANCE = numpy.array([0.2126, 0.7152, 0.0722])
C1, C2 = 0.01 ** 2, 0.03 ** 2


def display(linear):
    """Clamped and gamma-corrected copy in float64."""
    values = numpy.nan_to_num(numpy.asarray(linear, numpy.float64), nan=0.0)
    return numpy.clip(values, 0.0, 1.0) ** GAMMA


def check_shapes(a, b):
    if a.shape != b.shape or a.ndim != 3 or a.shape[2] != 3:
        raise ValueError(f"expected two pictures of one size with 3 channels, "
                         f"got {a.shape} and {b.shape}")


def psnr(a, b, mask=None):
    """Peak signal-to-noise ratio in dB (inf where equal); `mask` is a bool height x width array."""
    a, b = display(a), display(b)
    check_shapes(a, b)
    squared = (a - b) ** 2
    if mask is not None:
        squared = squared[numpy.asarray(mask, bool)]
    if squared.size == 0:
        raise ValueError("the mask selects no pixel")
    mean = squared.mean()
    return float("inf") if mean == 0.0 else float(-10.0 * numpy.log10(mean))


def gaussian_window():
    x = numpy.arange(WINDOW_PX) - WINDOW_PX // 2
    weights = numpy.exp(-0.5 * (x / SIGMA_PX) ** 2)
    return weights / weights.sum()


def blur(plane):
    """Separable Gaussian over the pixels whose window lies inside the picture."""
    weights = gaussian_window()
    rows = sum(w * plane[i:plane.shape[0] - WINDOW_PX + 1 + i] for i, w in enumerate(weights))
    return sum(w * rows[:, i:rows.shape[1] - WINDOW_PX + 1 + i] for i, w in enumerate(weights))


def ssim(a, b):
    """Mean structural similarity, 1 for equal pictures."""
    a, b = display(a), display(b)
    check_shapes(a, b)
    if min(a.shape[:2]) < WINDOW_PX:
        raise ValueError(f"pictures must be at least {WINDOW_PX} pixels wide and high")
    a, b = a @ LUMINANCE, b @ LUMINANCE
    mean_a, mean_b = blur(a), blur(b)
    variance_a = blur(a * a) - mean_a ** 2
    variance_b = blur(b * b) - mean_b ** 2
    covariance = blur(a * b) - mean_a * mean_b
    values = ((2 * mean_a * mean_b + C1) * (2 * covariance + C2)
              / ((mean_a ** 2 + mean_b ** 2 + C1) * (variance_a + variance_b + C2)))
    return float(values.mean())
