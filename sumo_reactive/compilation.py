"""Compiled kernels: one decorator, a disk cache that a changed source can never leave stale, interrupts while they load.

Numba notices a change in the file of a cached function, not in the functions that it calls from other files. The cache
therefore lies in a folder named after the contents of all sources that hold kernels.
"""

from __future__ import annotations

import ast
import hashlib
import os
import signal
import tempfile
import threading
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType
from typing import TypeVar, cast

import numba

from sumo_reactive.overrides import overrides

Function = TypeVar("Function", bound=Callable[..., object])

_KERNEL_ROOMS = ("geometry", "vehicle", "perception", "pilot", "executor")


def _cache_folder() -> Path:
    package = Path(__file__).parent
    digest = hashlib.sha256(numba.__version__.encode())
    sources = [source for room in _KERNEL_ROOMS for source in sorted((package / room).glob("*.py"))]
    for source in (package / "parameters.py", *sources):
        digest.update(source.read_bytes())
    for name, value in _compiled_in(overrides(), sources):
        digest.update(f"{name}={value!r}".encode())
    base = os.environ.get("XDG_CACHE_HOME")
    root = Path(base) if base else Path.home() / ".cache"
    if not os.access(root if root.exists() else root.parent, os.W_OK):
        root = Path(tempfile.gettempdir())
    return root / "sumo_reactive" / digest.hexdigest()[:16]


def _compiled_in(asked: dict[str, float], sources: Iterable[Path]) -> Iterator[tuple[str, float]]:
    """Yield those overrides that kernels read: named in a kernel, or in a constant of a file that may hold some."""
    if not asked:
        return
    read = {name for source in sources for name in _names_compiled(ast.parse(source.read_bytes()))}
    yield from sorted((name, value) for name, value in asked.items() if name in read)


def _names_compiled(module: ast.Module) -> Iterator[str]:
    for node in module.body:
        is_kernel = isinstance(node, ast.FunctionDef) and any(ast.unparse(one) == "kernel" for one in node.decorator_list)
        if is_kernel or isinstance(node, ast.Assign | ast.AnnAssign):
            yield from (part.id for part in ast.walk(node) if isinstance(part, ast.Name))


CACHE_FOLDER = _cache_folder()
numba.config.CACHE_DIR = str(CACHE_FOLDER)  # type: ignore[attr-defined]


def is_cached() -> bool:
    """Whether kernels of exactly these sources were compiled on this machine before."""
    return (CACHE_FOLDER / "complete").exists()


def mark_cached() -> None:
    """Note that every kernel has been compiled once."""
    if CACHE_FOLDER.exists():
        (CACHE_FOLDER / "complete").touch()


def kernel(function: Function) -> Function:
    """Compile `function` to machine code on first call, cached on disk."""
    return cast(Function, numba.njit(cache=True, error_model="numpy")(function))


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
        interrupted = True
        before[signal.Signals(number)](number, frame)

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
