"""Where compiled kernels are kept: what is loaded from there runs, so it is a folder that nobody else can write to."""

from __future__ import annotations

import atexit
import os
import shutil
import stat
import tempfile
from collections.abc import Mapping
from pathlib import Path

FOLDER_VARIABLE = "SUMO_REACTIVE_KERNELS"
"""Environment variable by which a process shares a folder of its own with those that it starts: `process id:path`."""

_OTHERS_WRITE = stat.S_IWGRP | stat.S_IWOTH


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


def is_own(folder: Path) -> bool:
    """Whether a folder is there, is this user's, and can be written to by nobody else."""
    try:
        found = folder.lstat()
    except OSError:
        return False
    is_mine = stat.S_ISDIR(found.st_mode) and found.st_uid == os.geteuid()
    return is_mine and not found.st_mode & _OTHERS_WRITE and os.access(folder, os.W_OK)


def _is_safe(place: Path) -> bool:
    """Whether what is in a folder can be replaced by its owner, root and this user at most; a missing one is made."""
    if not os.path.lexists(place):
        place.mkdir(mode=0o700)
    found = place.lstat()
    is_kept = not found.st_mode & _OTHERS_WRITE or bool(found.st_mode & stat.S_ISVTX)
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
