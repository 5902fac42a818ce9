# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds and loads libkestrel.so, once.

It is looked for in the environment variable KESTREL_LIBRARY and in the add-on's native/lib folder,
nowhere else. A failure is remembered as a text for the interface; the add-on stays enabled.
"""

import ctypes
import json
import os
from pathlib import Path

from . import capi

PACKAGED = Path(__file__).resolve().parent / "lib" / "libkestrel.so"
PLUGIN_NAME = "libkestrel_oiio.so"

# Not RTLD_DEEPBIND: the allocator must be Blender's. The packaged library needs no protection from
# Blender's own Embree and TBB, as packaging/bundle.py gave all its symbols private names.
MODE = ctypes.RTLD_LOCAL
MAPS = Path("/proc/self/maps")
DELETED = " (deleted)"  # what Linux appends to the path of a mapped file that is gone

_library = None
_error = ""
_table = None
_plugin_loads = None


def library_path():
    """Where the library should be."""
    chosen = os.environ.get("KESTREL_LIBRARY")
    return Path(chosen) if chosen else PACKAGED


def mapped_libraries():
    """Paths of all Kestrel libraries in this process, as Linux gives them."""
    lines = MAPS.read_text().splitlines() if MAPS.exists() else []
    paths = {line.split(None, 5)[5] for line in lines if "/" in line}
    return sorted(path for path in paths
                  if Path(path.removesuffix(DELETED)).name == PACKAGED.name)


def _refuse_a_second(path):
    """Raise KestrelError where this process has another Kestrel library than the one at `path`.

    The system's loader would hand out the old one for the path of a file that was replaced, and mix
    the parts of two that lie in different folders.
    """
    for found in mapped_libraries():
        if found.endswith(DELETED):
            raise capi.KestrelError(
                "Kestrel was updated or removed while Blender is running, and Blender still holds "
                "the old library. Save your work and restart Blender.")
        if found != os.path.realpath(path):
            raise capi.KestrelError(
                f"Two Kestrels at once: this Blender has already loaded {found}. Disable or remove "
                "one of the two in the preferences and restart Blender.")


def _load(path):
    if not path.is_file():
        raise capi.KestrelError(
            f"There is no Kestrel library at {path}. Install the add-on from its zip file, or name "
            "a libkestrel.so in the environment variable KESTREL_LIBRARY and restart Blender.")
    _refuse_a_second(path)
    try:
        cdll = ctypes.CDLL(str(path), mode=MODE)
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
    global _library, _error, _table
    if _library is not None:
        _library.release()
    _library, _error, _table = None, "", None
