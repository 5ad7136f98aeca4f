"""Requests to stop, from the keyboard, a batch system or a terminal that closes: one `KeyboardInterrupt`, then quiet."""

from __future__ import annotations

import signal
import threading
import time as clock
from types import FrameType
from typing import Any

PATIENCE_S = 3.0
"""So long after a request others are taken for the same one: what cleans up is not cut short by a second key."""

REQUESTS = tuple(getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name))


class Interrupts:
    """Turns the first request into a `KeyboardInterrupt` in the main thread; tells whether there was one.

    What is compiled or called back from other languages may swallow it: then the request is known nevertheless.
    """

    def __init__(self) -> None:
        self.requested = False
        self._last = 0.0
        self._before: dict[int, Any] = {}

    def listen(self) -> None:
        """Take requests from now on; those that the caller's process ignores stay ignored."""
        if threading.current_thread() is not threading.main_thread():
            return
        for number in REQUESTS:
            if signal.getsignal(number) not in (signal.SIG_IGN, None):
                self._before[number] = signal.signal(number, self._interrupt)

    def end(self) -> None:
        """Leave further requests to whoever took them before.

        Where an interrupt was raised within an `exec`, as class decorators use it, the interpreter ends by killing itself
        instead of with the exit code, unless it executes something after that.
        """
        exec("")
        for number, before in self._before.items():
            signal.signal(number, before)

    def _interrupt(self, number: int, frame: FrameType | None) -> None:
        before, self._last = self._last, clock.monotonic()
        if self.requested and self._last - before < PATIENCE_S:
            return
        self.requested = True
        raise KeyboardInterrupt
