"""What DuckDB tells of a file that it cannot write, as the error of the operating system that it was."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from contextlib import contextmanager

import duckdb


@contextmanager
def as_os_errors() -> Iterator[None]:
    """Raise an `IOException` of DuckDB as OSError."""
    try:
        yield
    except duckdb.IOException as error:
        if found := re.search(r'"errno":"(\d+)"', str(error)):
            raise OSError(int(found[1]), os.strerror(int(found[1]))) from error
        raise OSError(" ".join(str(error).split())) from error
