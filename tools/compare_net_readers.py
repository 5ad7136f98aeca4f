#!/usr/bin/env python3
"""Hold this project's reader of networks against SUMO's own Python library, sumolib, and time both.

    python tools/compare_net_readers.py [NETWORK…] [--times]

NETWORK is a `.net.xml`, a `.net.xml.gz`, or a folder that is searched for them; without one these are the networks of this
repository. Compared are all edges and lanes (index, length, width, speed, shape, permissions), every junction's
connections in their order (lanes, way inside, direction, light) and its right of way. A line is printed for each difference
and for each network. `--times` adds processor times: of sumolib with internal lanes and programs, of this
reader, and of this reader with the world around a route, as a run builds it.
Exit codes: 0 alike, 1 a difference, 2 wrong input.
"""

from __future__ import annotations

import argparse
import sys
import time as clock
from collections.abc import Callable, Iterator, Mapping
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import sumolib

from sumo_reactive.driver.world.junction import Connection, Junction, Turn
from sumo_reactive.driver.world.lane import VEHICLE_CLASSES, Lane
from sumo_reactive.errors import NetworkError
from sumo_reactive.sumo.net_file import MIN_PATH_LENGTH_M, RawNet, parse
from sumo_reactive.sumo.net_reader import read_net

ROOT = Path(__file__).resolve().parent.parent
USAGE_ERROR = 2
ROUTE_EDGES = 20
TURNS = {Turn.STRAIGHT: "s", Turn.LEFT: "lL", Turn.RIGHT: "rR", Turn.AROUND: "tT"}
_SAME_POINT_M = 1e-6


def main() -> None:
    """Compare, print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("networks", nargs="*", type=Path, metavar="NETWORK", help="file or folder; else this repository's")
    parser.add_argument("--times", action="store_true", help="print processor times, too")
    asked = parser.parse_args()
    files = [file for place in asked.networks or [ROOT / "networks"] for file in networks_in(place)]
    if not files:
        print("compare_net_readers: no network found", file=sys.stderr)
        raise SystemExit(USAGE_ERROR)
    count = 0
    for file in files:
        try:
            found = list(differences(file))
        except NetworkError as error:
            print(f"compare_net_readers: {error}", file=sys.stderr)
            raise SystemExit(USAGE_ERROR) from error
        count += len(found)
        told = [*found, f"{file}: {len(found)} differences{times(file) if asked.times else ''}"]
        print("\n".join(told), flush=True)
    raise SystemExit(int(count > 0))


def networks_in(place: Path) -> list[Path]:
    """Return the network files at a place: itself, or all in a folder."""
    return sorted(place.rglob("*.net.xml*")) if place.is_dir() else [place]


def times(file: Path) -> str:
    """Return the processor times of both readers in words, s, each the best of three."""
    raw = parse(file)
    route = _a_route(raw)
    theirs = _best(lambda: sumolib.net.readNet(str(file), withInternal=True, withPrograms=True))
    parsed, built = _best(lambda: read_net(file)), _best(lambda: read_net(file).build(route))
    return (
        f"; sumolib {theirs:.4f} s, this reader {parsed:.4f} s ({theirs / parsed:.1f} times faster), "
        f"with the world around {len(route)} edges {built:.4f} s ({theirs / built:.1f} times)"
    )


def _best(call: Callable[[], object]) -> float:
    spent = []
    for _ in range(3):
        began = clock.process_time()
        call()
        spent.append(clock.process_time() - began)
    return min(spent)


def _a_route(raw: RawNet) -> list[str]:
    """Return the longest of the routes of up to ROUTE_EDGES edges that take the first connection each time."""
    onward: dict[str, str] = {}
    for connections in raw.leaving.values():
        for connection in connections:
            if not connection["from"].startswith(":"):
                onward.setdefault(connection["from"], connection["to"])
    return max((_followed(edge, onward) for edge in onward), key=len)


def _followed(edge: str, onward: Mapping[str, str]) -> list[str]:
    route = [edge]
    while len(route) < ROUTE_EDGES and (then := onward.get(route[-1])) and then not in route:
        route.append(then)
    return route


def differences(file: Path) -> Iterator[str]:
    """Yield a line for each thing that the two readers tell differently of a network."""
    net, raw = read_net(file), parse(file)
    other = sumolib.net.readNet(str(file), withInternal=True, withPedestrianConnections=True, withMacroConnectors=True)
    edges = {edge.getID(): edge for edge in other.getEdges()}
    if apart := edges.keys() ^ raw.edges.keys():
        yield f"{file}: edges known to one reader: {' '.join(sorted(apart)[:5])}"
    for edge_id in edges.keys() & raw.edges.keys():
        theirs = [lane.getID() for lane in edges[edge_id].getLanes()]
        if theirs != raw.lane_ids(edge_id):
            yield f"{file}: edge '{edge_id}': lanes {raw.lane_ids(edge_id)}, in sumolib {theirs}"
        for lane in edges[edge_id].getLanes():
            yield from _told(file, f"lane '{lane.getID()}'", _of_our_lane(net.lane(lane.getID())), _of_lane(lane))
    for node in other.getNodes():
        junction = net.junction(node.getID())
        links = _links(node)
        place = f"junction '{node.getID()}'"
        ours = {"connections": [_of_our_connection(connection) for connection in junction.connections]}
        yield from _told(file, place, ours, {"connections": [_of_link(link) for link in links]})
        if len(links) == len(junction.connections):
            yield from _told(file, place, _our_rules(junction), _rules(node, links))


def _told(file: Path, place: str, ours: dict[str, Any], theirs: dict[str, Any]) -> Iterator[str]:
    for key, value in ours.items():
        if value != theirs[key]:
            yield f"{file}: {place}: {key} {_brief(value, theirs[key])}, in sumolib {_brief(theirs[key], value)}"


def _brief(value: object, other: object) -> object:
    """Return what of a list is not in another list, or the value."""
    if isinstance(value, list) and isinstance(other, list):
        return [one for one in value if one not in other][:3]
    return sorted(value - other)[:5] if isinstance(value, frozenset) and isinstance(other, frozenset) else value


def _of_our_lane(lane: Lane) -> dict[str, Any]:
    return {
        "index": lane.index,
        "length": lane.length,
        "width": lane.width,
        "speed": lane.speed_limit,
        "shape": [tuple(map(float, point)) for point in lane.spine.points],
        "permissions": lane.allowed,
    }


def _of_lane(lane: Any) -> dict[str, Any]:
    points = [tuple(point) for point in lane.getShape()]
    kept = points[:1]
    for point in points[1:]:
        if np.hypot(point[0] - kept[-1][0], point[1] - kept[-1][1]) > _SAME_POINT_M:
            kept.append(point)
    if len(kept) == 1:  # a lane without extent: a stub here
        kept.append((kept[0][0] + MIN_PATH_LENGTH_M, kept[0][1]))
    return {
        "index": lane.getIndex(),
        "length": max(lane.getLength(), MIN_PATH_LENGTH_M),
        "width": lane.getWidth(),
        "speed": lane.getSpeed(),
        "shape": kept,
        "permissions": VEHICLE_CLASSES.intersection(lane.getPermissions()),
    }


def _links(node: Any) -> list[Any]:
    """Return sumolib's connections of a node in the order of their index."""
    leaving = [link for edge in node.getIncoming() for lane in edge.getLanes() for link in lane.getOutgoing()]
    links = {node.getLinkIndex(link): link for link in leaving}
    return [links[index] for index in sorted(links) if index >= 0]


def _of_our_connection(connection: Connection) -> tuple[object, ...]:
    light = (connection.light.light_id, connection.light.index) if connection.light else None
    if connection.is_crossing:
        return connection.id, light
    return connection.id, connection.parts[0] if connection.parts else "", TURNS[connection.turn], light


def _of_link(link: Any) -> tuple[object, ...]:
    light = (link.getTLSID(), link.getTLLinkIndex()) if link.getTLSID() and link.getTLLinkIndex() >= 0 else None
    ends = link.getFromLane().getID(), link.getToLane().getID()
    if ends[0].startswith(":"):
        return ends[1], light
    turn = next((letters for letters in TURNS.values() if link.getDirection() in letters), TURNS[Turn.STRAIGHT])
    return "->".join(ends), link.getViaLaneID(), turn, light


def _our_rules(junction: Junction) -> dict[str, Any]:
    pairs = list(product(range(len(junction.connections)), repeat=2))
    rules = junction.right_of_way
    return {
        "paths that meet": [pair for pair in pairs if rules.in_conflict(*pair)],
        "who yields to whom": [pair for pair in pairs if rules.must_yield(*pair)],
    }


def _rules(node: Any, links: list[Any]) -> dict[str, Any]:
    pairs = list(product(range(len(links)), repeat=2)) if node.hasFoes() else []
    return {
        "paths that meet": [(i, j) for i, j in pairs if node.areFoes(i, j)],
        "who yields to whom": [(i, j) for i, j in pairs if node.forbids(links[j], links[i])],
    }


if __name__ == "__main__":
    main()
