"""Compiled kernels: one decorator, and interrupts while they load."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any, TypeVar, cast

import numba
from numba.core.ccallback import CFunc
from numba.core.sigutils import normalize_signature

from sumo_reactive.driver.kernel_cache import KernelCache
from sumo_reactive.driver.kernel_folder import CACHE_FOLDER

Function = TypeVar("Function", bound=Callable[..., object])


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
