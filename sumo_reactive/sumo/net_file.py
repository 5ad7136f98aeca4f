"""A SUMO network file as parsed: its elements by id, and its lanes' shapes, permissions and lengths."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from xml.etree.ElementTree import Element, ParseError, fromstring

import numpy as np
from numpy.typing import NDArray

from sumo_reactive.driver.geometry.polyline import Points, Polyline
from sumo_reactive.driver.world.lane import VEHICLE_CLASSES, Lane
from sumo_reactive.errors import NetworkError
from sumo_reactive.files import content_of

MIN_PATH_LENGTH_M = 0.1
"""Shortest spine or path; networks hold shapes of two equal points."""

Attributes = Mapping[str, str]

DEFAULT_LANE_WIDTH_M = 3.2
"""SUMO's width of a lane that states none."""

_SMALLEST_STEP_M = 1e-6  # closer points are one


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

    def lane(self, lane_id: str) -> tuple[int, Attributes]:
        """Return index and attributes of a lane; raise NetworkError if the network has none of that id."""
        for k, lane in enumerate(self.edge(edge_id_of(lane_id)).iterfind("lane")):
            if lane.get("id") == lane_id:
                return k, lane.attrib
        raise NetworkError(f"{self.path}: unknown lane '{lane_id}'")

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
    try:
        root = fromstring(content_of(path, NetworkError))
    except (ParseError, ValueError, LookupError) as error:
        raise NetworkError(f"{path}: not XML: {error}") from error
    if root.tag != "net":
        raise NetworkError(f"{path}: not a SUMO network: root element is <{root.tag}>, not <net>")
    try:
        raw = _sorted_by_kind(path, root)
    except KeyError as error:
        raise NetworkError(f"{path}: an <edge>, <junction> or <connection> lacks attribute {error}") from error
    if not raw.edges:
        raise NetworkError(f"{path}: the network has no edges")
    if raw.arriving and not any(edge.get("function") == "internal" for edge in raw.edges.values()):
        raise NetworkError(f"{path}: no internal lanes; rebuild the network without netconvert's --no-internal-links")
    return raw


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


def lane_from(raw: RawNet, lane_id: str) -> Lane:
    """Build one lane; raise NetworkError naming it if it is missing or malformed.

    Its index is its place: what netconvert has written as the index is wrong inside some junctions.
    """
    (index, lane), edge_id = raw.lane(lane_id), edge_id_of(lane_id)
    with malformed(f"{raw.path}: lane '{lane_id}'"):
        return Lane(
            id=lane_id,
            edge_id=edge_id,
            index=index,
            spine=Polyline(lengthened(_distinct(coordinates(lane["shape"])))),
            length=max(float(lane["length"]), MIN_PATH_LENGTH_M),
            width=float(lane.get("width", DEFAULT_LANE_WIDTH_M)),
            speed_limit=float(lane["speed"]),
            allowed=permitted(lane.get("allow") or None, lane.get("disallow")),
            is_internal=edge_id.startswith(":"),
            change_left=permitted(lane.get("changeLeft")),  # the driver's left in left-hand traffic too
            change_right=permitted(lane.get("changeRight")),
        )


@contextmanager
def malformed(place: str) -> Iterator[None]:
    """Turn what an element lacks, or says wrongly, into a NetworkError."""
    try:
        yield
    except KeyError as error:
        raise NetworkError(f"{place} lacks attribute {error}") from error
    except ValueError as error:
        raise NetworkError(f"{place}: {error}") from error


def permitted(allow: str | None, disallow: str | None = None) -> frozenset[str]:
    """Return the vehicle classes that the two attributes permit; `allow` wins over `disallow`."""
    if allow is not None:
        return _classes(allow)
    return VEHICLE_CLASSES - _classes(disallow) if disallow else VEHICLE_CLASSES


def _classes(words: str) -> frozenset[str]:
    return VEHICLE_CLASSES if words == "all" else VEHICLE_CLASSES.intersection(words.replace(",", " ").split())


def coordinates(shape: str) -> list[tuple[float, ...]]:
    """Return the points of a `shape` attribute, each (x, y) or (x, y, z), m; raise ValueError if there is none."""
    points = [tuple(map(float, point.split(","))) for point in shape.split()]
    if not points or any(len(point) not in (2, 3) or not all(map(math.isfinite, point)) for point in points):
        raise ValueError(f"shape '{shape[:40]}' is not a list of x,y or x,y,z")
    return points


def heights_of(shape: str) -> NDArray[np.float64] | None:
    """Return the elevation of the points that make the spine, shape (n,), m; None in a flat network."""
    points = _distinct(coordinates(shape))
    if any(len(point) < 3 for point in points):
        return None
    return np.array([point[2] for point in points] + ([points[0][2]] if len(points) == 1 else []))


def _distinct(points: Sequence[tuple[float, ...]]) -> list[tuple[float, ...]]:
    """Drop each point that repeats the one before it."""
    kept = [points[0]]
    for point in points[1:]:
        if math.dist(point[:2], kept[-1][:2]) > _SMALLEST_STEP_M:
            kept.append(point)
    return kept


def lengthened(points: Sequence[tuple[float, ...]], heading: float = 0.0) -> Points:
    """Return points of shape (n ≥ 2, 2); a single point becomes a stub of the shortest length towards `heading` (rad)."""
    if len(points) == 1:
        x, y = points[0][:2]
        end = (x + MIN_PATH_LENGTH_M * math.cos(heading), y + MIN_PATH_LENGTH_M * math.sin(heading))
        return np.array([(x, y), end])
    return np.array([point[:2] for point in points])
