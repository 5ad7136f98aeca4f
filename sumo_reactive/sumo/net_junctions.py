"""Junctions from a parsed network: their connections (paths, waiting places, lights) in order, and who yields to whom."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from xml.etree.ElementTree import Element

import numpy as np
from numpy.typing import NDArray

from sumo_reactive.driver.geometry.polyline import Points, Polyline, cut, joined
from sumo_reactive.driver.world.junction import HOLD_BACK_REACH_M, Connection, Control, Junction, LightLink, Turn
from sumo_reactive.driver.world.lane import Lane
from sumo_reactive.driver.world.regions import hold_back, inside_part
from sumo_reactive.driver.world.right_of_way import RightOfWay
from sumo_reactive.errors import NetworkError
from sumo_reactive.sumo.net_file import (
    MIN_PATH_LENGTH_M,
    Attributes,
    RawNet,
    coordinates,
    from_lane_id,
    heights_of,
    lengthened,
    malformed,
    to_lane_id,
)

LaneOf = Callable[[str], Lane]

LAP_STEP_M, LAP_REACH_M = 0.25, 15.0
"""A turn is looked for beside its own lane in such steps, and so far before the end."""

_TURNS = {"l": Turn.LEFT, "r": Turn.RIGHT, "t": Turn.AROUND}
_CONTROLS = {
    "M": Control.MAJOR, "m": Control.MINOR, "=": Control.EQUAL, "s": Control.STOP, "w": Control.ALL_WAY_STOP,
    "Z": Control.ZIPPER, "-": Control.DEAD_END,
}  # fmt: skip


def connection_id(connection: Attributes) -> str:
    """Return the id of a connection: `from_lane->to_lane`, or the crossing's lane if it is a pedestrian crossing."""
    from_lane, to_lane = from_lane_id(connection), to_lane_id(connection)
    return to_lane if from_lane.startswith(":") else f"{from_lane}->{to_lane}"


def parts_of(raw: RawNet, connection: Attributes) -> tuple[str, ...]:
    """Return the internal lanes of a connection in driving order; a turn that may wait inside has several."""
    target = (connection["to"], connection["toLane"])
    parts: list[str] = []
    via = connection.get("via")
    while via and via not in parts:
        parts.append(via)
        onward = (step for step in raw.leaving.get(via, ()) if (step["to"], step["toLane"]) == target)
        via = next((step["via"] for step in onward if "via" in step), None)
    return tuple(parts)


def connection_from(raw: RawNet, attributes: Attributes, junction_id: str, index: int, lane_of: LaneOf) -> Connection:
    """Build one connection of a junction; raise NetworkError naming it if it is malformed."""
    with malformed(f"{raw.path}: connection '{connection_id(attributes)}'"):
        return _connection(raw, attributes, junction_id, index, lane_of)


def _connection(raw: RawNet, attributes: Attributes, junction_id: str, index: int, lane_of: LaneOf) -> Connection:
    is_crossing = raw.function(attributes["to"]) == "crossing"
    parts = (to_lane_id(attributes),) if is_crossing else parts_of(raw, attributes)
    lanes = [lane_of(part) for part in parts]
    from_lane = lane_of(from_lane_id(attributes))
    to_lane = lane_of(_behind_crossing(raw, parts[0]) if is_crossing else to_lane_id(attributes))
    path = Polyline(_path(lanes, from_lane, to_lane))
    light = _light(attributes)
    bounds = lanes or [from_lane, to_lane]
    return Connection(
        id=connection_id(attributes),
        junction_id=junction_id,
        index=index,
        from_lane=from_lane.id,
        to_lane=to_lane.id,
        parts=parts,
        path=path,
        turn=_TURNS.get(attributes.get("dir", "s").lower(), Turn.STRAIGHT),
        control=Control.LIGHT if light else _CONTROLS.get(attributes["state"], Control.OFF),
        light=light,
        wait_at=_wait_at(attributes, lanes, path.length),
        keep_clear=attributes.get("keepClear", "true").lower() not in ("0", "false"),
        is_crossing=is_crossing,
        width=min(lane.width for lane in bounds),
        speed_limit=min(lane.speed_limit for lane in bounds),
        approach_limit=from_lane.speed_limit,
        heights=_heights(raw, lanes, path),
    )


def _behind_crossing(raw: RawNet, crossing: str) -> str:
    """Return the walking area on the far side; the crossing itself if the network does not say."""
    return next((to_lane_id(step) for step in raw.leaving.get(crossing, ())), crossing)


def _path(parts: Sequence[Lane], from_lane: Lane, to_lane: Lane) -> Points:
    """Join the parts' spines, or the lanes' ends straight where there is none; at least the shortest length long."""
    ends = np.stack([from_lane.spine.points[-1], to_lane.spine.points[0]])
    points = joined([part.spine.points for part in parts]) if parts else ends
    if np.hypot(*np.diff(points, axis=0).T).sum() >= MIN_PATH_LENGTH_M:
        return points
    return lengthened([tuple(points[0])], from_lane.spine.heading_at(from_lane.spine.length))


def _light(attributes: Attributes) -> LightLink | None:
    """Return the signal; a link index of -1 (the rails of a rail crossing) means none."""
    if "tl" not in attributes or int(attributes.get("linkIndex", "-1")) < 0:
        return None
    return LightLink(attributes["tl"], int(attributes["linkIndex"]))


def _wait_at(attributes: Attributes, parts: Sequence[Lane], length: float) -> float | None:
    """Return the arc length (m) of the waiting place: the stated one, or the end of the last part but one."""
    stated = float(attributes.get("contPos", "-1"))
    if 0.0 < stated < length:
        return stated
    return min(sum(part.spine.length for part in parts[:-1]), length) if len(parts) > 1 else None


def _heights(raw: RawNet, parts: Sequence[Lane], path: Polyline) -> NDArray[np.float64] | None:
    """Return the elevation of the path's points, shape (n,), m; None in a flat network."""
    known, at, offset = [], [], 0.0
    for part in parts:
        heights = heights_of(raw.lane(part.id)[1]["shape"])
        if heights is None:
            return None
        known.append(heights)
        at.append(offset + part.spine.arc_lengths)
        offset += part.spine.length
    return np.interp(path.arc_lengths, np.concatenate(at), np.concatenate(known)) if known else None


def junction_from(raw: RawNet, junction_id: str, lane_of: LaneOf) -> Junction:
    """Build one junction with all its connections; raise NetworkError naming it if it is missing or malformed."""
    element = raw.junctions.get(junction_id)
    if element is None:
        raise NetworkError(f"{raw.path}: unknown junction '{junction_id}'")
    links = list(links_of(raw, element))
    connections = tuple(connection_from(raw, link, junction_id, i, lane_of) for i, link in enumerate(links))
    with malformed(f"{raw.path}: junction '{junction_id}'"):
        right_of_way = _right_of_way(element.findall("request"), connections)
        shape = element.get("shape") or f"{element.attrib['x']},{element.attrib['y']}"
        outline = np.array([point[:2] for point in coordinates(shape)])
    connections = tuple(_with_tail(connection, outline, lane_of) for connection in connections)
    connections = _held_back(connections, lane_of)
    return Junction(
        id=junction_id, kind=element.get("type", "unknown"), outline=outline, connections=connections,
        right_of_way=right_of_way,
    )  # fmt: skip


def _with_tail(connection: Connection, outline: Points, lane_of: LaneOf) -> Connection:
    if connection.is_crossing:
        return connection
    tail = inside_part(lane_of(connection.to_lane).spine, outline)
    return connection if tail is None else replace(connection, tail=tail)


def _held_back(connections: tuple[Connection, ...], lane_of: LaneOf) -> tuple[Connection, ...]:
    """Return the connections with the room that their approach lanes must leave to traffic from other lanes, some of it
    from beside them, and with the exits that reach over such a lane."""
    cars = [connection for connection in connections if not connection.is_crossing]
    room: dict[str, float] = {}
    over: set[str] = set()
    for connection in cars:
        if connection.from_lane not in room:
            lane = lane_of(connection.from_lane)
            others = [c for c in cars if c.from_lane != lane.id]
            paths = [joined([c.path.points, _exit(c, lane_of)]) for c in others]
            room[lane.id], reaching = hold_back(lane.spine, paths)
            over.update(others[i].id for i in reaching)
    rooms = {c.id: max(room[c.from_lane], _lap(c, lane_of(c.from_lane))) for c in cars}
    return tuple(_around(c, rooms.get(c.id, 0.0), lane_of, over=c.id in over) for c in connections)


def _lap(connection: Connection, lane: Lane) -> float:
    """Return how far before the end of its lane SUMO has who turns there inside the junction, m.

    It has him on the last way of his route that passes within half its width of his front. Sharp turns lead back past the
    end of their lane, and some maps let the road behind begin before it.
    """
    spine, path = lane.spine, connection.path
    back = np.arange(LAP_STEP_M, min(spine.length, LAP_REACH_M), LAP_STEP_M)
    places = spine.points_at(spine.length - back)
    along, aside = path.arc_lengths_at(places), path.offsets(places)
    is_inside = (along > 0.0) & (along < path.length) & (np.abs(aside) < 0.5 * lane.width)
    return float(back[is_inside].max(initial=0.0))


def _around(connection: Connection, room: float, lane_of: LaneOf, *, over: bool) -> Connection:
    """Return a connection with the parts of its approach and exit lanes that lie in others' way."""
    if room > 0.0:
        lane = lane_of(connection.from_lane).spine
        connection = replace(connection, hold_back=room, head=cut(lane, lane.length - room, lane.length))
    return replace(connection, tail=_exit(connection, lane_of)) if over else connection


def _exit(connection: Connection, lane_of: LaneOf) -> Points:
    """Return the start of the lane behind a connection."""
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
    """Read the rows `response` and `foes`, whose last letter stands for connection 0; connections without a row neither
    yield nor conflict."""
    size = len(connections)
    tables = {name: np.zeros((size, size), dtype=bool) for name in ("response", "foes")}
    for request in requests:
        row = int(request.attrib["index"])
        for name, table in tables.items():
            if 0 <= row < size:
                bits = request.attrib[name][-size:]
                table[row, : len(bits)] = [bit == "1" for bit in reversed(bits)]
    return RightOfWay(tables["response"], tables["foes"])
