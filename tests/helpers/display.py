"""A display without a screen, and what somebody at it would do to SUMO's window."""

import ctypes
import ctypes.util
import os
import shutil
import subprocess
import time
from contextlib import contextmanager

XVFB, X11 = shutil.which("Xvfb"), ctypes.util.find_library("X11")
NO_DISPLAY = "no display without a screen on this machine: Xvfb or libX11 is not installed"
CLIENT_MESSAGE, WORDS, LONGS = 33, 32, 24
SECONDS = 60


class ClientMessage(ctypes.Structure):
    """`XClientMessageEvent`, as long as any event."""

    _fields_ = (
        ("type", ctypes.c_int), ("serial", ctypes.c_ulong), ("is_sent", ctypes.c_int), ("display", ctypes.c_void_p),
        ("window", ctypes.c_ulong), ("message", ctypes.c_ulong), ("format", ctypes.c_int), ("data", ctypes.c_long * 5),
        ("rest", ctypes.c_long * LONGS),
    )  # fmt: skip


@contextmanager
def display():
    """Give the name of a display that is there until the end."""
    out, into = os.pipe()
    command = [XVFB, "-displayfd", str(into), "-screen", "0", "1280x900x24", "-nolisten", "tcp"]
    quiet = {"stdin": subprocess.DEVNULL, "stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    with subprocess.Popen(command, pass_fds=[into], **quiet) as server:
        os.close(into)
        try:
            with os.fdopen(out) as said:
                yield f":{said.readline().strip()}"
        finally:
            server.terminate()


def close_window(name, title):
    """Ask the window on a display whose title begins so to close, as its frame's button does; wait until it is there."""
    x11 = ctypes.CDLL(X11)
    x11.XOpenDisplay.restype = ctypes.c_void_p
    x11.XInternAtom.restype = x11.XDefaultRootWindow.restype = ctypes.c_ulong
    server = ctypes.c_void_p(x11.XOpenDisplay(name.encode()))
    ends = time.monotonic() + SECONDS
    while (window := next(windows_of(x11, server, title), None)) is None:
        assert time.monotonic() < ends, f"no window {title}"
        time.sleep(0.2)
    event = ClientMessage(type=CLIENT_MESSAGE, window=window, format=WORDS)
    event.message = x11.XInternAtom(server, b"WM_PROTOCOLS", 0)
    event.data[0] = x11.XInternAtom(server, b"WM_DELETE_WINDOW", 0)
    x11.XSendEvent(server, ctypes.c_ulong(window), 0, ctypes.c_long(0), ctypes.byref(event))
    x11.XCloseDisplay(server)


def windows_of(x11, server, title):
    """Yield the windows whose title begins so."""
    root = ctypes.c_ulong(x11.XDefaultRootWindow(server))
    owner, parent, count = ctypes.c_ulong(), ctypes.c_ulong(), ctypes.c_uint()
    children = ctypes.POINTER(ctypes.c_ulong)()
    x11.XQueryTree(server, root, *map(ctypes.byref, (owner, parent, children, count)))
    for window in children[: count.value]:
        text = ctypes.c_char_p()
        x11.XFetchName(server, ctypes.c_ulong(window), ctypes.byref(text))
        if (text.value or b"").startswith(title.encode()):
            yield window
