# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds and loads libkestrel.so, once.

It is looked for in the environment variable KESTREL_LIBRARY and in the add-on's native/lib folder,
nowhere else. A failure is remembered as a text for the interface; the add-on stays enabled.
"""

import ctypes
import hashlib
import json
import os
import shutil
import sys
import tempfile
import types
from pathlib import Path

from . import capi

PACKAGED = Path(__file__).resolve().parent / "lib" / "libkestrel.so"
PLUGIN_NAME = "libkestrel_oiio.so"

# Not RTLD_DEEPBIND: the allocator must be Blender's. The packaged library needs no protection from
# Blender's own Embree and TBB, as packaging/bundle.py gave all its symbols private names.
MODE = ctypes.RTLD_LOCAL

# Where the process notes which library it has, for whichever Kestrel asks next: an updated one, or
# another one in another folder.
NOTE = "_kestrel_library"

_library = None
_error = ""
_table = None
_node_table = None
_plugin_loads = None
_device_info = None


def library_path():
    """Where the library should be."""
    chosen = os.environ.get("KESTREL_LIBRARY")
    return Path(chosen) if chosen else PACKAGED


def _digest(path):
    return hashlib.blake2b(path.read_bytes()).hexdigest()


def _loaded(path):
    """The library that this process has loaded already, or None. Raises KestrelError where it is not
    the one at `path`: two at once would share the libraries that they need, whatever their versions.
    """
    note = sys.modules.get(NOTE)
    if note is None:
        return None
    if note.path != os.path.realpath(path):
        raise capi.KestrelError(
            f"Two Kestrels at once: this Blender has already loaded {note.path}. Disable or remove "
            "one of the two in the preferences and restart Blender.")
    if note.digest != _digest(path):
        raise capi.KestrelError(
            "Kestrel was updated while Blender is running, and Blender still holds the old "
            "library. Save your work and restart Blender.")
    return note.cdll


def _open(path):
    """Load the library and note it. Raises OSError."""
    note = types.ModuleType(NOTE)
    note.path, note.digest = os.path.realpath(path), _digest(path)
    if _may_be_overwritten(path):
        with tempfile.TemporaryDirectory(prefix="kestrel-") as folder:
            try:
                shutil.copytree(path.parent, folder, dirs_exist_ok=True)
                note.cdll = ctypes.CDLL(str(Path(folder) / path.name), mode=MODE)
            except OSError:  # no space, or a folder for temporary files that forbids code
                note.cdll = ctypes.CDLL(str(path), mode=MODE)
    else:
        note.cdll = ctypes.CDLL(str(path), mode=MODE)
    sys.modules[NOTE] = note
    return note.cdll


def _may_be_overwritten(path):
    """Whether an update may write into the file while it is in use, which ends the process: Blender's
    installer of add-ons does, that of extensions puts new files in the place of the old ones. A
    library with the image plug-in beside it was not put there by either."""
    is_extension = __package__.startswith("bl_ext.")
    return path == PACKAGED and not is_extension and not path.with_name(PLUGIN_NAME).exists()


def _load(path):
    if not path.is_file():
        raise capi.KestrelError(
            f"There is no Kestrel library at {path}. Install the add-on from its zip file, or name "
            "a libkestrel.so in the environment variable KESTREL_LIBRARY and restart Blender.")
    try:
        cdll = _loaded(path) or _open(path)
    except OSError as error:
        raise capi.KestrelError(
            f"The Kestrel library could not be loaded: {error}. Install what is missing, or an "
            "add-on zip made for this system, and restart Blender.") from error
    try:
        abi = cdll.kestrelGetAbiVersion
        abi.restype = ctypes.c_uint32
        found = abi()
    except AttributeError:
        found = 0
    if found != capi.ABI_VERSION:
        raise capi.KestrelError(
            f"The Kestrel library at {path} speaks interface version {found}, this add-on "
            f"{capi.ABI_VERSION}. Install add-on and library of the same release and restart "
            "Blender.")
    try:
        return capi.Library(cdll)
    except AttributeError as error:
        raise capi.KestrelError(
            f"The Kestrel library at {path} is incomplete ({error}). Install the add-on again and "
            "restart Blender.") from error


def library():
    """The library, or None; then error() says why. Tries only once."""
    global _library, _error
    if _library is None and not _error:
        try:
            _library = _load(library_path())
        except capi.KestrelError as error:
            _error = str(error)
    return _library


def require():
    """The library; raises KestrelError with the reason when there is none."""
    found = library()
    if found is None:
        raise capi.KestrelError(_error)
    return found


def error():
    """Why there is no library; empty when there is one."""
    library()
    return _error


def parameter_table():
    """Rows of the parameter table; none without a library."""
    global _table
    if _table is None:
        found = library()
        _table = json.loads(found.parameter_table()) if found else []
    return _table


def node_table():
    """The table of node instructions. Raises KestrelError where there is no library."""
    global _node_table
    if _node_table is None:
        _node_table = json.loads(require().node_table())
    return _node_table


def device_info():
    """What the library says of this machine, as a dict; asked for once."""
    global _device_info
    if _device_info is None:
        _device_info = json.loads(require().device_info())
    return _device_info


def device_text():
    """The OpenGL device that the library draws with, or why it has none."""
    info = device_info()
    gl = info.get("gl") or {}
    return gl.get("renderer") or f"No OpenGL: {info.get('gl_error', '')}"


def image_plugin_available():
    """Whether the library can read image files itself: its plug-in loads, from where it looks."""
    global _plugin_loads
    if _plugin_loads is None:
        chosen = os.environ.get("KESTREL_IMAGE_PLUGIN")
        path = Path(chosen) if chosen else library_path().with_name(PLUGIN_NAME)
        try:
            ctypes.CDLL(str(path), mode=MODE)
            _plugin_loads = True
        except OSError:
            _plugin_loads = False
    return _plugin_loads


def release():
    """Give the device back; the library itself stays loaded, as unloading is never safe."""
    global _library, _error, _table, _node_table
    if _library is not None:
        _library.release()
    _library, _error, _table, _node_table = None, "", None, None
