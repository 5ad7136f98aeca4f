"""The one door for files from outside: a regular file of bounded size, unpacked, or one line that says why not."""

from __future__ import annotations

import gzip
import io
import os
import stat
import zlib
from pathlib import Path
from typing import IO

from sumo_reactive.errors import InputError, ScenarioError

_MOST_BYTES = 2**32
"""More than this is read from no file, packed or not."""

OTHERS_WRITE = stat.S_IWGRP | stat.S_IWOTH
"""Bits of a mode by which others than the owner may write."""

_PART_BYTES = 2**24
_GZIP_MAGIC = b"\x1f\x8b"
_KINDS = (
    (stat.S_ISDIR, "a directory"),
    (stat.S_ISFIFO, "a pipe"),
    (stat.S_ISCHR, "a device"),
    (stat.S_ISBLK, "a device"),
    (stat.S_ISSOCK, "a socket"),
)


def content_of(path: Path, error: type[InputError] = ScenarioError, most: int = _MOST_BYTES) -> bytes:
    """Return what a file holds, unpacked if it is gzipped; raise `error` for what is no file of at most `most` bytes.

    A pipe or device is not waited for.
    """
    try:
        handle = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
        try:
            _require_regular(path, os.fstat(handle).st_mode, error)
            with open(handle, "rb", closefd=False) as file:
                data = _bounded(file, most)
        finally:
            os.close(handle)
        if data.startswith(_GZIP_MAGIC):
            data = _bounded(gzip.GzipFile(fileobj=io.BytesIO(data)), most)
    except FileNotFoundError as problem:
        raise error(f"{path}: no such file") from problem
    except EOFError as problem:
        raise error(f"{path}: cannot be read: packed, and cut off before its end") from problem
    except (OSError, ValueError, zlib.error) as problem:
        raise error(f"{path}: cannot be read: {getattr(problem, 'strerror', None) or problem}") from problem
    if len(data) > most:
        raise error(f"{path}: cannot be read: more than {most / 1e6:.0f} MB")
    return data


def text_of(path: Path, error: type[InputError] = ScenarioError, most: int = _MOST_BYTES) -> str:
    """Return the text in a file, which is UTF-8; raise what `content_of` raises."""
    try:
        return content_of(path, error, most).decode("utf-8-sig")
    except UnicodeDecodeError as problem:
        raise error(f"{path}: cannot be read: not UTF-8 at byte {problem.start}") from problem


def is_there(path: Path) -> bool:
    """Whether something is at `path`, whatever it is; a name that cannot be names nothing."""
    try:
        path.stat()
    except (OSError, ValueError):
        return False
    return True


def is_own(folder: Path) -> bool:
    """Whether a folder is there, is this user's, and can be written to by nobody else."""
    try:
        found = folder.lstat()
    except OSError:
        return False
    is_mine = stat.S_ISDIR(found.st_mode) and found.st_uid == os.geteuid()
    return is_mine and not found.st_mode & OTHERS_WRITE and os.access(folder, os.W_OK)


def require_file(path: Path, error: type[InputError] = ScenarioError) -> None:
    """Raise `error` if `path` is there and something else than a file: whoever opened it might wait for ever."""
    try:
        mode = path.stat().st_mode
    except FileNotFoundError:
        return
    except (OSError, ValueError) as problem:
        raise error(f"{path}: cannot be read: {getattr(problem, 'strerror', None) or problem}") from problem
    _require_regular(path, mode, error)


def _bounded(stream: IO[bytes] | gzip.GzipFile, most: int) -> bytes:
    """Return what a stream gives, or a part of it that is longer than `most` bytes; takes no more memory than that is."""
    parts: list[bytes] = []
    left = most + 1
    while left > 0 and (part := stream.read(min(left, _PART_BYTES))):
        parts.append(part)
        left -= len(part)
    return b"".join(parts)


def _require_regular(path: Path, mode: int, error: type[InputError]) -> None:
    kind = next((name for is_kind, name in _KINDS if is_kind(mode)), None)
    if kind:
        raise error(f"{path}: {kind}, not a file")
