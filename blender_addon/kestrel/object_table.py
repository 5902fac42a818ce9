# SPDX-License-Identifier: GPL-3.0-or-later
"""All objects of the core's scene as arrays: tens of thousands of instances are compared, sent and
moved at once."""

from dataclasses import dataclass, field

import numpy as np

from .native import capi


@dataclass
class ObjectTable:
    """One row for each object of the core. Rows of one number have all in common but id and place;
    what they have in common is `descriptions[number]`, the arguments of capi.Scene.set_objects."""
    ids: np.ndarray = field(default_factory=lambda: np.empty(0, np.uint64))
    places: np.ndarray = field(default_factory=lambda: np.empty((0, 12), np.float32))
    numbers: np.ndarray = field(default_factory=lambda: np.empty(0, np.int64))
    descriptions: dict = field(default_factory=dict)  # number: description
    # By the key of an object that stands for itself, its rows; lights have none.
    rows: dict = field(default_factory=dict)
    # Keys of objects that may change others when they move.
    entangled: set = field(default_factory=set)

    def renumbered_after(self, other):
        """The same table in which what `other` describes too has its number."""
        known = {description: number for number, description in other.descriptions.items()}
        fresh = max(known.values(), default=-1) + 1
        new = np.empty(max(self.descriptions, default=-1) + 1, np.int64)
        for number, description in self.descriptions.items():
            if description not in known:
                known[description] = fresh
                fresh += 1
            new[number] = known[description]
        self.numbers = new[self.numbers] if len(self.numbers) else self.numbers
        self.descriptions = {int(new[number]): description
                             for number, description in self.descriptions.items()}
        return self

    def rows_in(self, other):
        """int64 (M,): the row of each object in another table, -1 where it is not there."""
        if np.array_equal(self.ids, other.ids):
            return np.arange(len(self.ids))
        if not len(other.ids):
            return np.full(len(self.ids), -1)
        order = np.argsort(other.ids)
        found = order[np.searchsorted(other.ids, self.ids, sorter=order).clip(max=len(order) - 1)]
        return np.where(other.ids[found] == self.ids, found, -1)

    def send(self, scene, before):
        """Make a capi.Scene that holds the table `before` hold this one; how many objects were
        set, moved or removed."""
        self.renumbered_after(before)
        found = self.rows_in(before)
        same = found >= 0
        kept = found[same]
        same[same] = before.numbers[kept] == self.numbers[same]
        moved = np.zeros_like(same)
        moved[same] = (before.places[found[same]] != self.places[same]).any(axis=1)
        changed = np.flatnonzero(~same)
        for rows in runs(self.numbers, changed):
            scene.set_objects(self.ids[rows], self.places[rows],
                              *self.descriptions[int(self.numbers[rows[0]])])
        if moved.any():
            scene.set_object_transforms(self.ids[moved], self.places[moved])
        gone = np.ones(len(before.ids), bool)
        gone[kept] = False
        if gone.any():
            scene.remove(capi.KIND_OBJECT, before.ids[gone])
        return len(changed) + int(moved.sum()) + int(gone.sum())

    def move(self, scene, keys, matrices):
        """Place objects that stand for themselves anew: `matrices` are 12 floats for each of
        `keys`. How many objects of the core moved."""
        rows, places = [], []
        for key, matrix in zip(keys, matrices):
            for row in self.rows.get(key, ()):
                rows.append(row)
                places.append(matrix)
        if not rows:
            return 0
        places = np.array(places, np.float32)
        moved = (self.places[rows] != places).any(axis=1)
        rows = np.array(rows)[moved]
        self.places[rows] = places[moved]
        if len(rows):
            scene.set_object_transforms(self.ids[rows], self.places[rows])
        return len(rows)


def runs(numbers, rows):
    """`rows` in groups of equal number."""
    if not len(rows):
        return []
    order = rows[np.argsort(numbers[rows], kind="stable")]
    return np.split(order, np.flatnonzero(np.diff(numbers[order])) + 1)


def _mix(values):
    """uint64 to uint64, one to one and well stirred: the finaliser of SplitMix64."""
    values = (values ^ (values >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    values = (values ^ (values >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return values ^ (values >> np.uint64(31))


def instance_ids(seeds, paths):
    """uint64 (M,): ids of instances from what they are instances of, uint64 (M,), and their
    persistent ids, int32 (M, 8)."""
    for column in paths.T:
        seeds = _mix(seeds ^ column.astype(np.uint64))
    return seeds


def distinct(ids):
    """The ids, none 0 and, of those that occur again, all but the first replaced."""
    ids = np.where(ids == 0, np.uint64(1), ids)
    while True:
        order = np.argsort(ids, kind="stable")
        again = order[1:][ids[order[1:]] == ids[order[:-1]]]
        if not len(again):
            return ids
        ids[again] = _mix(ids[again] + np.uint64(1))
