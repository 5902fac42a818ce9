# SPDX-License-Identifier: GPL-3.0-or-later
"""What lives longer than a render: one core scene and renderer per Blender scene and view layer.

Blender frees the engine object after every frame, so the sessions stand here, by key. They go when
another file is opened, when the add-on is disabled and after a failed export.
"""

import hashlib
import threading

from .native import capi, loader

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


class Session:
    """A core scene, its renderer, and what has been sent to them."""

    def __init__(self, library):
        self.scene = capi.Scene(library)
        self.renderer = capi.Renderer(self.scene)
        self.unseen_material = ""   # the camera does not meet objects of this material
        self.sent = {}              # (kind, id): what was sent last
        self.sent_settings = set()  # units that were given settings
        self.warned = set()         # texts that were already said
        self.means = {}             # (kind of mean, texture, its content): mean colour
        self.values = {}            # name: settings, world and what else is no item
        self.shapes = {}            # mesh key: [(mesh id, slots), ...] of the last export
        self.edits = 0              # how often anything was sent that is not as it was
        self._busy = threading.Lock()

    def render(self, width, height, progress):
        """Render a frame; blocks. `progress(fraction, status)` returns False to cancel."""
        with self._busy:
            self.renderer.render(width, height, progress)

    def release(self):
        """Free everything, after ending a render that is under way."""
        self.renderer.cancel()
        with self._busy:
            self.renderer.release()
            self.scene.release()


class Export:
    """One pass over Blender's data into a session's scene.

    Items that are unchanged are not sent again; items that were not met are removed at the end.
    """

    # What refers to others goes before what it refers to.
    REMOVAL_ORDER = (capi.KIND_OBJECT, capi.KIND_LIGHT, capi.KIND_MATERIAL, capi.KIND_TEXTURE,
                     capi.KIND_MESH)

    def __init__(self, session, say, environment_ior=1.0, touched=None):
        """`say(text)` takes warnings; each text is said once per session. `touched`: keys of the
        objects and data whose geometry may have changed since the last export, None for all."""
        self.session = session
        self.environment_ior = environment_ior
        self.scene = session.scene
        self._say = say
        self._met = set()   # (kind, id)
        self.meshes = {}    # evaluated data: mesh id
        self.materials = {}  # material key: id
        self.textures = {}  # texture reference: id
        self._touched = touched
        self._shapes = {}   # as Session.shapes

    def warn(self, text):
        if text not in self.session.warned:
            self.session.warned.add(text)
            self._say(text)

    def new_id(self, kind, key):
        """Id of an item that is met for the first time in this export; `key` is text or bytes."""
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

    def put_object(self, ident, description, matrix):
        """`description`: set_object()'s, without the matrix. Only the matrix is sent if it alone
        changed."""
        key = (capi.KIND_OBJECT, ident)
        before = self.session.sent.get(key)
        if before == (description, matrix):
            return
        if before is not None and before[0] == description:
            self.scene.set_object_transform(ident, matrix)
        else:
            self.scene.set_object(ident, *description, matrix)
        self.session.sent[key] = (description, matrix)
        self.session.edits += 1

    def finish(self):
        """Remove what is gone. What was sent is seen after the scene's commit."""
        gone = set(self.session.sent) - self._met
        for kind in self.REMOVAL_ORDER:
            for item in sorted(item for item in gone if item[0] == kind):
                self.scene.remove(*item)
                del self.session.sent[item]
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


def drop_all():
    with _lock:
        sessions = list(_sessions.values())
        _sessions.clear()
    for session in sessions:
        session.release()


def count():
    """How many sessions are alive."""
    return len(_sessions)
