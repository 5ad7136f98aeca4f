"""Where compiled kernels are kept: a folder that nobody else can write to, since what is loaded from it runs.

A kernel is compiled with those that it calls from other files. The folder is therefore named after the contents of all
rooms that hold kernels: a changed source never leaves a stale one. The compiler is not loaded to look for it.
"""

from __future__ import annotations

import atexit
import hashlib
import os
import shutil
import stat
import tempfile
from collections.abc import Mapping
from contextlib import suppress
from importlib.metadata import version
from pathlib import Path

from sumo_reactive.files import OTHERS_WRITE, is_own

FOLDER_VARIABLE = "SUMO_REACTIVE_KERNELS"
"""Environment variable by which a process shares a folder of its own with those that it starts: `process id:path`."""


def kernel_root(environment: Mapping[str, str]) -> Path | None:
    """Return the user's cache, if only this user can write to it; else one that lasts as long as this process.

    None: not even the folder for temporary files is safe from others.
    """
    cache = environment.get("XDG_CACHE_HOME") or "~/.cache"
    return own_folder(Path(cache, "sumo_reactive")) or _shared(environment) or _private()


def own_folder(folder: Path) -> Path | None:
    """Return the folder without links, made if need be, if this user alone can write there or replace what leads there."""
    try:
        real = folder.expanduser().resolve()
        for place in reversed(real.parents):
            if not _is_safe(place):
                return None
        return real if _is_safe(real) and is_own(real) else None
    except (OSError, RuntimeError):
        return None


def _is_safe(place: Path) -> bool:
    """Whether what is in a folder can be replaced by its owner, root and this user at most; a missing one is made."""
    if not os.path.lexists(place):
        place.mkdir(mode=0o700)
    found = place.lstat()
    is_kept = not found.st_mode & OTHERS_WRITE or bool(found.st_mode & stat.S_ISVTX)
    return stat.S_ISDIR(found.st_mode) and found.st_uid in (0, os.geteuid()) and is_kept


def _shared(environment: Mapping[str, str]) -> Path | None:
    maker, _, name = environment.get(FOLDER_VARIABLE, "").partition(":")
    folder = Path(name)
    if not name or not is_own(folder):
        return None
    if maker == str(os.getpid()):  # this process itself, before it started another program in its place
        _remove_at_exit(folder)
    return own_folder(folder)


def _private() -> Path | None:
    try:
        folder = Path(tempfile.mkdtemp(prefix="sumo_reactive_kernels_"))
    except OSError:
        return None
    _remove_at_exit(folder)
    if own := own_folder(folder):
        os.environ[FOLDER_VARIABLE] = f"{os.getpid()}:{own}"
    return own


def _remove_at_exit(folder: Path) -> None:
    maker = os.getpid()

    def remove() -> None:
        if os.getpid() == maker:
            shutil.rmtree(folder, ignore_errors=True)

    atexit.register(remove)


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
    digest = hashlib.sha256(version("numba").encode())
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
