"""Another text in the place of an XML file's, line by line: all of it or none."""

from __future__ import annotations

import gzip
import shutil
import tempfile
from collections.abc import Callable
from os import close
from pathlib import Path
from typing import IO

_GZIP, _XML = b"\x1f\x8b", b"<?xml"


def rewrite_lines(path: Path, edited: Callable[[str], str]) -> str:
    """Put every line of an XML file, compressed or not, through `edited`; return why that was not done (empty: it was)."""
    target = path.resolve()
    if not target.is_file():
        return "no such file"
    try:
        with target.open("rb") as file:
            is_compressed = file.read(len(_GZIP)) == _GZIP
        with _opened(target, "rb", is_compressed) as content:
            if content.read(len(_XML)) != _XML:
                return "not XML"
        _rewrite(target, edited, is_compressed)
    except (OSError, EOFError) as error:
        return getattr(error, "strerror", None) or str(error)
    return ""


def _rewrite(target: Path, edited: Callable[[str], str], is_compressed: bool) -> None:
    handle, partial = tempfile.mkstemp(prefix=f".{target.name}.", dir=target.parent)
    close(handle)
    try:
        with _opened(target, "rt", is_compressed) as lines, _opened(Path(partial), "wt", is_compressed) as out:
            out.writelines(edited(line) for line in lines)
        shutil.copymode(target, partial)
        Path(partial).replace(target)
    finally:
        Path(partial).unlink(missing_ok=True)


def _opened(path: Path, mode: str, is_compressed: bool) -> IO:  # type: ignore[type-arg]
    text = {"encoding": "utf-8", "errors": "surrogateescape", "newline": ""} if "t" in mode else {}
    return gzip.open(path, mode, **text) if is_compressed else path.open(mode, **text)  # type: ignore[call-overload,no-any-return]
