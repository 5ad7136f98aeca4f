"""Connections from a parsed network: paths through a junction, waiting places, lights."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from sumo_reactive.driver.geometry.polyline import Points, Polyline, joined
from sumo_reactive.driver.parameters import MIN_PATH_LENGTH_M
from sumo_reactive.driver.world.junction import Connection, Control, LightLink, Turn
from sumo_reactive.driver.world.lane import Lane
from sumo_reactive.errors import NetworkError
from sumo_reactive.sumo.net_file import Attributes, RawNet, edge_id_of, from_lane_id, to_lane_id
from sumo_reactive.sumo.net_lanes import heights_of, lengthened

LaneOf = Callable[[str], Lane]

_TURNS = {
    "s": Turn.STRAIGHT,
    "l": Turn.LEFT,
    "L": Turn.LEFT,
    "r": Turn.RIGHT,
    "R": Turn.RIGHT,
    "t": Turn.AROUND,
    "T": Turn.AROUND,
}
_CONTROLS = {
    "M": Control.MAJOR,
    "m": Control.MINOR,
    "=": Control.EQUAL,
    "s": Control.STOP,
    "w": Control.ALL_WAY_STOP,
    "Z": Control.ZIPPER,
    "-": Control.DEAD_END,
}


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
    try:
        return _built(raw, attributes, junction_id, index, lane_of)
    except KeyError as error:
        raise NetworkError(f"{raw.path}: connection '{connection_id(attributes)}' lacks attribute {error}") from error
    except ValueError as error:
        raise NetworkError(f"{raw.path}: connection '{connection_id(attributes)}': {error}") from error


def _built(raw: RawNet, attributes: Attributes, junction_id: str, index: int, lane_of: LaneOf) -> Connection:
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
        turn=_TURNS.get(attributes.get("dir", "s"), Turn.STRAIGHT),
        control=Control.LIGHT if light else _CONTROLS.get(attributes["state"], Control.OFF),
        light=light,
        wait_at=_wait_at(attributes, lanes, path.length),
        keep_clear=attributes.get("keepClear", "true").lower() not in ("0", "false"),
        is_crossing=is_crossing,
        width=min(lane.width for lane in bounds),
        speed_limit=min(lane.speed_limit for lane in bounds),
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
        heights = heights_of(_shape(raw, part.id))
        if heights is None:
            return None
        known.append(heights)
        at.append(offset + part.spine.arc_lengths)
        offset += part.spine.length
    return np.interp(path.arc_lengths, np.concatenate(at), np.concatenate(known)) if known else None


def _shape(raw: RawNet, lane_id: str) -> str:
    lanes = raw.edge(edge_id_of(lane_id)).iterfind("lane")
    return next(lane.attrib["shape"] for lane in lanes if lane.get("id") == lane_id)
