"""The process that runs trials for another one, one after another, and the folder for its temporary files."""

from __future__ import annotations

import contextlib
import gc
import importlib
import os
import pickle
import shutil
import signal
import sys
import tempfile
import threading
import time as clock
import traceback
import uuid
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing.connection import Connection
from pathlib import Path
from queue import SimpleQueue
from typing import Any

from sumo_reactive.errors import ReactiveError

_ATTEMPTS, _PAUSE_S = 5, 0.05


def new_scratch() -> Path:
    """Return the name of a folder that nobody can guess, and make nothing."""
    return Path(tempfile.gettempdir()) / f"sumo_reactive_{uuid.uuid4().hex}"


@contextmanager
def scratch() -> Iterator[Path]:
    """Give the name of a folder, and remove what is there at the end."""
    folder = new_scratch()
    try:
        yield folder
    finally:
        remove(folder)


def remove(folder: Path) -> None:
    """Remove a folder, also while others still write there or remove it."""
    for _ in range(_ATTEMPTS):
        shutil.rmtree(folder, ignore_errors=True)
        if not folder.exists():
            return
        clock.sleep(_PAUSE_S)


def main(scratch: str, asking: str, answering: str) -> None:
    """Serve until the other end closes, which it does also by dying: then end at once, whatever runs.

    Orders come and answers go by the two descriptors named. Temporary files go to the folder `scratch`, which is made here
    and removed at such an end.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    Path(scratch).mkdir(mode=0o700, exist_ok=True)
    asked, answers = Connection(int(asking), writable=False), Connection(int(answering), readable=False)
    orders: SimpleQueue[bytes] = SimpleQueue()
    threading.Thread(target=_listen, args=(asked, orders, Path(scratch)), daemon=True).start()
    gc.disable()  # what is imported stays: looking for garbage among it takes a tenth of the start
    with contextlib.suppress(Exception):  # tried again, and told, by the first order
        import sumo_reactive.lab.simulation  # noqa: F401
    gc.enable()
    tempfile.tempdir = scratch
    answers.send(True)  # ready
    while True:
        answers.send(_answer(orders.get()))


def _listen(asked: Connection, orders: SimpleQueue[bytes], scratch: Path) -> None:
    with contextlib.suppress(EOFError):
        while True:
            orders.put(asked.recv_bytes())
    remove(scratch)
    os._exit(0)


def _answer(order: bytes) -> tuple[str, Any, float]:
    """Call the function that an order names with its argument; return how it ended, its value or why not, wall-clock s.

    An error of the user is a failed order, any other a crash with the place where it happened.
    """
    began = clock.perf_counter()
    try:
        function, argument = pickle.loads(order)
        module, _, name = function.partition(":")
        ending, value = "DONE", getattr(importlib.import_module(module), name)(argument)
    except ReactiveError as error:
        ending, value = "FAILED", " ".join(str(error).split())
    except MemoryError:
        ending, value = "CRASHED", "out of memory"
    except Exception as error:
        traceback.print_exc()
        ending, value = "CRASHED", f"internal error: {_told(error)}"
    return ending, value, clock.perf_counter() - began


def _told(error: Exception) -> str:
    last = traceback.extract_tb(error.__traceback__)[-1]
    return f"{type(error).__name__}: {error} ({Path(last.filename).name}:{last.lineno})"


if __name__ == "__main__":
    main(*sys.argv[1:])
