"""Every file that SUMO may read for a configuration: whatever this, or a file so found, names and exists.

SUMO tells nobody what it opens, and what names files is scattered over its elements. So each attribute value counts that is
the path of a regular file, whatever the attribute: that may be a file too many, and never one too few.
"""

from __future__ import annotations

import gzip
import hashlib
import os
import re
import zlib
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from html import unescape
from itertools import product
from pathlib import Path
from typing import BinaryIO, NamedTuple

from sumo_reactive.sumo.config import OUTPUT_FILES, canonical

_QUOTED = re.compile(rb"\"([^\"]*)\"|'([^']*)'")
_VARIABLE = re.compile(r"\$\{([^}]+)\}")
_TAG = re.compile(rb"<([\w.:-]+)")
_KEY = re.compile(rb"\bkey\s*=\s*[\"']([^\"']*)[\"']")
_CHUNK_BYTES = 1 << 22
_ALWAYS = "PHEMLIGHT_PATH"
"""SUMO reads emission data there although no file names it."""

_WRITERS = frozenset(
    b"""
    e1Detector inductionLoop e2Detector e2detector laneAreaDetector e3Detector entryExitDetector instantInductionLoop
    edgeData laneData meanData meandata routeProbe vTypeProbe vtypeprobe calibrator timedEvent
    """.split()
)
"""Elements whose files SUMO writes."""

_WRITTEN_PARAMETERS = frozenset(name.encode() for name in OUTPUT_FILES | {"file"})


class Inputs(NamedTuple):
    """The files in the order in which they are found, a digest of their contents, and the environment variables named."""

    files: tuple[Path, ...]
    digest: str
    variables: tuple[str, ...]


def inputs_of(config: Path, words: Sequence[str] = ()) -> Inputs:
    """Return what a configuration, started with some `words_of` options, depends on; itself it is not in the digest.

    What SUMO writes is left out, so that a run does not change what it depends on. Raises OSError for an unreadable file.
    """
    config = config.absolute()
    digest, variables = hashlib.sha256(), {_ALWAYS, *_VARIABLE.findall(" ".join(words))}
    files, found = [config], dict.fromkeys([config.resolve()])
    for file in files:
        contents, bases = hashlib.sha256(), dict.fromkeys((file.parent, config.parent))
        named = [*_paths(sorted(_values(file, contents, variables, _names_in(bases))), bases)]
        if file == config:
            named += _paths(words, (Path.cwd(),))
        else:
            digest.update(contents.digest())
        for path in named:
            if path.resolve() not in found:
                found[path.resolve()] = None
                files.append(path)
    return Inputs(tuple(files[1:]), digest.hexdigest(), tuple(sorted(variables)))


def words_of(sumo_options: Sequence[str]) -> tuple[str, ...]:
    """Return those words of a command line that may matter to `inputs_of`: they name a file to read, or a variable."""
    return tuple(word for word in _words(sumo_options) if "${" in word or any(_paths([word], (Path.cwd(),))))


def _words(options: Sequence[str]) -> Iterator[str]:
    """Yield what may be a path among the words of a command line."""
    last = ""
    for word in options:
        name, is_assigned, value = word.partition("=")
        option = canonical(name.lstrip("-")) if word.startswith("-") else last
        if option not in OUTPUT_FILES:
            yield value if is_assigned and word.startswith("-") else word
        last = "" if is_assigned else option


def _names_in(folders: Iterable[Path]) -> frozenset[bytes]:
    return frozenset(os.fsencode(one.name) for folder in folders if folder.is_dir() for one in folder.iterdir())


def _values(file: Path, contents: hashlib._Hash, variables: set[str], names: frozenset[bytes]) -> set[str]:
    """Return the values in a file that may be paths of what SUMO reads; add its bytes to a digest, and to `variables`."""
    found: set[bytes] = set()
    with file.open("rb") as raw:
        while chunk := raw.read(_CHUNK_BYTES):
            contents.update(chunk)
        raw.seek(0)
        for text in _texts(raw):
            if b"${" in text:
                variables.update(_VARIABLE.findall(os.fsdecode(text)))
            quoted = {one or other for one, other in _QUOTED.findall(text)}
            found |= {value for value in quoted if _may_name(value, names) and not _is_written(value, text)}
    return {unescape(os.fsdecode(value)) for value in found}


def _texts(raw: BinaryIO) -> Iterator[bytes]:
    """Yield the text of a file, unpacked, in parts that begin with a tag; what is damaged SUMO does not read either."""
    packed = raw.read(2)
    raw.seek(0)
    with suppress(EOFError, zlib.error, gzip.BadGzipFile):
        stream = gzip.GzipFile(fileobj=raw) if packed == b"\x1f\x8b" else raw
        left = b""
        while chunk := stream.read(_CHUNK_BYTES):
            whole = left + chunk
            cut = max(whole.rfind(b"<"), 0)
            left = whole[cut:]
            yield whole[:cut]
        yield left


def _may_name(value: bytes, names: frozenset[bytes]) -> bool:
    if value in names or any(letter in value for letter in (b"/", b"\\", b"$", b"~", b"&")):
        return True
    return (b"," in value or b";" in value) and any(one.strip() in names for one in re.split(rb"[,;]", value))


def _is_written(value: bytes, text: bytes) -> bool:
    """Whether a value stands only where SUMO is told what to write."""
    places = [match.start() for match in re.finditer(rb"[\"']" + re.escape(value) + rb"[\"']", text)]
    return all(_writes(text[text.rfind(b"<", 0, place) :].partition(b">")[0]) for place in places)


def _writes(tag: bytes) -> bool:
    name = _TAG.match(tag)
    if name is None:
        return False
    if name[1] == b"param":
        key = _KEY.search(tag)
        return key is not None and key[1] in _WRITTEN_PARAMETERS
    return name[1] in _WRITERS or canonical(name[1].decode()) in OUTPUT_FILES


def _paths(values: Iterable[str], bases: Iterable[Path]) -> Iterator[Path]:
    """Yield the regular files that values name, alone or as a list, from any of the folders."""
    for value in values:
        expanded = _VARIABLE.sub(lambda match: os.environ.get(match[1], ""), value)
        names = dict.fromkeys((expanded.strip(), *(one.strip() for one in re.split("[,;]", expanded))))
        for name, base in product(filter(None, names), bases):
            with suppress(OSError, ValueError, RuntimeError):
                path = base / Path(name).expanduser()
                if path.is_file():
                    yield path
