"""SUMO dying of a signal in this process: one line and exit code 3 in place of silence, told by code that needs no Python.

What has corrupted memory may hold any lock, so the handler is compiled, and does nothing but write and end the process.
"""

from __future__ import annotations

import contextlib
import ctypes
import os
import signal
from collections.abc import Iterator
from typing import Any

import numpy as np
from numba import types

from sumo_reactive.driver.compilation import callback
from sumo_reactive.errors import ExitCode

_NAMES = ("SIGSEGV", "SIGABRT", "SIGBUS", "SIGFPE", "SIGILL")
DEADLY = tuple(getattr(signal, name) for name in _NAMES if hasattr(signal, name))
"""Signals that a fault in native code raises."""

EXIT_CODE, EXIT_CODE_WITH_WINDOW = int(ExitCode.SUMO_FAILED), int(ExitCode.INTERRUPTED)
"""As compiled code has them. Closed while it is asked something, SUMO's window takes away what the answer is read from."""

_DIED = (
    "sumo-reactive: SUMO died of {}: a fault of SUMO's that this input brings out, nothing is written\n",
    "sumo-reactive: SUMO died of {}, as it may when its window is closed: nothing is written\n",
)
_HIGHEST = max(map(int, DEADLY), default=0)
_LINES = {
    int(one) + k * (_HIGHEST + 1): np.frombuffer(text.format(one.name).encode(), dtype=np.uint8)
    for one in DEADLY for k, text in enumerate(_DIED)
}  # fmt: skip
_WIDTH = max((line.size for line in _LINES.values()), default=1)
_TEXTS = np.zeros((2 * (_HIGHEST + 1), _WIDTH), dtype=np.uint8)
_SIZES = np.zeros(len(_TEXTS), dtype=np.int64)
for _row, _line in _LINES.items():
    _TEXTS[_row, : _line.size], _SIZES[_row] = _line, _line.size

_STDERR_KEPT = 187
"""A copy of standard error, which SUMO's start redirects; compiled code knows no other way to a descriptor."""

_write: Any = types.ExternalFunction("write", types.intp(types.intc, types.voidptr, types.uintp))
_exit: Any = types.ExternalFunction("_exit", types.void(types.intc))


def _told(number):  # type: ignore[no-untyped-def]
    line = _TEXTS.ctypes.data + number * _WIDTH
    if _write(_STDERR_KEPT, line, _SIZES[number]) < 0:
        _write(2, line, _SIZES[number])
    _exit(EXIT_CODE)


def _told_with_window(number):  # type: ignore[no-untyped-def]
    row = number + _HIGHEST + 1
    line = _TEXTS.ctypes.data + row * _WIDTH
    if _write(_STDERR_KEPT, line, _SIZES[row]) < 0:
        _write(2, line, _SIZES[row])
    _exit(EXIT_CODE_WITH_WINDOW)


@contextlib.contextmanager
def crashes_told(*, has_window: bool = False) -> Iterator[None]:
    """While this lasts, a fault in native code ends the process with one line on standard error and that exit code.

    It is taken for somebody's closing the window where SUMO `has_window`.
    """
    if os.name != "posix":
        yield
        return
    handler = callback(_told_with_window if has_window else _told, types.void(types.intc))
    library = ctypes.CDLL(None)
    library.signal.restype, library.signal.argtypes = ctypes.c_void_p, (ctypes.c_int, ctypes.c_void_p)
    os.dup2(2, _STDERR_KEPT)
    before = {number: library.signal(number, handler) for number in DEADLY}
    try:
        yield
    finally:
        for number, old in before.items():
            library.signal(number, old)
        os.close(_STDERR_KEPT)
