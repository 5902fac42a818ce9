# SPDX-License-Identifier: GPL-3.0-or-later
"""Presses keys in Blender's windows, as the X server would report them. Blender's own simulated
events do not stop a render; these do."""

import ctypes
import time

KEY_PRESS, KEY_RELEASE = 2, 3
XK_ESCAPE = 0xff1b


class KeyEvent(ctypes.Structure):
    """XKeyEvent."""
    _fields_ = [("type", ctypes.c_int), ("serial", ctypes.c_ulong), ("send_event", ctypes.c_int),
                ("display", ctypes.c_void_p), ("window", ctypes.c_ulong), ("root", ctypes.c_ulong),
                ("subwindow", ctypes.c_ulong), ("time", ctypes.c_ulong), ("x", ctypes.c_int),
                ("y", ctypes.c_int), ("x_root", ctypes.c_int), ("y_root", ctypes.c_int),
                ("state", ctypes.c_uint), ("keycode", ctypes.c_uint),
                ("same_screen", ctypes.c_int), ("padding", ctypes.c_long * 24)]


class Keyboard:
    """A connection of our own to the screen that Blender is on."""

    def __init__(self):
        self._x = x = ctypes.CDLL("libX11.so.6")
        x.XOpenDisplay.restype = ctypes.c_void_p
        x.XDefaultRootWindow.restype = ctypes.c_ulong
        x.XDefaultRootWindow.argtypes = x.XCloseDisplay.argtypes = x.XFlush.argtypes = [
            ctypes.c_void_p]
        x.XKeysymToKeycode.argtypes = [ctypes.c_void_p, ctypes.c_ulong]
        x.XKeysymToKeycode.restype = ctypes.c_ubyte
        x.XQueryTree.argtypes = [ctypes.c_void_p, ctypes.c_ulong] + 4 * [ctypes.c_void_p]
        x.XFree.argtypes = [ctypes.c_void_p]
        x.XSendEvent.argtypes = [ctypes.c_void_p, ctypes.c_ulong, ctypes.c_int, ctypes.c_long,
                                 ctypes.c_void_p]
        self._display = x.XOpenDisplay(None)
        if not self._display:
            raise RuntimeError("the X server does not answer")
        self._root = x.XDefaultRootWindow(self._display)

    def close(self):
        self._x.XCloseDisplay(self._display)

    def _children(self, window):
        root, parent = ctypes.c_ulong(), ctypes.c_ulong()
        found, count = ctypes.POINTER(ctypes.c_ulong)(), ctypes.c_uint()
        self._x.XQueryTree(self._display, window, *map(ctypes.byref, (root, parent, found, count)))
        windows = [found[i] for i in range(count.value)]
        if windows:
            self._x.XFree(found)
        return windows

    def press_escape(self):
        """Press and release Escape in every window at the top."""
        code = self._x.XKeysymToKeycode(self._display, XK_ESCAPE)
        now_ms = int(1000.0 * time.monotonic())  # at the same time, it would be a key held down
        for window in self._children(self._root):
            for kind, at_ms in ((KEY_PRESS, now_ms), (KEY_RELEASE, now_ms + 20)):
                event = KeyEvent(type=kind, display=self._display, window=window, root=self._root,
                                 keycode=code, time=at_ms, same_screen=1)
                self._x.XSendEvent(self._display, window, True, 0, ctypes.byref(event))
        self._x.XFlush(self._display)
