"""Compiled kernels: one decorator, a disk cache that a changed source can never leave stale, interrupts while they load.

A kernel is compiled with those that it calls from other files. The cache therefore lies in a folder named after the
contents of all rooms that hold kernels.
"""

from __future__ import annotations

import hashlib
import os
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from types import FrameType
from typing import Any, TypeVar, cast

import numba
from numba.core.ccallback import CFunc
from numba.core.sigutils import normalize_signature

from sumo_reactive.driver.kernel_folder import FOLDER_VARIABLE, KernelCache, is_own, kernel_root, own_folder

Function = TypeVar("Function", bound=Callable[..., object])

KERNEL_ROOMS = (
    "driver/geometry", "driver/vehicle", "driver/view", "driver/pilot", "driver/field", "driver/path", "lab/metrics",
)  # fmt: skip
"""Every room with a kernel in it."""

READ_ROOMS = ("driver/nouns",)
"""Every other room with a constant that a kernel reads, which is compiled in."""

CALLBACK_FILES = ("sumo/crash.py",)
"""Every file with a `callback` in it."""

_COMPLETE = "complete"


def _cache_folder() -> Path | None:
    package = Path(__file__).parents[1]
    digest = hashlib.sha256(numba.__version__.encode())
    sources = [source for room in (*KERNEL_ROOMS, *READ_ROOMS) for source in sorted((package / room).glob("*.py"))]
    for source in (*sources, *(package / file for file in CALLBACK_FILES)):
        digest.update(source.read_bytes())
    root = kernel_root(os.environ)
    return root and own_folder(root / digest.hexdigest()[:16])


CACHE_FOLDER = _cache_folder()
"""Where the kernels of exactly these sources are kept; None where no folder is safe from others."""


def is_kept() -> bool:
    """Whether compiled kernels are there for later runs, too."""
    return CACHE_FOLDER is not None and FOLDER_VARIABLE not in os.environ


def is_cached() -> bool:
    """Whether kernels of exactly these sources were compiled before, for this user or the process that started this one."""
    return CACHE_FOLDER is not None and (CACHE_FOLDER / _COMPLETE).exists()


def mark_cached() -> None:
    """Note that every kernel has been compiled once."""
    if CACHE_FOLDER is not None and is_own(CACHE_FOLDER):
        with suppress(OSError):  # no room: what is not kept has been told
            (CACHE_FOLDER / _COMPLETE).touch()


def kernel(function: Function) -> Function:
    """Compile `function` to machine code on first call, cached on disk."""
    compiled: Any = numba.njit(error_model="numpy")(function)
    compiled._cache = KernelCache(function, CACHE_FOLDER, between_kernels)
    return cast(Function, compiled)


def callback(function: Callable[..., object], signature: Any) -> int:
    """Compile `function` for other languages to call, cached on disk like a kernel; return its address, which stays good."""
    compiled: Any = CFunc(function, normalize_signature(signature), locals={}, options={})
    compiled._cache = KernelCache(function, CACHE_FOLDER, between_kernels)
    compiled.compile()
    _callbacks.append(compiled)
    return int(compiled.address)


_callbacks: list[object] = []


class _Requests:
    """Requests to stop that come while kernels load, and the handlers that they wait for."""

    def __init__(self, handlers: dict[int, Callable[[int, FrameType | None], object]]) -> None:
        self._handlers = handlers
        self._waiting: list[int] = []
        self._raised: BaseException | None = None

    def wait(self, number: int, _: FrameType | None) -> None:
        """Take a request."""
        self._waiting.append(number)

    def come(self) -> None:
        """Let the handlers see what waits. What one of them raises is raised until nobody loads kernels any more."""
        while self._raised is None and self._waiting:
            number = self._waiting.pop()
            try:
                self._handlers[number](number, None)
            except BaseException as raised:
                self._raised = raised
        if self._raised is not None:
            raise self._raised


_loading: list[_Requests] = []


def between_kernels() -> None:
    """Let requests to stop that wait come: no kernel is half loaded."""
    for requests in _loading:
        requests.come()


@contextmanager
def interrupts_kept() -> Iterator[None]:
    """Let an interrupt, or a request to terminate, wait for the kernel that is loaded; it comes before the next.

    The compiler is not made to be cut short: it goes on with what it has not got, and calls back into Python from machine
    code, which swallows an interrupt or turns it into a `SystemError`.
    """
    taken = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    before = {int(number): handler for number, handler in taken.items() if callable(handler)}
    if not before or threading.current_thread() is not threading.main_thread():
        yield
        return
    requests = _Requests(before)
    _loading.append(requests)
    for number in before:
        signal.signal(number, requests.wait)
    try:
        yield
    finally:
        _loading.remove(requests)
        for number, handler in before.items():
            signal.signal(number, handler)
        requests.come()
