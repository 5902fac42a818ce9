# SPDX-License-Identifier: GPL-3.0-or-later
"""What lives longer than a render: one core scene and renderer per Blender scene and view layer.

Blender frees the engine object after every frame, so the sessions stand here, by key. They go when
another file is opened, when the add-on is disabled and after a failed export.
"""

import hashlib
import threading

from .native import capi, loader
from .object_table import ObjectTable

_sessions = {}
_lock = threading.Lock()


def stable_id(key):
    """64-bit id of some bytes, never 0, the same in every run."""
    return int.from_bytes(hashlib.blake2b(key, digest_size=8).digest(), "little") or 1


def digest(*arrays):
    """Fingerprint of contiguous arrays, bytes and None."""
    views = [None if array is None else memoryview(array) for array in arrays]
    shapes = repr([view and (view.format, view.shape) for view in views]).encode()
    return loader.require().hash(shapes, *(view.cast("B") for view in views
                                           if view is not None and view.nbytes))


class Call(threading.Thread):
    """A long call of the library on a thread of its own, while Blender's looks for Escape."""

    def __init__(self, name, function):
        super().__init__(name=f"Kestrel {name}")
        self.error = None
        self._function = function

    def run(self):
        try:
            self._function()
        except Exception as error:  # for whoever waits
            self.error = error


class Session:
    """A core scene, its renderer, and what has been sent to them."""

    def __init__(self, library):
        self.scene = capi.Scene(library)
        self.renderer = capi.Renderer(self.scene)
        self.unseen_material = ""   # the camera does not meet objects of this material
        self.sent = {}              # (kind, id): what was sent last, but for objects
        self.objects = ObjectTable()  # that were sent
        self.sent_settings = set()  # units that were given settings
        self.warned = set()         # texts that were already said
        self.means = {}             # (kind of mean, texture, its content): mean colour
        self.values = {}            # name: settings, world and what else is no item
        self.shapes = {}            # mesh key: [(mesh id, slots), ...] of the last export
        self.moving = set()         # ids of objects that were given a motion
        self.edits = 0              # how often anything was sent that is not as it was
        self._busy = threading.Lock()

    def commit(self):
        """Publish what was sent to the scene; blocks."""
        with self._busy:
            self.scene.commit()

    def render(self, width, height, progress, area=None):
        """Render a frame; blocks. `progress(fraction, status)` returns False to cancel. `area`:
        pixels (left, bottom, right, top) that are rendered, None for all."""
        with self._busy:
            self.renderer.set_region(area)
            self.renderer.render(width, height, progress)

    def cancel(self):
        """Let a commit or render on another thread raise Cancelled, soon."""
        self.scene.cancel_commit()
        self.renderer.cancel()

    def release(self):
        """Free everything, after ending what is under way."""
        self.cancel()
        with self._busy:
            self.renderer.release()
            self.scene.release()


class Export:
    """One pass over Blender's data into a session's scene.

    Items that are unchanged are not sent again; items that were not met are removed at the end.
    """

    # What refers to others goes before what it refers to; objects went before all.
    REMOVAL_ORDER = (capi.KIND_LIGHT, capi.KIND_MATERIAL, capi.KIND_TEXTURE, capi.KIND_MESH)

    def __init__(self, session, say, environment_ior=1.0, touched=None, check=None):
        """`say(text)` takes warnings; each text is said once per session. `touched`: keys of the
        objects and data whose geometry may have changed since the last export, None for all.
        `check()` is called between items and may raise: the next export then does the rest."""
        self.session = session
        self.environment_ior = environment_ior
        self.scene = session.scene
        self._say = say
        self.check = check or (lambda: None)
        self._met = set()   # (kind, id)
        self.meshes = {}    # evaluated data: mesh id
        self.materials = {}  # material key: id
        self.textures = {}  # texture reference: id
        self._touched = touched
        self._shapes = {}   # as Session.shapes

    def warn(self, note):
        """Say a text, or a nodes.Note."""
        text = str(note)
        if text not in self.session.warned:
            self.session.warned.add(text)
            self._say(text)

    def new_id(self, kind, key):
        """Id of an item that is met for the first time in this export; `key` is text or bytes."""
        self.check()
        key = key.encode("utf-8", "replace") if isinstance(key, str) else key
        ident = stable_id(key)
        count = 0
        while (kind, ident) in self._met:
            count += 1
            ident = stable_id(key + b"#%d" % count)
        self._met.add((kind, ident))
        return ident

    def put(self, kind, ident, content, send):
        """Call `send()` unless this very content is there already."""
        if self.session.sent.get((kind, ident)) != content:
            send()
            self.session.sent[kind, ident] = content
            self.session.edits += 1

    def note(self, name, value):
        """Count an edit if this is not what `name` was the last time; it is sent in any case."""
        if self.session.values.get(name) != value:
            self.session.values[name] = value
            self.session.edits += 1

    def unchanged_mesh(self, key, owner_key, slot_count):
        """Id (0: no faces) of the mesh of this key if it is as it was, else None."""
        if self._touched is None or key in self._touched or owner_key in self._touched:
            return None
        before = self.session.shapes.get(key, ())
        if len(before) != 1 or before[0][1] != slot_count or key in self._shapes:
            return None
        ident = before[0][0]
        if ident:
            self._met.add((capi.KIND_MESH, ident))
        return ident

    def remember_mesh(self, key, ident, slot_count):
        self._shapes.setdefault(key, []).append((ident, slot_count))

    def put_objects(self, table):
        """All objects, as a fresh ObjectTable."""
        self.session.edits += table.send(self.scene, self.session.objects)
        self.session.objects = table

    def move_objects(self, keys, matrices):
        """As ObjectTable.move()."""
        self.session.edits += self.session.objects.move(self.scene, keys, matrices)

    def finish(self):
        """Remove what is gone. What was sent is seen after the scene's commit."""
        gone = set(self.session.sent) - self._met
        for kind in self.REMOVAL_ORDER:
            idents = sorted(ident for its_kind, ident in gone if its_kind == kind)
            if idents:
                self.scene.remove(kind, idents)
            for ident in idents:
                del self.session.sent[kind, ident]
        self.session.edits += len(gone)
        self.session.shapes = self._shapes


def acquire(key):
    """The session of this key, made when there is none. Raises KestrelError."""
    library = loader.require()
    with _lock:
        if key not in _sessions:
            _sessions[key] = Session(library)
        return _sessions[key]


def drop(key):
    """Free one session, if there is one."""
    with _lock:
        session = _sessions.pop(key, None)
    if session is not None:
        session.release()


def abandon(key):
    """Free one session, if there is one, as soon as the library is done with what it does now;
    does not wait for it."""
    with _lock:
        session = _sessions.pop(key, None)
    if session is not None:
        Call("release", session.release).start()


def drop_all():
    with _lock:
        sessions = list(_sessions.values())
        _sessions.clear()
    for session in sessions:
        session.release()


def count():
    """How many sessions are alive."""
    return len(_sessions)
