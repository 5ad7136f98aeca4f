"""Compiled kernels on disk: a folder that nobody else can write to, since what is loaded from it runs, and a file each.

A file holds the code of a kernel for its kinds of arguments, with a digest that tells if it is damaged.
"""

from __future__ import annotations

import atexit
import hashlib
import os
import pickle
import shutil
import stat
import sys
import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from numba.core.caching import NullCache
from numba.core.compiler import CompileResult
from numba.core.serialize import dumps

from sumo_reactive.errors import OutputError
from sumo_reactive.writing import write_whole

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


_DIGEST_BYTES = 32
_told: set[str] = set()


class KernelCache(NullCache):
    """What numba asks for the compiled code of a function. Nothing that goes wrong on disk ends the run: it is compiled.

    A folder of None keeps nothing. `asked` is called each time, before a kernel is loaded or compiled.
    """

    def __init__(self, function: Callable[..., object], folder: Path | None, asked: Callable[[], None]) -> None:
        self._name = f"{function.__module__}.{function.__qualname__}"
        self._folder = folder
        self._asked = asked

    @property
    def cache_path(self) -> str:
        """The folder, for numba's own reports."""
        return str(self._folder)

    def load_overload(self, signature: Any, target_context: Any) -> CompileResult | None:
        """Return the code for arguments of these kinds, if it is there and whole."""
        self._asked()
        target_context.refresh()
        file = self._file(signature, target_context.codegen())
        data = _whole(file) if file else None
        return None if data is None else CompileResult._rebuild(target_context, *pickle.loads(data))

    def save_overload(self, signature: Any, result: Any) -> None:
        """Keep the code for arguments of these kinds."""
        file = self._file(signature, result.codegen)
        if file is None or result.library.has_dynamic_globals:
            return
        data = dumps(result._reduce())
        try:
            write_whole(file, hashlib.sha256(data).digest() + data)
        except OutputError as error:
            _tell(f"compiled kernels are not kept: {error}")

    def _file(self, signature: Any, codegen: Any) -> Path | None:
        if self._folder is None or not is_own(self._folder):
            return None
        kinds = f"{sys.implementation.cache_tag} {self._name} {signature!r} {codegen.magic_tuple()!r}"
        return self._folder / f"{self._name}-{hashlib.sha256(kinds.encode()).hexdigest()[:16]}"


def _whole(file: Path) -> bytes | None:
    """Return what was kept in a file; None if it is not there, or not as it was written."""
    try:
        content = file.read_bytes()
    except FileNotFoundError:
        return None
    except OSError as error:
        _tell(f"{file}: {error.strerror}; compiling this kernel again")
        return None
    digest, data = content[:_DIGEST_BYTES], content[_DIGEST_BYTES:]
    if hashlib.sha256(data).digest() == digest:
        return data
    _tell(f"{os.fspath(file.parent)}: damaged kernels are compiled again")
    return None


def _tell(line: str) -> None:
    """Say a line once in a process."""
    if line not in _told:
        _told.add(line)
        print(line, file=sys.stderr)
