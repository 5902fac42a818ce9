# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves with a radius as triangles: tubes of three to nine sides with smooth normals.

Curves stand one after the other in `points` (float32, N x 3) and `radii` (float32, N); `counts`
says how many points each has.
"""

from dataclasses import dataclass

import numpy as np

MAX_TRIANGLES = 500_000  # what a set of tubes may take before it gets fewer sides and steps
SIDES = (9, 7, 5, 3)     # odd numbers look equally wide from everywhere


@dataclass(frozen=True)
class Tubes:
    positions: np.ndarray  # float32 (V, 3)
    triangles: np.ndarray  # uint32 (T, 3)
    normals: np.ndarray    # float32 (3T, 3), unit
    curves: np.ndarray     # int32 (T,): the curve of each triangle


def _starts(counts):
    return np.cumsum(counts) - counts


def _unit(vectors):
    """Unit vectors; zero where there is no direction."""
    lengths = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.divide(vectors, lengths, out=np.zeros_like(vectors), where=lengths > 1e-20)


def fineness(segments, steps):
    """(sides, steps for each of `segments`), at most `steps`, with which tubes stay within
    MAX_TRIANGLES; three sides and one step always may be."""
    for wanted in sorted({steps, max(steps // 2, 1), 1}, reverse=True):
        for sides in SIDES if wanted == 1 else SIDES[:-1]:
            if 2 * sides * wanted * segments <= MAX_TRIANGLES:
                return sides, wanted
    return SIDES[-1], 1


def smooth(points, radii, counts, steps):
    """The curves with every segment cut into `steps`, along Catmull-Rom splines."""
    counts = np.asarray(counts)
    if steps <= 1:
        return points, radii, counts
    owner = np.repeat(np.arange(len(counts)), counts)
    begin = np.flatnonzero(owner[1:] == owner[:-1])  # first point of each segment
    first, last = _starts(counts)[owner[begin]], (_starts(counts) + counts - 1)[owner[begin]]
    knots = np.concatenate([points, radii[:, None]], axis=1).astype(np.float32)
    before, a = knots[np.maximum(begin - 1, first)], knots[begin]
    b, after = knots[begin + 1], knots[np.minimum(begin + 2, last)]
    t = (np.arange(steps, dtype=np.float32) / steps)[None, :, None]
    before, a, b, after = (k[:, None, :] for k in (before, a, b, after))
    inner = a + 0.5 * t * (b - before + t * (2 * before - 5 * a + 4 * b - after
                                             + t * (3 * (a - b) + after - before)))
    finer = (counts - 1) * steps + 1
    result = np.empty((finer.sum(), 4), np.float32)
    ends = _starts(finer) + finer - 1
    is_end = np.zeros(len(result), bool)
    is_end[ends] = True
    result[is_end] = knots[_starts(counts) + counts - 1]
    result[~is_end] = inner.reshape(-1, 4)
    return result[:, :3], np.maximum(result[:, 3], 0.0), finer


def _frames(points, counts):
    """Unit tangents, and two unit vectors across each, which turn as little as they can."""
    owner = np.repeat(np.arange(len(counts)), counts)
    same = (owner[1:] == owner[:-1])[:, None]
    steps = np.where(same, _unit(np.diff(points, axis=0)), 0.0)
    tangents = np.zeros_like(points)
    tangents[:-1] += steps
    tangents[1:] += steps
    tangents = _unit(tangents)
    tangents[~tangents.any(axis=1)] = (0.0, 0.0, 1.0)
    across = np.empty_like(points)
    starts = _starts(counts)
    for step in range(counts.max()):
        here = starts[counts > step] + step
        along = tangents[here]
        axes = np.eye(3, dtype=np.float32)[np.abs(along).argmin(axis=1)]
        guess = axes if step == 0 else across[here - 1]
        side = guess - along * (along * guess).sum(axis=1, keepdims=True)
        lost = np.linalg.norm(side, axis=1) < 1e-4  # a turn by a right angle in one step
        side[lost] = axes[lost] - along[lost] * (along * axes).sum(axis=1, keepdims=True)[lost]
        across[here] = _unit(side)
    return across, np.cross(tangents, across)


def tubes(points, radii, counts, sides):
    """The curves' surfaces. A tube of n sides looks, in the mean over all directions, as wide as
    the round one. Curves of less than two points, and pieces without length or radius, are left
    out."""
    counts = np.asarray(counts)
    points, radii = np.asarray(points, np.float32), np.asarray(radii, np.float32)
    u, v = _frames(points, counts)
    angles = 2.0 * np.pi * np.arange(sides) / sides
    normals = (np.cos(angles)[:, None, None] * u + np.sin(angles)[:, None, None] * v)
    normals = normals.transpose(1, 0, 2).astype(np.float32)  # point, side, axis
    spread = np.float32(np.pi / (sides * np.sin(np.pi / sides)))
    positions = points[:, None, :] + normals * (radii * spread)[:, None, None]

    owner = np.repeat(np.arange(len(counts)), counts)
    length = np.linalg.norm(np.diff(points, axis=0), axis=1)
    begin = np.flatnonzero((owner[1:] == owner[:-1]) & (length > 1e-9))
    side = np.arange(sides)
    a = begin[:, None] * sides + side
    b = begin[:, None] * sides + (side + 1) % sides
    lower = np.stack([a, b, b + sides], axis=-1)[radii[begin] > 0.0]
    upper = np.stack([a, b + sides, a + sides], axis=-1)[radii[begin + 1] > 0.0]
    triangles = np.concatenate([lower.reshape(-1, 3), upper.reshape(-1, 3)])
    return Tubes(positions.reshape(-1, 3), triangles.astype(np.uint32),
                 normals.reshape(-1, 3)[triangles.reshape(-1)],
                 owner[triangles[:, 0] // sides].astype(np.int32))
