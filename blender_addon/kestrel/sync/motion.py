# SPDX-License-Identifier: GPL-3.0-or-later
"""How things move: while the shutter is open, for motion blur, or from the frame before to the one
after, for the pass Vector.

Blender's scene is evaluated at the first, the middle and the last moment. The middle one is what
the export sends; what differs at the others gets a motion. Costs three further evaluations and
looks a frame.
"""

import functools

import numpy as np

from .. import compat
from ..native import capi
from ..object_table import ObjectTable
from ..session import Export
from . import export_depsgraph
from .camera import camera_item
from .object import sync_objects


def copied(value):
    """The same with arrays of its own, also those in lists of tuples."""
    if isinstance(value, np.ndarray):
        return value.copy()
    if isinstance(value, (list, tuple)):
        return type(value)(copied(item) for item in value)
    return value


class _Catcher:
    """Takes the place of the core's scene: keeps meshes and drops the rest."""

    def __init__(self):
        self.meshes = {}  # id: arguments of capi.Scene.set_mesh after it

    def set_mesh(self, ident, *values):
        # Copies: the next evaluation frees what arrays may look at.
        self.meshes[ident] = [copied(value) for value in values]

    def __getattr__(self, _name):
        return lambda *_arguments: None


class _Moment(Export):
    """An export that is only looked at: what is where, and which meshes are not as they were sent."""

    def __init__(self, session, depsgraph, camera, wanted):
        """`camera`: evaluated object or None. `wanted`: ids of meshes to keep even though they are
        as they were sent."""
        scene = depsgraph.scene_eval
        super().__init__(session, lambda _text: None, scene.kestrel.environment_ior)
        self.scene = _Catcher()
        self.objects = ObjectTable()
        self._wanted = wanted
        sync_objects(self, depsgraph)
        self.camera, _ = camera_item(self, camera, scene.render)

    def warn(self, _text):
        """Everything was said in the export."""

    def note(self, _name, _value):
        """Settings are those of the export."""

    def put(self, kind, ident, content, send):
        if kind == capi.KIND_MESH and (
                ident in self._wanted or self.session.sent.get((kind, ident)) != content):
            send()

    def put_objects(self, table):
        self.objects = table


def shutter(scene):
    """(start, middle, end) in frames after the current one, or None where nothing asks for
    motion."""
    render = scene.render
    if render.use_motion_blur:
        half = 0.5 * render.motion_blur_shutter
        middle = {"START": half, "END": -half}.get(compat.motion_blur_position(scene), 0.0)
        return middle - half, middle, middle + half
    if any(layer.use_pass_vector for layer in scene.view_layers):
        return -1.0, 0.0, 1.0
    return None


def export_frame(engine, session, depsgraph, camera_of, say, check=None, commit=None):
    """As sync.export_depsgraph(), with motion where the scene asks for it. `camera_of(engine,
    depsgraph)` gives the evaluated camera or None. Blender's scene is back at its frame in the
    end."""
    scene = depsgraph.scene
    times = shutter(scene)
    if times is None:
        _send_objects(session, [])
        return export_depsgraph(session, depsgraph, camera_of(engine, depsgraph), say,
                                check=check, commit=commit)
    now = scene.frame_current_final

    def go_to(time):
        frame, part = divmod(now + time, 1.0)
        engine.frame_set(int(frame), part)

    try:
        start, middle, end = times
        if middle:
            go_to(middle)
        picture = export_depsgraph(session, depsgraph, camera_of(engine, depsgraph), say,
                                   check=check, commit=commit)

        def look(time, wanted=()):
            go_to(time)
            return _Moment(session, depsgraph, camera_of(engine, depsgraph), wanted)

        first, last = look(start), look(end)
        deforming = set(first.scene.meshes) | set(last.scene.meshes)
        moments = [first, look(middle, deforming), last]
        _send_objects(session, moments)
        _send_meshes(session, moments, deforming)
        _send_camera(session, [moment.camera for moment in moments])
        (commit or session.commit)()
        return picture
    finally:
        go_to(0.0)


def _send_objects(session, moments):
    moving = {}
    if moments:
        tables = [moment.objects for moment in moments]
        there = functools.reduce(np.intersect1d, [table.ids for table in tables])
        order = [np.argsort(table.ids) for table in tables]
        states = np.stack([table.places[rows[np.searchsorted(table.ids, there, sorter=rows)]]
                           for table, rows in zip(tables, order)], axis=1)  # (N, 3, 12)
        moves = (states != states[:, 1:2]).any(axis=(1, 2))
        moving = dict(zip(there[moves].tolist(), states[moves]))
    for ident, matrices in moving.items():
        session.scene.set_object_motion(ident, matrices)
    still = session.moving.difference(moving)
    for ident in still.intersection(session.objects.ids.tolist()) if still else ():
        session.scene.set_object_motion(ident, np.empty((0, 12), np.float32))
    session.moving = set(moving)


def _send_meshes(session, moments, deforming):
    for ident in deforming:
        middle = moments[1].scene.meshes.get(ident)
        if middle is None or (capi.KIND_MESH, ident) not in session.sent:
            continue  # it is there only at one end
        shapes = [moment.scene.meshes.get(ident, middle) for moment in moments]
        if not all(_same_topology(shape, middle) for shape in shapes):
            continue
        positions = np.concatenate([shape[1] for shape in shapes])
        normals = [shape[3] for shape in shapes]
        session.scene.set_mesh(ident, *middle, motion=(
            positions, None if middle[3] is None else np.concatenate(normals)))
        # The next frame sends it again, and without motion if it then keeps its shape.
        session.sent[capi.KIND_MESH, ident] = None
        session.shapes = {}


def _same_topology(shape, other):
    """Whether two meshes, as the arguments of set_mesh(), differ in places and normals alone."""
    return (shape[1].shape == other[1].shape and np.array_equal(shape[2], other[2])
            and (shape[3] is None) == (other[3] is None))


def _send_camera(session, states):
    if any(bytes(state) != bytes(states[1]) for state in states):
        session.scene.set_camera_motion(states)
