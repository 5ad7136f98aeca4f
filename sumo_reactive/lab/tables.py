"""DuckDB on files that somebody else may have written: they are data, name no other file and load no code."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import duckdb

from sumo_reactive.errors import InputError
from sumo_reactive.files import is_there, require_file

_NO_CODE: dict[str, Any] = {
    "allow_community_extensions": False,
    "autoinstall_known_extensions": False,
    "autoload_known_extensions": False,
    "memory_limit": "2GB",
    "python_enable_replacements": False,
    "temp_directory": "",
}
"""No extension is loaded, and what unpacks to more is refused, not swapped to disk."""

_NO_FILES = {"enable_external_access": False, "lock_configuration": True}

MAX_RECORD_BYTES = 1 << 30
"""No recorded run is larger."""


def require_regular(path: Path, max_bytes: int | None = None) -> None:
    """Raise InputError unless a path is a regular file, not larger than `max_bytes`; a pipe or a device may never end."""
    require_file(path, InputError)
    if not is_there(path):
        raise InputError(f"{path}: no such file")
    size = path.stat().st_size
    if max_bytes is not None and size > max_bytes:
        raise InputError(f"{path}: {size / 1e6:.0f} MB, more than {max_bytes / 1e6:.0f}")


def opened(path: Path | None, *, read_only: bool = False, files: Sequence[str] = ()) -> duckdb.DuckDBPyConnection:
    """Open a database (None: in memory) that gets at no file but its own and `files`, for good; raise `duckdb.Error`."""
    name = str(path or ":memory:")
    if not files:
        return duckdb.connect(name, read_only=read_only, config=_NO_CODE | _NO_FILES)
    database = duckdb.connect(name, read_only=read_only, config=_NO_CODE)
    database.execute("SET allowed_paths = ?", [list(files)])
    for option, value in _NO_FILES.items():
        database.execute(f"SET {option} = {value}")
    return database


def parquet_rows(path: Path, query: str, max_rows: int) -> list[tuple[Any, ...]]:
    """Return what a query over the table `steps` gives, which is the Parquet file at `path` and no other.

    Raises InputError for no regular file or for more rows, `duckdb.Error` for what is not Parquet or lacks a column.
    """
    require_regular(path, MAX_RECORD_BYTES)
    name = str(path.absolute())
    literal = re.sub(r"([*?\[])", r"[\1]", name)  # DuckDB takes a path for a pattern
    with opened(None, files=(name, literal)) as database:
        database.read_parquet(literal).create_view("steps")
        rows: list[tuple[Any, ...]] = database.execute(query).fetchmany(max_rows + 1)
    if len(rows) > max_rows:
        raise InputError(f"{path}: more than {max_rows} rows")
    return rows


@contextmanager
def as_os_errors() -> Iterator[None]:
    """Raise an `IOException` of DuckDB as OSError."""
    try:
        yield
    except duckdb.IOException as error:
        if found := re.search(r'"errno":"(\d+)"', str(error)):
            raise OSError(int(found[1]), os.strerror(int(found[1]))) from error
        raise OSError(" ".join(str(error).split())) from error
