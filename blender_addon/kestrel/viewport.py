# SPDX-License-Identifier: GPL-3.0-or-later
"""A 3D view in Rendered shading: its session, its render thread and what it draws.

All of this runs on the main thread, but for close(); the render thread does the work.
"""

import itertools

from . import draw, log, session, sync
from .render_thread import Quality, RenderThread
from .sync.view import region_view

DEFAULT_BUDGET_MS = 20.0

_open = set()
_numbers = itertools.count(1)


def quality(scene):
    """How the artist wants a scene's viewports."""
    size = scene.render.preview_pixel_size
    return Quality(scene.kestrel.budget_ms or DEFAULT_BUDGET_MS, scene.kestrel.viewport_samples,
                   0 if size == "AUTO" else int(size))


class Viewport:
    """Valid until close()."""

    def __init__(self, redraw):
        """`redraw()` asks Blender to draw again, from any thread. Raises KestrelError."""
        self._key = f"viewport/{next(_numbers)}"
        self._session = session.acquire(self._key)
        self._thread = RenderThread(self._session, redraw)
        self._painter = draw.Painter()
        self._shown_objects = None  # what else than the depsgraph says which objects are shown
        self._read_all = True
        self._thread.start()
        _open.add(self)

    @property
    def is_open(self):
        return self in _open

    @property
    def error(self):
        """Why there is no picture; empty when all is well."""
        return self._thread.error

    @property
    def status(self):
        return self._thread.status

    @property
    def picture(self):
        """The newest render_thread.Picture, or None."""
        return self._thread.picture

    @property
    def settled(self):
        """Whether the picture is finished: nothing changes, and all samples are in it."""
        return self._thread.settled

    def read_all(self):
        """Take no mesh for unchanged the next time."""
        self._read_all = True

    def update(self, depsgraph, space):
        """Send what changed in Blender's data."""
        shown = shown_objects(space)
        other_objects = shown != self._shown_objects
        self._shown_objects = shown
        before = self._session.edits
        with self._thread.editing:
            sync.export_viewport(self._session, depsgraph, space, log.warning, self._read_all,
                                 other_objects)
        self._read_all = False
        if self._session.edits != before:
            self._thread.scene_changed()

    def draw(self, engine, context, depsgraph):
        """Draw the newest picture, and have another made if the view is another."""
        space = context.space_data
        if self._shown_objects != shown_objects(space):
            self.update(depsgraph, space)
        view = region_view(context.region, space, context.region_data, depsgraph)
        if view is None:
            return
        self._thread.look(view, quality(depsgraph.scene))
        picture = self._thread.picture
        if picture is not None:
            self._painter.draw(engine, depsgraph.scene, picture, view.region)

    def close(self):
        """Free everything; may be called again, and from any thread."""
        try:
            _open.remove(self)
        except KeyError:
            return
        self._thread.stop()
        session.drop(self._key)


def shown_objects(space):
    """State of a 3D view that decides which objects it shows, beside the depsgraph."""
    return space.local_view is not None, space.use_local_collections


def read_all():
    """All viewports read everything again with the next update, as after an undo."""
    for viewport in _open:
        viewport.read_all()


def close_all():
    for viewport in list(_open):
        viewport.close()


def open_viewports():
    return list(_open)
