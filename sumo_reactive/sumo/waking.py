"""SUMO's window in this process ends cleanly: its thread is woken while `libsumo.close` waits for it.

Closing, libsumo 1.28 asks the window's thread to end and joins it, but does not wake it: where no event of the window
system happens to come, it sits in `select` for ever, and the caller holds the interpreter's lock. A timer of the system
sends that thread a signal until it has seen that it is to end.
"""

from __future__ import annotations

import ctypes
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

_TASKS = Path("/proc/self/task")
_PERIOD_NS = 50_000_000
_MONOTONIC, _TO_THREAD = 1, 4
"""`CLOCK_MONOTONIC` and `SIGEV_THREAD_ID` of Linux."""


class _Event(ctypes.Structure):
    """`struct sigevent` of Linux, 64 bytes."""

    _fields_ = (
        ("value", ctypes.c_void_p), ("signal", ctypes.c_int), ("notify", ctypes.c_int), ("thread", ctypes.c_int),
        ("rest", ctypes.c_int * 11),
    )  # fmt: skip


class _Times(ctypes.Structure):
    """`struct itimerspec`: period and first time, each in s and ns."""

    _fields_ = tuple((name, ctypes.c_long) for name in ("period_s", "period_ns", "first_s", "first_ns"))


def threads_here() -> frozenset[int]:
    """Return the system's ids of the threads of this process; nobody where the system does not tell."""
    return frozenset(int(task.name) for task in _TASKS.iterdir()) if sys.platform == "linux" else frozenset()


@contextmanager
def woken(threads: frozenset[int]) -> Iterator[None]:
    """Interrupt again and again what these threads wait for; those that have ended meanwhile are left alone."""
    if not threads or threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGALRM, lambda *_: None)
    library = ctypes.CDLL(None)
    timers = [_timer(library, thread) for thread in threads & threads_here()]
    try:
        yield
    finally:
        for timer in timers:
            library.timer_delete(timer)
        signal.signal(signal.SIGALRM, before)


def _timer(library: ctypes.CDLL, thread: int) -> ctypes.c_void_p:
    timer = ctypes.c_void_p()
    event = _Event(signal=signal.SIGALRM, notify=_TO_THREAD, thread=thread)
    if library.timer_create(_MONOTONIC, ctypes.byref(event), ctypes.byref(timer)) == 0:
        library.timer_settime(timer, 0, ctypes.byref(_Times(0, _PERIOD_NS, 0, _PERIOD_NS)), None)
    return timer
