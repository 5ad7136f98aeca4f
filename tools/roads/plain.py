"""Plain XML as netconvert and SUMO read it, and networks made of it."""

from __future__ import annotations

import re
import subprocess
import xml.etree.ElementTree as ET
import zlib
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple
from xml.sax.saxutils import quoteattr

from sumolib import checkBinary

from sumo_reactive.errors import NetworkError

Point = tuple[float, float]

NET = "roads.net.xml"
_OPTIONS = {"nod": "--node-files", "edg": "--edge-files", "con": "--connection-files", "typ": "--type-files"}
_ROOTS = {"nod": "nodes", "edg": "edges", "con": "connections", "typ": "types"}
_GENERATED = re.compile(r"<!-- generated on .*?-->\s*", re.DOTALL)
"""Holds the date and the options with their paths."""


def element(tag: str, *content: str, **attributes: object) -> str:
    """Return an XML element; a trailing underscore of an attribute's name is dropped, an attribute None left out."""
    said = "".join(f" {name.rstrip('_')}={quoteattr(_text(one))}" for name, one in attributes.items() if one is not None)
    return f"<{tag}{said}>{''.join(content)}</{tag}>" if content else f"<{tag}{said}/>"


def document(root: str, elements: Iterable[str]) -> str:
    """Return an XML document with one element of the root on each line."""
    return "\n".join([f"<{root}>", *elements, f"</{root}>", ""])


def node(name: str, place: Point, **attributes: object) -> str:
    """Return a node."""
    return element("node", id=name, x=place[0], y=place[1], **attributes)


def edge(ends: tuple[str, str], *content: str, **attributes: object) -> str:
    """Return an edge, named by its two nodes."""
    return element("edge", *content, id=f"{ends[0]}_{ends[1]}", from_=ends[0], to=ends[1], **attributes)


def both(ends: tuple[str, str], **attributes: object) -> tuple[str, ...]:
    """Return an edge in each direction."""
    return edge(ends, **attributes), edge((ends[1], ends[0]), **attributes)


def joined(before: str, behind: str, lanes: Sequence[tuple[int, int]]) -> tuple[str, ...]:
    """Return the connections between lanes of two edges."""
    return tuple(element("connection", from_=before, to=behind, fromLane=a, toLane=b) for a, b in lanes)


def _text(value: object) -> str:
    return f"{value:.3f}".rstrip("0").rstrip(".") if isinstance(value, float) else str(value)


class Roads(NamedTuple):
    """A network yet to be built: arguments of netgenerate (none: there are `files` alone), plain elements by the kind of
    their file (nod, edg, con, typ), arguments of netconvert. `own_lanes`: vehicle classes that have the right lane for
    themselves on every other street."""

    generate: tuple[str, ...] = ()
    files: Mapping[str, tuple[str, ...]] = {}
    convert: tuple[str, ...] = ()
    own_lanes: str = ""

    def built(self, folder: Path) -> Path:
        """Return the network's file in `folder`; raise NetworkError with what the program said."""
        for kind, elements in self.files.items():
            (folder / f"roads.{kind}.xml").write_text(document(_ROOTS[kind], elements), encoding="utf-8")
        given = [word for kind in self.files for word in (_OPTIONS[kind], str(folder / f"roads.{kind}.xml"))]
        net = folder / NET
        if self.generate:
            _run("netgenerate", [*self.generate, *given, "--output-file", str(net)])
            given = _widened(net, self.own_lanes) if self.own_lanes else ["--sumo-net-file", str(net)]
        if self.convert or self.own_lanes or not self.generate:
            _run("netconvert", [*given, *self.convert, "--output-file", str(net)])
        net.write_text(_GENERATED.sub("", net.read_text(encoding="utf-8"), count=1), encoding="utf-8")
        return net


def _widened(net: Path, classes: str) -> list[str]:
    """Write a network as plain XML, every other street with a lane more, on its right, for these classes alone."""
    prefix = net.parent / "wide"
    _run("netconvert", ["--sumo-net-file", str(net), "--plain-output-prefix", str(prefix)])
    edges = ET.parse(f"{prefix}.edg.xml")
    for road in edges.getroot().iter("edge"):
        street = " ".join(sorted((road.attrib["from"], road.attrib["to"])))
        if zlib.crc32(street.encode()) % 2:
            road.set("numLanes", str(int(road.attrib["numLanes"]) + 1))
            road.insert(0, ET.Element("lane", index="0", allow=classes))
    edges.write(f"{prefix}.edg.xml")
    return ["--node-files", f"{prefix}.nod.xml", "--edge-files", f"{prefix}.edg.xml"]


def _run(program: str, arguments: list[str]) -> None:
    command = [checkBinary(program), *arguments, "--no-warnings"]
    answer = subprocess.run(command, capture_output=True, text=True, encoding="utf-8", errors="replace", check=False)
    if answer.returncode != 0:
        said = " ".join(answer.stderr.split())
        raise NetworkError(f"{program} ends with {answer.returncode}: {said[:300]}")
