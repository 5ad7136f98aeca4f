"""The code of compiled kernels on disk: a file for each kind of arguments, with a digest that tells of damage."""

from __future__ import annotations

import hashlib
import os
import pickle
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from numba.core.caching import NullCache
from numba.core.compiler import CompileResult
from numba.core.serialize import dumps

from sumo_reactive.errors import OutputError
from sumo_reactive.files import is_own
from sumo_reactive.writing import write_whole

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
