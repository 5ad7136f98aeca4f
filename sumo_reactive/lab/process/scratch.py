"""Folders for temporary files that outlive neither the process that asks for one nor those that work in it.

Whoever asks chooses the name alone; the processes that work there make the folder, and remove it when he is gone.
"""

from __future__ import annotations

import shutil
import tempfile
import time as clock
import uuid
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

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
