"""What SUMO counts on edges: time and speed on each by interval (`edgeData`), who passes the middle of a lane (loops).

Both count the vehicles of the scenario's own types alone: stand-ins have types of theirs. What `edgeData` says of vehicles
that enter and leave is not used, since it has an ego that is moved to the lane beside enter its edge again.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple
from xml.etree.ElementTree import Element, ElementTree, SubElement
from xml.sax.saxutils import unescape

from sumo_reactive.errors import ScenarioError
from sumo_reactive.files import content_of
from sumo_reactive.sumo.config import SumoConfig, given_options, paths_beside
from sumo_reactive.sumo.input_files import inputs_of, words_of
from sumo_reactive.sumo.launch import runnable_config
from sumo_reactive.sumo.net_file import RawNet, malformed, permitted
from sumo_reactive.sumo.outputs import elements_of
from sumo_reactive.sumo.vehicle_type import NOT_ROAD_CARS

_ADDITIONAL = "additional-files"
_EDGES, _LOOP = "reactive.edges", "reactive.cut."
_MOST_LETTERS = 100
"""A class of road is told by so many letters of its name."""

_TYPE = re.compile(rb"<vType\s[^>]*?\bid\s*=\s*(?:\"([^\"]*)\"|'([^']*)')")
_BUILT_IN = tuple(f"DEFAULT_{kind}TYPE" for kind in ("VEH", "TAXI", "BIKE", "RAIL", "CONTAINER", "PED"))
"""Types that SUMO has without a file."""

_QUOTES = {"&quot;": '"', "&apos;": "'"}


class Road(NamedTuple):
    """A normal edge: its class (the network's `type`, else its `priority` in words), and the lanes that cars of some class
    may use, each with its length (m)."""

    edge_id: str
    road_class: str
    lanes: Mapping[str, float]


class EdgeTime(NamedTuple):
    """What all vehicles did on an edge from `begin` to `end` (s): vehicle-seconds on it, and their mean speed (m/s).

    SUMO counts a vehicle as long as a part of its body is on the edge.
    """

    begin: float
    end: float
    edge_id: str
    time: float
    speed: float


def edges_for_cars(net: RawNet) -> dict[str, Road]:
    """Return the normal edges of a network that cars may use, by id."""
    roads: dict[str, Road] = {}
    for edge_id, edge in net.edges.items():
        lanes = _lanes(net, edge) if edge.get("function", "normal") == "normal" else {}
        if lanes:
            road_class = edge.get("type") or f"priority {edge.get('priority', '-1')}"
            roads[edge_id] = Road(edge_id, road_class[:_MOST_LETTERS], lanes)
    return roads


def _lanes(net: RawNet, edge: Element) -> dict[str, float]:
    with malformed(f"{net.path}: a lane of edge '{edge.get('id')}'"):
        return {
            lane.attrib["id"]: float(lane.attrib["length"])
            for lane in edge.iterfind("lane")
            if permitted(lane.get("allow") or None, lane.get("disallow")) - NOT_ROAD_CARS
        }


class EdgeCounts(NamedTuple):
    """What is to be counted into which files of `folder`: edges every `interval` s, loops on `lanes` (length by id, m)."""

    folder: Path
    interval: float
    lanes: Mapping[str, float]

    @property
    def times(self) -> Path:
        """The file with the edges."""
        return self.folder / "edges.xml"

    @property
    def passages(self) -> Path:
        """The file with the loops."""
        return self.folder / "loops.xml"

    def options(self, config: SumoConfig, sumo_options: Sequence[str]) -> dict[str, str]:
        """Write the additional file that asks SUMO for it; return the option that names it behind the scenario's own.

        `sumo_options` may name others in place of the configuration's. Raises ScenarioError for what SUMO could not read.
        """
        ours, given = self.folder / "counts.add.xml", given_options(sumo_options)
        types = " ".join(vehicle_types(config, sumo_options))
        root, common = Element("additional"), {"period": f"{self.interval:.3f}", "vTypes": types}
        SubElement(root, "edgeData", common | {"id": _EDGES, "file": str(self.times), "excludeEmpty": "true"})
        for lane, length in self.lanes.items():
            place = {"id": f"{_LOOP}{lane}", "lane": lane, "pos": f"{0.5 * length:.2f}"}
            SubElement(root, "inductionLoop", common | place | {"file": str(self.passages)})
        ElementTree(root).write(ours, encoding="utf-8", xml_declaration=True)
        theirs = given[_ADDITIONAL].split(",") if _ADDITIONAL in given else _own_files(config)
        return {_ADDITIONAL: ",".join((*theirs, str(ours)))}


def _own_files(config: SumoConfig) -> list[str]:
    """Return the additional files of a configuration that a run takes, found from anywhere."""
    runnable, _ = runnable_config(config)
    if isinstance(runnable, Path):
        return list(map(str, config.additional_files))
    return list(map(str, paths_beside(config.path, runnable.get(_ADDITIONAL, ""))))


def vehicle_types(config: SumoConfig, sumo_options: Sequence[str] = ()) -> list[str]:
    """Return the ids of all types that vehicles of a scenario may have: SUMO's own, and those in any file that it reads."""
    try:
        files = inputs_of(config.path, words_of(sumo_options)).files
    except OSError as error:
        raise ScenarioError(f"{error.filename or config.path}: cannot be read: {error.strerror}") from error
    net = config.net_file.resolve()
    contents = (content_of(file) for file in files if file.resolve() != net)
    found = (one or other for content in contents for one, other in _TYPE.findall(content))
    return list(dict.fromkeys((*_BUILT_IN, *(unescape(name.decode("utf-8", "replace"), _QUOTES) for name in found))))


def read_edge_times(path: Path) -> Iterator[EdgeTime]:
    """Yield the edges with anybody on them, interval by interval."""
    for interval in elements_of(path, "interval", ("begin", "end"), edge=("id", "sampledSeconds", "speed")):
        begin, end = float(interval.begin), float(interval.end)
        for edge in interval.edge or ():
            yield EdgeTime(begin, end, edge.id, float(edge.sampledSeconds or 0.0), float(edge.speed or 0.0))


def read_passages(path: Path) -> dict[str, int]:
    """Return how many vehicles have wholly passed the middle of each lane."""
    passed: dict[str, int] = {}
    for loop in elements_of(path, "interval", ("id", "nVehContrib")):
        lane = loop.id.removeprefix(_LOOP)
        passed[lane] = passed.get(lane, 0) + int(loop.nVehContrib or 0)
    return passed
