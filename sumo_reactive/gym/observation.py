"""What a learner sees: a few arrays of fixed shapes, each column with its unit and limits."""

from __future__ import annotations

import math
from itertools import accumulate
from typing import Any, NamedTuple

import numpy as np
from gymnasium.spaces import Box
from numpy.typing import NDArray

from sumo_reactive.driver.geometry.polyline import Points, wrapped
from sumo_reactive.driver.nouns.surroundings import LaneAround
from sumo_reactive.lab.drivers.protocol import DriverView
from sumo_reactive.lab.metric_names import EVERY

Floats32 = NDArray[np.float32]
Observation = dict[str, Floats32]


class Column(NamedTuple):
    """A number of the observation: its unit, and the limits that it is clipped to."""

    name: str
    unit: str
    low: float
    high: float


def _far(name: str) -> Column:
    return Column(name, "m", -FAR_M, FAR_M)


FAR_M, FAST_M_S = 200.0, 60.0
"""Places and speeds are clipped to these; so far is a leader, a follower or a light that is not there."""

WAY_STEP_M = 5.0
"""Between two points of the way."""

OBSERVED: dict[str, tuple[int, tuple[Column, ...]]] = {
    "ego": (1, (
        Column("speed", "m/s", 0.0, FAST_M_S), Column("acceleration", EVERY["max_acceleration_m_s2"].unit, -20.0, 20.0),
        Column("steering angle", "rad", -2.0, 2.0), Column("offset to the left of the way", "m", -20.0, 20.0),
        Column("heading relative to the way", "rad", -math.pi, math.pi), Column("speed limit", "m/s", 0.0, FAST_M_S),
        Column("way left", "m", 0.0, 1e5),
    )),
    "way": (10, (_far("ahead"), _far("to the left"))),
    "users": (8, (
        Column("is there", "0 or 1", 0.0, 1.0), _far("ahead"), _far("to the left"),
        Column("heading relative to the ego", "rad", -math.pi, math.pi), Column("speed", "m/s", 0.0, FAST_M_S),
        Column("length", "m", 0.0, 100.0), Column("width", "m", 0.0, 10.0),
    )),
    "lanes": (3, (
        Column("is there", "0 or 1", 0.0, 1.0), Column("leads on", "m", 0.0, 1e5),
        _far("gap to the leader"), Column("speed of the leader", "m/s", 0.0, FAST_M_S),
        _far("gap to the follower"), Column("speed of the follower", "m/s", 0.0, FAST_M_S),
    )),
    "light": (1, (
        Column("distance", "m", 0.0, FAR_M), Column("is red", "0 or 1", 0.0, 1.0), Column("is yellow", "0 or 1", 0.0, 1.0),
    )),
}  # fmt: skip
"""What is observed: how many rows, and the columns of each, as seen from the middle of the front bumper. Rows are points of
the way, every WAY_STEP_M; the nearest users; the lanes (own, next inner, next outer)."""


SAMPLE_M = 0.5
"""Between two points of the way as it is kept."""


def _box(rows: int, columns: tuple[Column, ...]) -> Box:
    low, high = (np.array([getattr(one, end) for one in columns], dtype=np.float32) for end in ("low", "high"))
    return Box(low, high, dtype=np.float32) if rows == 1 else Box(np.tile(low, (rows, 1)), np.tile(high, (rows, 1)))


BOXES = {name: _box(*shape) for name, shape in OBSERVED.items()}
"""The space of each array."""

_LOWS, _HIGHS = (np.concatenate([getattr(box, end).ravel() for box in BOXES.values()]) for end in ("low", "high"))
_ENDS = list(accumulate((math.prod(box.shape) for box in BOXES.values()), initial=0))
_PLACES = [*zip(BOXES, _ENDS, _ENDS[1:], strict=False)]
"""All arrays beside each other: the limits, and where each begins and ends."""


def observation_of(view: DriverView, way: Points, k: int) -> Observation:
    """Return the arrays of a view by an ego whose front is at point `k` of its way (n, 2), clipped to their limits."""
    here = way[min(k + 1, len(way) - 1)] - way[min(k, len(way) - 2)]
    heading, own = math.atan2(here[1], here[0]), view.ego
    dx, dy = (own.x, own.y) - way[k]
    offset = float(dy * math.cos(heading) - dx * math.sin(heading))
    around, left = view.surroundings, SAMPLE_M * (len(way) - 1 - k)
    ego = (own.speed, view.state.acceleration, view.state.steering_angle, offset, wrapped(own.heading - heading),
           around.own.limit if around else 0.0, left)  # fmt: skip
    light = around.light if around else None
    lanes = (around.own, around.inner, around.outer) if around else (None, None, None)
    rows: dict[str, Any] = {
        "ego": ego, "way": _way_ahead(view, way, k), "users": _users(view), "lanes": [_lane(lane) for lane in lanes],
        "light": (light.distance, light.letter in "ru", light.letter in "yY") if light else (FAR_M, 0.0, 0.0),
    }  # fmt: skip
    flat = np.concatenate([np.ravel(rows[name]) for name in BOXES])
    clipped = np.minimum(np.maximum(flat, _LOWS), _HIGHS).astype(np.float32)
    return {name: clipped[begin:end].reshape(BOXES[name].shape) for name, begin, end in _PLACES}


def _way_ahead(view: DriverView, way: Points, k: int) -> NDArray[np.float64]:
    number, step = OBSERVED["way"][0], round(WAY_STEP_M / SAMPLE_M)
    return _seen_from(view, way[np.minimum(k + step * np.arange(1, number + 1), len(way) - 1)])


def sampled(line: Points) -> Points:
    """Return a line (n, 2) with a point every SAMPLE_M."""
    arc = np.concatenate(([0.0], np.hypot(*np.diff(line, axis=0).T).cumsum()))
    at = np.arange(0.0, arc[-1], SAMPLE_M)
    return np.column_stack([np.interp(at, arc, line[:, 0]), np.interp(at, arc, line[:, 1])])


def _seen_from(view: DriverView, places: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return places (n, 2) as seen from the front bumper: ahead, to the left, m."""
    cosine, sine = math.cos(view.ego.heading), math.sin(view.ego.heading)
    turned: NDArray[np.float64] = (places - (view.ego.x, view.ego.y)) @ np.array([[cosine, -sine], [sine, cosine]])
    return turned


def _users(view: DriverView) -> NDArray[np.float64]:
    number, columns = OBSERVED["users"]
    rows, users = np.zeros((number, len(columns))), view.users
    if not users:
        return rows
    places = _seen_from(view, np.array([(user.x, user.y) for user in users]))
    nearest = np.argsort(np.einsum("ij,ij->i", places, places), kind="stable")[:number]
    found = [users[k] for k in nearest.tolist()]
    rows[: len(found)] = [
        (1.0, 0.0, 0.0, wrapped(one.heading - view.ego.heading), one.speed, one.body.length, one.body.width) for one in found
    ]
    rows[: len(found), 1:3] = places[nearest]
    return rows


def _lane(lane: LaneAround | None) -> tuple[float, ...]:
    if lane is None:
        return 0.0, 0.0, FAR_M, 0.0, FAR_M, 0.0
    ends = [(one.gap, one.speed) if one else (FAR_M, 0.0) for one in (lane.leader, lane.follower)]
    return 1.0, lane.leads_on, *ends[0], *ends[1]


def observation_table() -> str:
    """Return the columns of the observation as a table in Markdown."""
    lines = ["| array | row | column | unit | from | to |", "|---|---|---|---|---:|---:|"]
    for name, (rows, columns) in OBSERVED.items():
        for k, one in enumerate(columns):
            row = f"1 to {rows}" if rows > 1 else ""
            lines.append(f"| `{name}` | {row} | {k}: {one.name} | {one.unit} | {one.low:g} | {one.high:g} |")
    return "\n".join([*lines, ""])
