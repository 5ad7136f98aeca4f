"""A SUMO network file as parsed: attributes by id, nothing interpreted yet."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from xml.etree.ElementTree import Element, ParseError, fromstring

from sumo_reactive.errors import NetworkError
from sumo_reactive.files import content_of

Attributes = Mapping[str, str]


@dataclass(frozen=True, eq=False)
class RawNet:
    """Edges and junctions by id, and `<connection>` attributes in file order by the lane they leave and enter.

    `leaving` holds every connection; `arriving` only those that come from a normal edge.
    """

    path: Path
    left_hand: bool
    edges: Mapping[str, Element]
    junctions: Mapping[str, Element]
    leaving: Mapping[str, Sequence[Attributes]]
    arriving: Mapping[str, Sequence[Attributes]]
    joining: Mapping[tuple[str, str], Sequence[str]]  # edges by (from junction, to junction)

    def edge(self, edge_id: str) -> Element:
        """Return an edge; raise NetworkError if the network has none of that id."""
        if edge_id not in self.edges:
            raise NetworkError(f"{self.path}: unknown edge '{edge_id}'")
        return self.edges[edge_id]

    def function(self, edge_id: str) -> str:
        """Return an edge's function: normal, internal, crossing, walkingarea, connector."""
        return self.edge(edge_id).get("function", "normal")

    def lane_ids(self, edge_id: str) -> list[str]:
        """Return the ids of an edge's lanes, outermost first."""
        return [lane.attrib["id"] for lane in self.edge(edge_id).findall("lane")]


def from_lane_id(connection: Attributes) -> str:
    """Return the id of the lane that a connection leaves."""
    return f"{connection['from']}_{connection['fromLane']}"


def to_lane_id(connection: Attributes) -> str:
    """Return the id of the lane that a connection enters."""
    return f"{connection['to']}_{connection['toLane']}"


def edge_id_of(lane_id: str) -> str:
    """Return the id of the edge that a lane belongs to; SUMO names lanes `<edge>_<index>`."""
    return lane_id.rpartition("_")[0]


def parse(path: Path) -> RawNet:
    """Parse a `.net.xml` or `.net.xml.gz`; raise NetworkError if it is no network with internal lanes."""
    root = _root(path)
    if root.tag != "net":
        raise NetworkError(f"{path}: not a SUMO network: root element is <{root.tag}>, not <net>")
    try:
        raw = _sorted_by_kind(path, root)
    except KeyError as error:
        raise NetworkError(f"{path}: an <edge>, <junction> or <connection> lacks attribute {error}") from error
    if not raw.edges:
        raise NetworkError(f"{path}: the network has no edges")
    _require_internal_lanes(raw)
    return raw


def _root(path: Path) -> Element:
    try:
        return fromstring(content_of(path, NetworkError))
    except (ParseError, ValueError, LookupError) as error:
        raise NetworkError(f"{path}: not XML: {error}") from error


def _sorted_by_kind(path: Path, root: Element) -> RawNet:
    leaving: dict[str, list[Attributes]] = defaultdict(list)
    arriving: dict[str, list[Attributes]] = defaultdict(list)
    joining: dict[tuple[str, str], list[str]] = defaultdict(list)
    for connection in root.iterfind("connection"):
        attributes = connection.attrib
        leaving[from_lane_id(attributes)].append(attributes)
        if not attributes["from"].startswith(":"):
            arriving[to_lane_id(attributes)].append(attributes)
    edges = {edge.attrib["id"]: edge for edge in root.iterfind("edge")}
    for edge_id, edge in edges.items():
        if "from" in edge.attrib:
            joining[edge.attrib["from"], edge.attrib["to"]].append(edge_id)
    return RawNet(
        path=path,
        left_hand=root.get("lefthand", "false").lower() in ("true", "1", "yes", "on"),
        edges=edges,
        junctions={junction.attrib["id"]: junction for junction in root.iterfind("junction")},
        leaving=dict(leaving),
        arriving=dict(arriving),
        joining=dict(joining),
    )


def _require_internal_lanes(raw: RawNet) -> None:
    if not raw.arriving or any(edge.get("function") == "internal" for edge in raw.edges.values()):
        return
    raise NetworkError(f"{raw.path}: no internal lanes; rebuild the network without netconvert's --no-internal-links")
