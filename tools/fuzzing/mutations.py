"""Ways to spoil a file: its bytes, its values, its structure, what it is."""

from __future__ import annotations

import gzip
import json
import os
import re
from collections.abc import Callable
from copy import deepcopy
from pathlib import Path
from random import Random
from typing import Any
from xml.etree import ElementTree

WORDS = (
    "", " ", "nan", "inf", "-inf", "-1", "0", "1e308", "-1e308", "1e-320", "99999999999999999999", "0x10", "true", "None",
    "[bold]", "[/]", "[red]x[/bold]", "%s", "{0}", "${HOME}", "..", "../..", "/", "/dev/null", "/dev/zero", "a\tb", "\u2028",
    "☃", "\u202eabc", "é" * 40, "x" * 300, "1,2", "1e3 nan", "<b>", "'", '"', "&amp;", "ego", "a.net.xml", ".", "#",
)  # fmt: skip
VALUES: tuple[Any, ...] = (*WORDS, None, True, -1, 0, 10**30, 1.5, -1e300, [], {}, [[]], [None], {"a": {}}, [1, "a"])
_NUMBER = re.compile(rb"-?\d+(?:\.\d+)?")
DEEP = 30_000
"""So many levels are more than any parser's stack takes."""


def flipped(data: bytes, random: Random) -> bytes:
    """Change some bytes."""
    spoilt = bytearray(data)
    for _ in range(random.choice((1, 1, 3, 20))):
        if spoilt:
            spoilt[random.randrange(len(spoilt))] = random.randrange(256)
    return bytes(spoilt)


def cut(data: bytes, random: Random) -> bytes:
    """Leave out the end, or a part within."""
    start = random.randrange(len(data) + 1)
    return data[:start] + (data[random.randrange(start, len(data) + 1) :] if random.random() < 0.5 else b"")


def doubled(data: bytes, random: Random) -> bytes:
    """Repeat a part."""
    start = random.randrange(len(data) + 1)
    end = random.randrange(start, len(data) + 1)
    return data[:end] + data[start:end] * random.choice((1, 5)) + data[end:]


def packed(data: bytes, random: Random) -> bytes:
    """Pack, and cut off."""
    whole = gzip.compress(data, mtime=0)
    return whole[: random.randrange(2, len(whole))]


def another_number(data: bytes, random: Random) -> bytes:
    """Put a word or another number in place of a number."""
    places = list(_NUMBER.finditer(data))
    if not places:
        return data
    place = random.choice(places)
    return data[: place.start()] + _instead_of(place[0].decode(), random).encode() + data[place.end() :]


def _instead_of(text: str, random: Random) -> str:
    """Return a word, or the text with a number in it changed."""
    numbers = list(_NUMBER.finditer(text.encode()))
    if not numbers or random.random() < 0.4:
        return random.choice(WORDS)
    place = random.choice(numbers)
    number = float(place[0]) * random.choice((-1.0, 0.0, 1e-3, 0.5, 2.0, 30.0, 1e3, 1e7))
    number += random.choice((0.0, 0.0, -1.0, 0.1))
    return text[: place.start()] + random.choice(("{:g}", "{:.0f}")).format(number) + text[place.end() :]


def another_line(data: bytes, random: Random) -> bytes:
    """Leave out, repeat or exchange lines, or give a key of TOML another value."""
    lines = data.split(b"\n")
    k, other = random.randrange(len(lines)), random.randrange(len(lines))
    what = random.randrange(4)
    if what == 0:
        del lines[k]
    elif what == 1:
        lines.insert(other, lines[k])
    elif what == 2:
        lines[k], lines[other] = lines[other], lines[k]
    else:
        lines[k] = lines[k].partition(b"=")[0] + b"= " + json.dumps(random.choice(VALUES), ensure_ascii=False).encode()
    return b"\n".join(lines)


def nested(data: bytes, random: Random) -> bytes:
    """Nest deeply, as TOML, JSON or XML can."""
    deep = random.choice((200, DEEP))
    return random.choice((
        b"a = " + b"[" * deep + b"]" * deep,
        data + b"\nx = " + b"[" * deep,
        data + b"\nx = " + b"{a=" * deep,
        b"[" * deep + b"]" * deep,
        b'{"a":' * deep + b"1" + b"}" * deep,
        data.replace(b">", b">" + b"<a>" * deep + b"</a>" * deep, 1),
    ))  # fmt: skip


def another_tree(data: bytes, random: Random) -> bytes:
    """Change an element of XML or a value of JSON; bytes of anything else."""
    for change in (_xml, _json):
        try:
            return change(data, random)
        except (ElementTree.ParseError, ValueError, RecursionError):
            continue
    return flipped(data, random)


def _xml(data: bytes, random: Random) -> bytes:
    root = ElementTree.fromstring(data)
    parents = [element for element in root.iter() if len(element)] or [root]
    for _ in range(random.choice((1, 1, 2, 4))):
        parent = random.choice(parents)
        children = list(parent)
        one = random.choice(children) if children else parent
        what = random.randrange(5)
        if what == 0 and children:
            parent.remove(one)
        elif what == 1:
            parent.insert(random.randrange(len(parent) + 1), deepcopy(one))
        elif what == 2 and one.attrib:
            del one.attrib[random.choice(list(one.attrib))]
        elif what == 3:
            one.tag = random.choice(children or [root]).tag
        elif one.attrib:
            donors = [value for element in parents for value in element.attrib.values()] or [""]
            name = random.choice(list(one.attrib))
            one.set(name, random.choice((_instead_of(one.attrib[name], random), random.choice(donors))))
    return ElementTree.tostring(root, encoding="utf-8")


def _json(data: bytes, random: Random) -> bytes:
    lines = data.strip().split(b"\n")
    is_many = len(lines) > 1 and lines[0].endswith(b"}")
    k = random.randrange(len(lines)) if is_many else 0
    value = json.loads(lines[k] if is_many else data)
    spoilt = json.dumps(_another_value(value, random)).encode()
    return b"\n".join([*lines[:k], spoilt, *lines[k + 1 :], b""]) if is_many else spoilt


def _another_value(value: Any, random: Random) -> Any:
    if isinstance(value, dict | list) and value and random.random() < 0.9:
        key = random.choice(list(value) if isinstance(value, dict) else range(len(value)))
        what = random.randrange(8)
        if what == 0:
            del value[key]
        elif what == 1 and isinstance(value, list):
            value.append(value[key])
        else:
            value[key] = _another_value(value[key], random)
        return value
    return random.choice((*VALUES, float("nan"), float("inf")))


def _pipe(path: Path) -> None:
    os.mkfifo(path)


def _link_to(target: str) -> Callable[[Path], None]:
    return lambda path: path.symlink_to(target)


BYTES = (flipped, cut, doubled, packed, another_number, another_number, another_line, nested, *(6 * [another_tree]))
KINDS: tuple[Callable[[Path], None], ...] = (
    _pipe, Path.mkdir, Path.touch, *map(_link_to, ("/dev/null", "/dev/zero", "loop", "nowhere", "/")), lambda path: None,
)  # fmt: skip


def spoil(path: Path, random: Random) -> str:
    """Spoil a file in place; return how."""
    if not path.is_file() or random.random() < 0.06:
        kind = random.choice(KINDS)
        if path.is_dir() and not path.is_symlink():
            path.rmdir()
        else:
            path.unlink(missing_ok=True)
        kind(path)
        if path.is_symlink() and str(path.readlink()) == "loop":
            path.unlink()
            path.symlink_to(path.name)
        return f"replaced {path.name}"
    change, data = random.choice(BYTES), path.read_bytes()
    is_packed = path.suffix == ".gz" and random.random() < 0.8
    path.write_bytes(gzip.compress(change(gzip.decompress(data), random), mtime=0) if is_packed else change(data, random))
    return f"{change.__name__} {path.name}"
