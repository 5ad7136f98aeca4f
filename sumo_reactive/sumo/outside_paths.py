"""Paths in SUMO's files that lead out of a folder: a scenario from elsewhere may name no file to read or write there."""

from __future__ import annotations

import gzip
import os
import re
from contextlib import suppress
from pathlib import Path
from typing import BinaryIO
from xml.parsers.expat import ExpatError, ParserCreate

from sumo_reactive.sumo.config import canonical
from sumo_reactive.sumo.outputs import NOWHERE, silenced

_GZIP_MAGIC = b"\x1f\x8b"
_ABSOLUTE = re.compile(r"[/\\~]|[A-Za-z]:[/\\]")
_OWN_DOCTYPE = "a document type of its own"


def path_outside(file: Path, root: Path) -> str:
    """Return what leads out of the folder `root` in a file of SUMO's: an attribute or text; empty: nothing does.

    A name by an environment variable leads anywhere. What is sent to nowhere at each start does not count: outputs that a
    configuration asks for. A file that is no XML names nothing, since SUMO does not read on in it either.
    """
    found: list[str] = []

    def look(value: str) -> None:
        if not found and leads_out(value, file.parent, root):
            found.append(value.strip())

    def begin(tag: str, attributes: dict[str, str]) -> None:
        option = canonical(tag)
        if silenced({option: ""}) != {option: NOWHERE}:
            for value in attributes.values():
                look(value)

    parser = ParserCreate()
    parser.buffer_text = True
    parser.StartElementHandler, parser.CharacterDataHandler = begin, look
    parser.StartDoctypeDeclHandler = lambda *_: found.append(_OWN_DOCTYPE)
    with file.open("rb") as raw, suppress(ExpatError, EOFError, gzip.BadGzipFile):
        parser.ParseFile(_unpacked(raw))
    return found[0] if found else ""


def leads_out(value: str, folder: Path, root: Path) -> bool:
    """Whether a path, or one of a list, that is named in `folder` may lie outside `root`."""
    return any(_leads_out(one.strip(), folder, root) for one in re.split("[,;]", value))


def _leads_out(path: str, folder: Path, root: Path) -> bool:
    if _ABSOLUTE.match(path) or "${" in path:
        return True
    steps = re.split(r"[/\\]", path)
    return ".." in steps and not Path(os.path.normpath(folder.joinpath(*steps))).is_relative_to(root)


def _unpacked(raw: BinaryIO) -> BinaryIO:
    is_packed = raw.read(2) == _GZIP_MAGIC
    raw.seek(0)
    return gzip.open(raw) if is_packed else raw  # type: ignore[return-value]
