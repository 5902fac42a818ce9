# SPDX-License-Identifier: GPL-3.0-or-later
"""Messages: the library's and the add-on's own, on the terminal and collected for the artist."""

import collections
import contextlib
import os
import sys
import threading
import traceback

from .native import capi, loader

LEVELS = ("debug", "info", "warning", "error")
REMEMBERED = 200  # messages

_lock = threading.Lock()
_collectors = []
_recent = collections.deque(maxlen=REMEMBERED)
_callback = None  # ctypes does not keep it alive


def _write(level, text):
    _recent.append(f"{level}: {text}")
    print(f"kestrel: {level}: {text}", flush=True, file=sys.stdout)


def warning(text):
    _write("warning", text)
    with _lock:
        for messages in _collectors:
            messages.append(text)


def error(text):
    _write("error", text)


def recent():
    """The newest messages of this session, oldest first, as they stand on the terminal."""
    return list(_recent)


@contextlib.contextmanager
def collecting():
    """The list that this block's warnings go to, from whatever thread."""
    messages = []
    with _lock:
        _collectors.append(messages)
    try:
        yield messages
    finally:
        with _lock:
            _collectors.remove(messages)


def _from_library(_user, level, text):
    words = (text or b"").decode("utf-8", "replace")
    if level == capi.LOG_WARNING:
        warning(words)
    else:
        _write(LEVELS[min(max(level, 0), 3)], words)


def mistake(error):
    """What to tell the artist of an exception that is nobody's but Kestrel's fault; its traceback
    goes to the terminal."""
    traceback.print_exception(error, file=sys.stdout)
    return (f"Kestrel made a mistake ({type(error).__name__}: {error}). Please report it with the "
            "lines above this one in the terminal.")


def register():
    global _callback
    library = loader.library()
    if library is not None:
        _callback = capi.LogCallback(_from_library)
        library.set_log_callback(_callback)
        if os.environ.get("KESTREL_LOG") == "debug":
            _write("debug", f"Kestrel {library.version()} from {loader.library_path()}, "
                            f"OpenGL device: {loader.device_text()}")


def unregister():
    global _callback
    library = loader.library()
    if library is not None and _callback is not None:
        library.set_log_callback(None)
    _callback = None
    _recent.clear()
