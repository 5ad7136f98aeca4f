"""What was around the ego: everybody that it saw, in columns, and the roads, lights, curves and constraints of its trip."""

from __future__ import annotations

import json
import math
from array import array
from collections.abc import Iterator
from itertools import chain
from operator import itemgetter
from pathlib import Path
from typing import Any

import numpy as np

from sumo_reactive.driver.geometry.curve import Curve
from sumo_reactive.driver.nouns.decision import PostConflictState
from sumo_reactive.driver.nouns.record import CastShadow, CommandField, GroundField, Scene
from sumo_reactive.driver.world.lane import Lane
from sumo_reactive.driver.world.road_graph import RoadGraph
from sumo_reactive.lab.columns import write_columns
from sumo_reactive.lab.schema import RECORD_VERSION

USERS, SURROUNDINGS = "users.parquet", "surroundings.json"
USER_MEANINGS = {
    "time_s": "simulation time at the end of the step",
    "user": "id of the road user",
    "x_m": "centre of his front bumper",
    "y_m": "centre of his front bumper",
    "heading_rad": "counter-clockwise from the x axis",
    "speed_m_s": "his speed",
    "length_m": "his length",
    "width_m": "his width",
    "signals": "SUMO's bits: 1 indicates to the right, 2 to the left, 8 brakes",
}
"""Columns of USERS: everybody within RECORDED_M of a single ego in a step, and whom its driver looked at; of several egos
whom each looked at, and all within 40 m."""

USER_NUMBERS = tuple(name for name in USER_MEANINGS if name != "user")
"""Those that are numbers."""

SURROUNDINGS_MEANINGS = {
    "version": "of the files of a record",
    "lanes": "outline of each lane within 200 m of the way driven, by id: points [x, y], m",
    "inside": "the same of lanes inside junctions",
    "lights": "[light, index of its letter, x, y, heading of the stop line, lane's width]: m, rad",
    "letters": "[time from when on, letters by light]: s",
    "curves": "[time from when on, points [x, y] of C]: s, m",
    "constraints": "[time from when on, places to stop at: [x, y, until when (null: for good), reason, cause]]: s, m",
    "rooms": "[time from when on, post-conflict regions: [connection, points of C, state, cause, whether awaited]]: s, m",
    "fields": "[time, accelerations, steering rates, U by both (null: not admissible)] of decisions, or all: s, m/s², rad/s",
    "shadows": "[time, R_D of others: [user, weight of U_D, corners [x, y]]] of decisions, or of all steps: s, m",
    "grounds": "[time, x, y, heading of the front, places ahead and left of it, U there (null: contact)]: s, m, rad",
}
"""Keys of SURROUNDINGS."""

RECORDED_M = 150.0
"""Everybody nearer than this to a single ego is recorded."""

SHOWN_SIGNALS = 0b1011
"""SUMO's bits of right, left and brakes."""

KEPT_STEP_M = 2.0
NEAR_THE_WAY_M = 200.0
"""Lanes nearer to the way driven than this are kept."""

_DECIMALS = 2
_MOVING = itemgetter(1, 2, 3, 4)
"""Place, heading and speed of a bystander or a road user."""


class SurroundingsRecord:
    """Keeps what is around an ego from step to step, and writes it."""

    def __init__(self, *, every_field: bool = False) -> None:
        self._every_field = every_field
        self._ids: dict[str, int] = {}
        self._users, self._counts, self._signals = array("I"), array("I"), array("B")
        self._numbers, self._sizes = array("f"), array("f")
        self._times = array("d")
        self._worlds: list[RoadGraph] = []
        self._letters: list[tuple[float, dict[str, str]]] = []
        self._curves: list[tuple[float, Curve]] = []
        self._constraints: list[tuple[float, list[list[Any]]]] = []
        self._rooms: list[tuple[float, list[list[Any]]]] = []
        self._told: tuple[object, object, object] = (None, None, None)
        self._track: list[tuple[float, float]] = []
        self._fields: list[list[Any]] = []
        self._shadows: list[list[Any]] = []
        self._grounds: list[list[Any]] = []

    def see(self, scene: Scene) -> None:
        """Keep one step."""
        step = scene.step
        self._track.append((step.x, step.y))
        self._keep_users(scene)
        if scene.world is not None and scene.world not in self._worlds[-1:]:
            self._worlds.append(scene.world)
        if scene.lights and (not self._letters or self._letters[-1][1] != scene.lights):
            self._letters.append((step.time, dict(scene.lights)))
        if scene.plan is not None and (not self._curves or self._curves[-1][1] is not scene.plan.curve):
            self._curves.append((step.time, scene.plan.curve))
        self._keep_constraints(scene)
        if (step.pilot or self._every_field) and scene.field is not None and (field := scene.field()) is not None:
            self._fields.append(_field(step.time, field))
        if (step.pilot or self._every_field) and scene.shadows is not None:
            self._shadows.append([round(step.time, 3), [_shadow(one) for one in scene.shadows()]])
        if self._every_field and step.pilot and scene.ground is not None:
            self._grounds.append(_ground(step.time, scene.ground()))

    def write_into(self, folder: Path) -> None:
        """Write both files into a folder. Raises OSError."""
        moving, sizes = (np.array(kept, dtype=np.float32) for kept in (self._numbers, self._sizes))
        who, counts = (np.array(kept, dtype=int) for kept in (self._users, self._counts))
        numbers = np.column_stack((moving.reshape(-1, 4), sizes.reshape(-1, 2)[who] if len(who) else np.empty((0, 2))))
        names = np.array(list(self._ids), dtype=object)
        columns: dict[str, Any] = {"time_s": np.repeat(np.array(self._times).round(3), counts), "user": names[who]}
        columns |= {name: numbers[:, k].astype(np.float32) for k, name in enumerate(USER_NUMBERS[1:-1])}
        columns[USER_NUMBERS[-1]] = np.array(self._signals, dtype=np.uint8)
        write_columns(folder / USERS, columns)
        text = json.dumps(self.told(), allow_nan=False, separators=(",", ":"))
        (folder / SURROUNDINGS).write_text(text + "\n", encoding="utf-8")

    def _keep_users(self, scene: Scene) -> None:
        around = scene.around() if scene.around is not None else ()
        known = {one.id for one in around}
        self._users.extend([self._number(one.id, one.length, one.width) for one in around])
        self._numbers.extend(chain.from_iterable(map(_MOVING, around)))
        self._signals.extend([one.signals & SHOWN_SIGNALS for one in around])
        for user in (*scene.users, *scene.beside):
            if user.id not in known:
                known.add(user.id)
                self._users.append(self._number(user.id, user.body.length, user.body.width))
                self._numbers.extend(_MOVING(user))
                self._signals.append(0)
        self._times.append(scene.step.time)
        self._counts.append(len(known))

    def _number(self, user_id: str, length: float, width: float) -> int:
        """Return the number of a road user, whose size (m) is kept with it."""
        number = self._ids.setdefault(user_id, len(self._sizes) // 2)
        if 2 * number == len(self._sizes):
            self._sizes.extend((length, width))
        return number

    def _keep_constraints(self, scene: Scene) -> None:
        if scene.plan is None:
            return
        told = scene.plan.curve, scene.step.constraints, scene.step.rooms
        if all(now is before for now, before in zip(told, self._told, strict=True)):
            return  # the plan is still in force
        self._told = told
        found = [
            [*_rounded(*scene.plan.curve.at(one.s)), _finite(one.time), one.reason.value, one.cause or one.region]
            for one in scene.step.constraints
        ]
        if not self._constraints or self._constraints[-1][1] != found:
            self._constraints.append((scene.step.time, found))
        rooms = [_room(scene.plan.curve, one) for one in scene.step.rooms]
        if rooms != (self._rooms[-1][1] if self._rooms else []):
            self._rooms.append((scene.step.time, rooms))

    def told(self) -> dict[str, Any]:
        """Return SURROUNDINGS as plain data: places in m, headings in rad, times in s."""
        return {
            "version": RECORD_VERSION,
            "lanes": {lane.id: _outline(lane) for lane in self._lanes() if not lane.is_internal},
            "inside": {lane.id: _outline(lane) for lane in self._lanes() if lane.is_internal},
            "lights": list(self._lights()),
            "letters": [[round(time, 3), letters] for time, letters in self._letters],
            "curves": [[round(time, 3), _points(curve)] for time, curve in self._curves],
            "constraints": [[round(time, 3), found] for time, found in self._constraints],
            "rooms": [[round(time, 3), found] for time, found in self._rooms],
            "fields": self._fields,
            "shadows": self._shadows,
            "grounds": self._grounds,
        }

    def _lanes(self) -> Iterator[Lane]:
        """Yield the lanes near the way driven, each once."""
        track = np.array(self._track[:: max(1, len(self._track) // 200)])
        lanes = {lane.id: lane for world in self._worlds for lane in world.lanes.values()}
        for lane in lanes.values() if len(track) else ():
            points = lane.spine.points
            apart = np.abs(points[:, None, :] - track[None, :, :]).max(axis=2)
            if float(apart.min()) < NEAR_THE_WAY_M + 0.5 * lane.spine.length:
                yield lane

    def _lights(self) -> Iterator[list[Any]]:
        """Yield for each way over a stop line with a light: light, index of its letter, place and heading of the line, its
        width."""
        for world in self._worlds:
            for connection in world.connections.values():
                lane = world.lanes.get(connection.from_lane)
                if connection.light is not None and lane is not None:
                    x, y = lane.spine.points[-1]
                    place = _rounded(x, y, lane.spine.heading_at(lane.spine.length))
                    yield [connection.light.light_id, connection.light.index, *place, lane.width]


def _outline(lane: Lane) -> list[list[float]]:
    """Return the corners of a lane's area, m."""
    return [[float(x), float(y)] for x, y in lane.outline.round(_DECIMALS)]


def _points(curve: Curve) -> list[list[float]]:
    step = max(1, round(KEPT_STEP_M / curve.step))
    picked = np.column_stack([curve.x[::step], curve.y[::step]])
    return [[float(x), float(y)] for x, y in picked.round(_DECIMALS)]


def _room(curve: Curve, state: PostConflictState) -> list[Any]:
    """Return connection, points of C in the room behind it (m), state, cause and whether the ego waits."""
    points = np.linspace(state.start, state.end, 2 + int((state.end - state.start) / KEPT_STEP_M))
    line = [_rounded(*curve.at(float(s))[:2]) for s in points]
    return [state.connection_id, line, state.occupancy.value, state.cause, state.waits]


def _shadow(shadow: CastShadow) -> list[Any]:
    return [shadow.user_id, round(shadow.weight, _DECIMALS), [_rounded(*corner) for corner in shadow.outline.tolist()]]


def _field(time: float, field: CommandField) -> list[Any]:
    """Return the time (s), accelerations (m/s²), steering rates (rad/s), U of each pair (None: it is not admissible)."""
    rows = [[_finite(value) for value in row] for row in field.potentials.tolist()]
    rates = [round(rate, 4) for rate in field.steering_rates.tolist()]
    return [round(time, 3), _rounded(*field.accelerations.tolist()), rates, rows]


def _ground(time: float, field: GroundField) -> list[Any]:
    """Return the time (s), place and heading of the front, places ahead and to the left (m), U there (None: contact)."""
    rows = [[_finite(value) for value in row] for row in field.potentials.tolist()]
    place = _rounded(field.x, field.y, field.heading)
    return [round(time, 3), place, _rounded(*field.ahead.tolist()), _rounded(*field.left.tolist()), rows]


def _rounded(*values: float) -> list[float]:
    return [round(float(value), _DECIMALS) for value in values]


def _finite(value: float) -> float | None:
    return round(value, _DECIMALS) if math.isfinite(value) else None
