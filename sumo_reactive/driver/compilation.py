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

from sumo_reactive.driver.kernel_folder import FOLDER_VARIABLE, KernelCache, is_own, kernel_root, own_folder

Function = TypeVar("Function", bound=Callable[..., object])

KERNEL_ROOMS = (
    "driver/geometry", "driver/vehicle", "driver/view", "driver/pilot", "driver/field", "driver/path", "lab/metrics",
)  # fmt: skip
"""Every room with a kernel in it."""

READ_ROOMS = ("driver/nouns",)
"""Every other room with a constant that a kernel reads, which is compiled in."""

_COMPLETE = "complete"


def _cache_folder() -> Path | None:
    package = Path(__file__).parents[1]
    digest = hashlib.sha256(numba.__version__.encode())
    sources = [source for room in (*KERNEL_ROOMS, *READ_ROOMS) for source in sorted((package / room).glob("*.py"))]
    for source in sources:
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
    if CACHE_FOLDER is not None:
        compiled._cache = KernelCache(function, CACHE_FOLDER)
    return cast(Function, compiled)


@contextmanager
def interrupts_kept() -> Iterator[None]:
    """Let an interrupt, or a request to terminate, end what loads kernels as a `KeyboardInterrupt`, whenever it comes.

    The compiler calls back into Python from machine code, which swallows an interrupt there or turns it into a
    `SystemError`.
    """
    taken = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    before = {number: handler for number, handler in taken.items() if callable(handler)}
    if not before or threading.current_thread() is not threading.main_thread():
        yield
        return
    interrupted = False

    def noted(number: int, frame: FrameType | None) -> None:
        nonlocal interrupted
        try:
            before[signal.Signals(number)](number, frame)
        except BaseException:
            interrupted = True
            raise

    for number in before:
        signal.signal(number, noted)
    try:
        yield
    except Exception:
        if not interrupted:
            raise
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
    if interrupted:
        raise KeyboardInterrupt
