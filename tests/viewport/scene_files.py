# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares scene files: the .kscene and the arrays beside it."""

import json

import numpy as np

NORMAL_TOLERANCE = 1e-4  # Blender adds up vertex normals on several threads, in any order


def differences(first, second):
    """Where two scene files (Paths) differ: texts, none for those that show the same."""
    files = [Scene(path) for path in (first, second)]
    return list(_differences(*files, *(file.scene for file in files), ""))


class Scene:
    """The JSON of a scene file, and its arrays by their offset."""

    def __init__(self, path):
        self.scene = json.loads(path.read_text(encoding="utf-8"))
        self.scene.pop("buffer", None)
        self._bytes = np.fromfile(f"{path}.bin", np.uint8)
        self._ends = sorted({*_offsets(self.scene), len(self._bytes)})

    def array(self, place):
        start = place["offset"]
        return self._bytes[start:next(end for end in self._ends if end > start)]


def _is_array(item):
    return isinstance(item, dict) and item.keys() == {"offset", "count"}


def _offsets(item):
    if _is_array(item):
        yield item["offset"]
    elif isinstance(item, (dict, list)):
        for inner in item.values() if isinstance(item, dict) else item:
            yield from _offsets(inner)


def _differences(first, second, a, b, place):
    if _is_array(a) and _is_array(b):
        yield from _array_differences(first.array(a), second.array(b), place)
    elif isinstance(a, dict) and isinstance(b, dict):
        for key in sorted(a.keys() | b.keys()):
            yield from _differences(first, second, a.get(key), b.get(key), f"{place}/{key}")
    elif isinstance(a, list) and isinstance(b, list) and len(a) == len(b):
        for index, pair in enumerate(zip(a, b)):
            yield from _differences(first, second, *pair, f"{place}/{index}")
    elif a != b:
        yield f"{place}: {a!r:.500} is not {b!r:.500}"


def _array_differences(a, b, place):
    same = len(a) == len(b)
    if same and place.endswith("/normals"):
        same = np.allclose(a.view(np.float32), b.view(np.float32), 0.0, NORMAL_TOLERANCE)
    elif same:
        same = np.array_equal(a, b)
    if not same:
        yield f"{place} differ"
