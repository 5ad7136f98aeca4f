"""Junctions from a parsed network: the order of their connections and who yields to whom."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from xml.etree.ElementTree import Element

import numpy as np
from numpy.typing import NDArray

from sumo_reactive.driver.geometry.polyline import Points, cut, joined
from sumo_reactive.driver.parameters import HOLD_BACK_REACH_M
from sumo_reactive.driver.world.junction import Connection, Junction
from sumo_reactive.driver.world.regions import hold_back, inside_part
from sumo_reactive.driver.world.right_of_way import RightOfWay
from sumo_reactive.errors import NetworkError
from sumo_reactive.sumo.net_connections import LaneOf, connection_from
from sumo_reactive.sumo.net_file import Attributes, RawNet
from sumo_reactive.sumo.net_lanes import coordinates


def junction_from(raw: RawNet, junction_id: str, lane_of: LaneOf) -> Junction:
    """Build one junction with all its connections; raise NetworkError naming it if it is missing or malformed."""
    element = raw.junctions.get(junction_id)
    if element is None:
        raise NetworkError(f"{raw.path}: unknown junction '{junction_id}'")
    links = list(links_of(raw, element))
    connections = tuple(connection_from(raw, link, junction_id, i, lane_of) for i, link in enumerate(links))
    try:
        right_of_way = _right_of_way(element.findall("request"), connections)
        outline = _outline(element)
    except KeyError as error:
        raise NetworkError(f"{raw.path}: junction '{junction_id}' lacks attribute {error}") from error
    except ValueError as error:
        raise NetworkError(f"{raw.path}: junction '{junction_id}': {error}") from error
    connections = tuple(_with_tail(connection, outline, lane_of) for connection in connections)
    connections = _held_back(connections, lane_of)
    return Junction(junction_id, element.get("type", "unknown"), outline, connections, right_of_way)


def _with_tail(connection: Connection, outline: Points, lane_of: LaneOf) -> Connection:
    if connection.is_crossing:
        return connection
    tail = inside_part(lane_of(connection.to_lane).spine, outline)
    return connection if tail is None else replace(connection, tail=tail)


def _held_back(connections: tuple[Connection, ...], lane_of: LaneOf) -> tuple[Connection, ...]:
    """Return the connections with the room that their approach lanes must leave to traffic from other roads, and with
    the exits that reach over such a lane."""
    cars = [connection for connection in connections if not connection.is_crossing]
    room: dict[str, float] = {}
    over: set[str] = set()
    for connection in cars:
        if connection.from_lane not in room:
            lane = lane_of(connection.from_lane)
            others = [c for c in cars if lane_of(c.from_lane).edge_id != lane.edge_id]
            room[lane.id], reaching = hold_back(lane.spine, [_with_exit(c, lane_of) for c in others])
            over.update(others[i].id for i in reaching)
    return tuple(_around(c, room.get(c.from_lane, 0.0), lane_of, over=c.id in over) for c in connections)


def _around(connection: Connection, room: float, lane_of: LaneOf, *, over: bool) -> Connection:
    """Return a connection with the parts of its approach and exit lanes that lie in others' way."""
    if room > 0.0:
        lane = lane_of(connection.from_lane).spine
        connection = replace(connection, hold_back=room, head=cut(lane, lane.length - room, lane.length))
    return replace(connection, tail=_exit(connection, lane_of)) if over else connection


def _with_exit(connection: Connection, lane_of: LaneOf) -> Points:
    """Return a connection's path and the start of the lane behind it."""
    return joined([connection.path.points, _exit(connection, lane_of)])


def _exit(connection: Connection, lane_of: LaneOf) -> Points:
    spine = lane_of(connection.to_lane).spine
    return cut(spine, 0.0, min(spine.length, HOLD_BACK_REACH_M))


def links_of(raw: RawNet, junction: Element) -> Iterator[Attributes]:
    """Yield the `<connection>` attributes in the order of the junction's `<request>` rows.

    The order runs over the incoming lanes and, for each, over its connections as the file lists them. Ways on and off a
    walking area have no row, except those that lead on to a pedestrian crossing.
    """
    for lane_id in junction.get("incLanes", "").split():
        for connection in raw.leaving.get(lane_id, ()):
            target = raw.function(connection["to"])
            from_walk = lane_id.startswith(":") and raw.function(connection["from"]) == "walkingarea"
            if target != "walkingarea" and (not from_walk or target == "crossing"):
                yield connection


def _right_of_way(requests: Sequence[Element], connections: Sequence[Connection]) -> RightOfWay:
    """Read the rows `response` and `foes`; connections without a row neither yield nor conflict."""
    size = len(connections)
    yields, conflicts = np.zeros((size, size), dtype=bool), np.zeros((size, size), dtype=bool)
    for request in requests:
        row = int(request.attrib["index"])
        if 0 <= row < size:
            _read_bits(request.attrib["response"], yields[row])
            _read_bits(request.attrib["foes"], conflicts[row])
    return RightOfWay(yields, conflicts)


def _read_bits(bits: str, row: NDArray[np.bool_]) -> None:
    """Fill a table row from a bit string, whose last letter stands for connection 0."""
    for i, bit in enumerate(reversed(bits[-len(row) :])):
        row[i] = bit == "1"


def _outline(junction: Element) -> Points:
    """Return the junction's shape, (n, 2), m; its centre if it has none."""
    shape = junction.get("shape") or f"{junction.attrib['x']},{junction.attrib['y']}"
    return np.array([point[:2] for point in coordinates(shape)])
