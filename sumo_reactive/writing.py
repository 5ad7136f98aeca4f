"""Writing: what is written is there whole or not at all, and follows no link that somebody has planted.

All is written into a folder that only this user may enter, under a name that nobody can guess, beside the place where it
belongs, and moved there when it is complete and on the disk. Moving replaces a link, it does not follow it.
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from sumo_reactive.errors import OutputError

_PARTIAL = ".partial-"
_DEVICES = Path("/dev")


def write_whole(path: Path, data: str | bytes) -> None:
    """Write a file, text as UTF-8; raise OutputError if that cannot be done."""
    with whole_file(path) as partial:
        partial.write_bytes(data.encode("utf-8", errors="backslashreplace") if isinstance(data, str) else data)


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """Give a place to write a file at, for libraries that open it by its name; it comes to `path` at the end.

    An OSError within is raised as OutputError, and leaves what was at `path` before.
    """
    with _told(path), _scratch(path.absolute().parent) as scratch:
        _require_no_device(path)
        partial = scratch / path.name
        yield partial
        _sync(partial)
        partial.replace(path)


@contextmanager
def whole_folder(folder: Path, last: str, replaced: Iterable[Path] = ()) -> Iterator[Path]:
    """Give an empty folder to write into, which comes to be `folder` at the end.

    Where that is there already, the files come into it, and its other files stay but for those `replaced` (paths in it).
    The file `last` says that all are there: it is removed first and comes last. An OSError within is raised as OutputError.
    """
    with _told(folder), _scratch(folder if folder.is_dir() else folder.absolute().parent) as scratch:
        _require_no_link(folder)
        partial = scratch / "whole"
        partial.mkdir()  # with the permissions of any new folder, unlike the one around it
        yield partial
        for path in _files(partial):
            _sync(path)
        _require_no_link(folder)
        if folder.is_dir():
            _clear(folder, [Path(last), *replaced])
            _move_into(folder, partial, partial / last)
        else:
            partial.rename(folder)


def require_writable(path: Path, *, is_folder: bool = False) -> None:
    """Raise OutputError if no file (or folder) can be made or replaced at `path`; make nothing yet."""
    with _told(path):
        _require_no_device(path)
        if is_folder:
            _require_no_link(path)
        existing = next(place for place in (path, *path.absolute().parents) if place.exists())
        if existing == path and path.is_dir() != is_folder:
            raise OutputError(f"{path}: {'a file, not a folder' if is_folder else 'a folder, not a file'}")
        if not os.access(existing, os.W_OK) or (existing != path and not existing.is_dir()):
            raise OutputError(f"{path}: cannot be written: nothing can be made in {existing}")
        limit = os.pathconf(existing, "PC_NAME_MAX")
        if any(len(os.fsencode(part)) > limit for part in path.parts):
            raise OutputError(f"{path}: cannot be written: a name of more than {limit} bytes")


@contextmanager
def _told(path: Path) -> Iterator[None]:
    """Turn an OSError into one line."""
    try:
        yield
    except OSError as error:
        raise OutputError(f"{path}: cannot be written: {error.strerror or error}") from error


@contextmanager
def _scratch(parent: Path) -> Iterator[Path]:
    """Give a folder in `parent` that is gone at the end, and with it, after an error, what of `parent` was made for it."""
    made = [place for place in (parent, *parent.parents) if not place.exists()]
    try:
        parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix=_PARTIAL, dir=parent) as scratch:
            yield Path(scratch)
    except BaseException:
        for place in made:
            with suppress(OSError):
                place.rmdir()
        raise


def _require_no_device(path: Path) -> None:
    is_other = path.exists() and not path.is_file() and not path.is_dir()
    if is_other or path.absolute().parent.resolve() == _DEVICES:
        raise OutputError(f"{path}: cannot be written: a pipe or a device, not a file")


def _require_no_link(folder: Path) -> None:
    if folder.is_symlink():
        raise OutputError(f"{folder}: cannot be written: a link; name the folder that it leads to")


def _files(folder: Path) -> list[Path]:
    return [path for path in sorted(folder.rglob("*")) if path.is_file()]


def _sync(path: Path) -> None:
    """Wait until a file is on the disk: only then is it known that there was room for it."""
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def _clear(folder: Path, names: Iterable[Path]) -> None:
    for path in (folder / name for name in names):
        if path.parent != folder and path.parent.is_symlink():
            continue
        path.unlink(missing_ok=True)
        if path.parent != folder:
            with suppress(OSError):  # holds something else
                path.parent.rmdir()


def _move_into(folder: Path, partial: Path, last: Path) -> None:
    for path in sorted(_files(partial), key=lambda one: one == last):
        target = folder / path.relative_to(partial)
        if target.parent != folder and target.parent.is_symlink():
            target.parent.unlink()
        target.parent.mkdir(exist_ok=True)
        path.replace(target)
