"""A scenario as a Gymnasium environment: the ego is driven by actions, and judged as in every other trip.

    env = gymnasium.make("sumo_reactive.gym:SumoReactive-v0", scenario="scenarios/roundabout.toml")

libsumo holds one simulation in a process: several environments at once need processes of their own (`AsyncVectorEnv`); a
reset ends the episode of another one in the same process.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import replace
from enum import Enum
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple, cast

import gymnasium
import numpy as np
from gymnasium.spaces import Box, Dict, Space
from numpy.typing import NDArray

from sumo_reactive.driver.geometry.polyline import wrapped
from sumo_reactive.driver.nouns.state import Command
from sumo_reactive.driver.nouns.surroundings import LaneAround
from sumo_reactive.lab.drivers.protocol import Driver, DriverAnswer, DriverView, LaneCommand, Mission, TripEnd
from sumo_reactive.lab.drivers.users_trip import UsersTrip
from sumo_reactive.lab.egos import find_ego
from sumo_reactive.lab.fault import Fault
from sumo_reactive.lab.metric_names import EVERY
from sumo_reactive.lab.scenario import load_scenario
from sumo_reactive.lab.simulation import Simulation, started
from sumo_reactive.sumo.config import read_config
from sumo_reactive.sumo.net_reader import read_net

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


class ActionKind(Enum):
    """What an action means, in shares of what the car can: acceleration and steering rate, or the speed to drive at."""

    STEER = "steer"
    SPEED = "speed"


class Transition(NamedTuple):
    """What a reward is made of: the views before and after a step, way won (m), what the ego has done amiss in it."""

    before: DriverView
    after: DriverView
    advanced: float
    faults: tuple[Fault, ...]


Reward = Callable[[Transition], float]

FAULT_COST, JERK_COST = 10.0, 0.02


def progress_reward(one: Transition) -> float:
    """Return a tenth of the metres won, less for a change of acceleration, and much less for a fault."""
    jerk = abs(one.after.state.acceleration - one.before.state.acceleration)
    return 0.1 * one.advanced - JERK_COST * jerk - FAULT_COST * len(one.faults)


class _Seat(Driver):
    """The driver whose answer is the action."""

    def __init__(self) -> None:
        self.answer: DriverAnswer = LaneCommand(0.0)
        self.mission: Mission | None = None

    def start(self, mission: Mission) -> None:
        self.mission = mission

    def step(self, view: DriverView) -> DriverAnswer:
        return self.answer

    def end(self, result: TripEnd) -> None:
        self.answer = LaneCommand(0.0)


class SumoReactiveEnv(gymnasium.Env[Observation, Floats32]):
    """The ego of a scenario file, `horizon_s` long at most; `action` is "steer" or "speed", `reward` any function.

    An episode is `terminated` at the goal or by a contact, `truncated` at the horizon, when the trip ends otherwise, or when
    the ego is LOST_M off its way. `info`
    tells the faults of a step, and at the end the verdict and every figure of the judges. A seed is SUMO's.
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": 10}  # noqa: RUF012 (as Gymnasium has it)
    _open: SumoReactiveEnv | None = None

    def __init__(
        self, scenario: str | Path, *, action: str = "steer", reward: Reward = progress_reward, horizon_s: float = 300.0,
        render_mode: str | None = None,
    ) -> None:  # fmt: skip
        self._scenario = replace(load_scenario(Path(scenario)), horizon_s=horizon_s)
        self._net = read_net(read_config(self._scenario.config).net_file)
        self._kind, self._reward, self.render_mode = ActionKind(action), reward, render_mode
        self._running, self._seat = ExitStack(), _Seat()
        self._simulation: Simulation | None = None
        self._trip: UsersTrip | None = None
        self._way, self._k, self._known = np.zeros((1, 2)), 0, 0
        self._boxes = {name: _box(*shape) for name, shape in OBSERVED.items()}
        self.observation_space: Space[Observation] = cast("Space[Observation]", Dict(dict[str, Space[Any]](self._boxes)))
        self.action_space: Space[Floats32] = Box(-1.0, 1.0, (2 if self._kind is ActionKind.STEER else 1,), np.float32)

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Observation, dict[str, Any]]:
        """Start SUMO anew with the seed (drawn where none is given), and take the ego over where it departs."""
        super().reset(seed=seed)
        if SumoReactiveEnv._open is not None:
            SumoReactiveEnv._open.close()
        SumoReactiveEnv._open = self
        drawn = int(self.np_random.integers(2**31 - 1)) if seed is None else seed
        scenario, self._seat = replace(self._scenario, seed=drawn), _Seat()
        start = self._running.enter_context(started(scenario))

        def take_over(ego: str) -> UsersTrip:
            self._trip = UsersTrip(start.session, ego, self._net, scenario, lambda: self._seat)
            return self._trip

        self._simulation = Simulation(start, scenario, take_over, None, None)
        self._simulation.admit(*find_ego(start.session, scenario, start.config, None))
        assert self._trip is not None and self._seat.mission is not None
        self._way, self._k, self._known = _sampled(self._seat.mission.way), 0, 0
        self._view = self._trip.view()
        self._advance(self._view)
        return self._observed(self._view), {"ego": self._trip.id, "seed": drawn}

    def step(self, action: Floats32) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Drive one step of the simulation by an action."""
        if self._simulation is None or self._trip is None:
            raise gymnasium.error.ResetNeeded("no episode is under way in this process")
        simulation, trip, before = self._simulation, self._trip, self._view
        jury = simulation.juries[trip.id]
        self._seat.answer = self._meant(np.asarray(action, dtype=float), before)
        simulation.step()
        has_ended = bool(simulation.results)
        after = before if has_ended else trip.view()
        faults = jury.faults[self._known :]
        self._known += len(faults)
        advanced = self._advance(after)
        reward = float(self._reward(Transition(before, after, advanced, faults)))
        self._view = after
        touches = any(fault.kind == "collision" for fault in faults)
        info: dict[str, Any] = {"faults": [str(fault) for fault in faults]}
        if has_ended or touches:
            figures = jury.figures()
            info |= {"verdict": simulation.results[0].verdict if has_ended else str(faults[0]), "figures": figures}
        terminated = touches or (has_ended and trip.arrived)
        is_lost = math.dist((after.ego.x, after.ego.y), self._way[self._k]) > LOST_M
        return self._observed(after), reward, terminated, not terminated and (has_ended or is_lost), info

    def close(self) -> None:
        """End the simulation."""
        self._running.close()
        self._simulation = self._trip = None
        if SumoReactiveEnv._open is self:
            SumoReactiveEnv._open = None

    def render(self) -> NDArray[np.uint8]:
        """Return a picture of the road from above, the ego in its middle."""
        if self._trip is None or self._seat.mission is None:
            raise gymnasium.error.ResetNeeded("no episode is under way in this process")
        return picture(self._view, self._way, self._seat.mission)

    def _meant(self, action: NDArray[np.float64], view: DriverView) -> DriverAnswer:
        assert self._seat.mission is not None
        limits, share = self._seat.mission.limits, np.clip(action, -1.0, 1.0)
        most, least = limits.max_acceleration, limits.service_deceleration
        if self._kind is ActionKind.STEER:
            gain = share[0] * (most if share[0] > 0.0 else least)
            return Command(float(gain), float(share[1]) * limits.max_steering_rate)
        limit = view.surroundings.own.limit if view.surroundings else limits.max_speed
        gain = 0.5 * (1.0 + float(share[0])) * min(limit, limits.max_speed) - view.ego.speed
        return LaneCommand(min(max(gain, -least), most))

    def _advance(self, view: DriverView) -> float:
        """Find the front on the way; return the way that it has won, m."""
        near = self._way[self._k : self._k + WINDOW] - (view.ego.x, view.ego.y)
        won = int(np.argmin(np.einsum("ij,ij->i", near, near))) if len(near) else 0
        self._k += won
        return SAMPLE_M * won

    def _observed(self, view: DriverView) -> Observation:
        """Return the arrays of a view, clipped to their limits."""
        here = self._way[min(self._k + 1, len(self._way) - 1)] - self._way[min(self._k, len(self._way) - 2)]
        heading, own = math.atan2(here[1], here[0]), view.ego
        dx, dy = (own.x, own.y) - self._way[self._k]
        offset = float(dy * math.cos(heading) - dx * math.sin(heading))
        around, left = view.surroundings, SAMPLE_M * (len(self._way) - 1 - self._k)
        ego = (own.speed, view.state.acceleration, view.state.steering_angle, offset, wrapped(own.heading - heading),
               around.own.limit if around else 0.0, left)  # fmt: skip
        light = around.light if around else None
        lanes = (around.own, around.inner, around.outer) if around else (None, None, None)
        rows: dict[str, Any] = {
            "ego": ego, "way": self._way_ahead(view), "users": _users(view), "lanes": [_lane(lane) for lane in lanes],
            "light": (light.distance, light.letter in "ru", light.letter in "yY") if light else (FAR_M, 0.0, 0.0),
        }  # fmt: skip
        return {name: np.clip(rows[name], box.low, box.high).astype(np.float32) for name, box in self._boxes.items()}

    def _way_ahead(self, view: DriverView) -> NDArray[np.float64]:
        number, step = OBSERVED["way"][0], round(WAY_STEP_M / SAMPLE_M)
        at = np.minimum(self._k + step * np.arange(1, number + 1), len(self._way) - 1)
        return _seen_from(view, self._way[at])


SAMPLE_M = 0.5
"""Between two points of the way as it is kept."""

LOST_M = 25.0
"""More than a carriageway of lanes beside each other."""

WINDOW = 200
"""So many of them are looked at for the front: 100 m."""


def _box(rows: int, columns: tuple[Column, ...]) -> Box:
    low, high = (np.array([getattr(one, end) for one in columns], dtype=np.float32) for end in ("low", "high"))
    return Box(low, high, dtype=np.float32) if rows == 1 else Box(np.tile(low, (rows, 1)), np.tile(high, (rows, 1)))


def _sampled(line: NDArray[np.float64]) -> NDArray[np.float64]:
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
    for row, k in enumerate(nearest):
        user, (x, y) = users[k], places[k]
        turn = wrapped(user.heading - view.ego.heading)
        rows[row] = 1.0, x, y, turn, user.speed, user.body.length, user.body.width
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


SIDE_PX, SHOWN_M = 400, 80.0
_GRASS, _ROAD, _WAY, _OTHER, _EGO = (214, 222, 208), (150, 156, 163), (86, 180, 233), (60, 66, 72), (213, 94, 0)


def picture(view: DriverView, way: NDArray[np.float64], mission: Mission) -> NDArray[np.uint8]:
    """Return (SIDE_PX, SIDE_PX, 3) pixels: SHOWN_M of road around the ego, north up: lanes, way, bodies."""
    image = np.empty((SIDE_PX, SIDE_PX, 3), dtype=np.uint8)
    image[:] = _GRASS
    scale, own = SIDE_PX / SHOWN_M, view.ego
    columns, rows = np.meshgrid(np.arange(SIDE_PX), np.arange(SIDE_PX))
    xs, ys = own.x + (columns - 0.5 * SIDE_PX) / scale, own.y - (rows - 0.5 * SIDE_PX) / scale

    def box(x: float, y: float, heading: float, length: float, width: float, colour: tuple[int, int, int]) -> None:
        along = (xs - x) * math.cos(heading) + (ys - y) * math.sin(heading)
        across = (ys - y) * math.cos(heading) - (xs - x) * math.sin(heading)
        image[(along <= 0.0) & (along >= -length) & (np.abs(across) <= 0.5 * width)] = colour

    def line(points: NDArray[np.float64], width: float, colour: tuple[int, int, int]) -> None:
        for (x0, y0), (x1, y1) in pairwise(points):
            if math.hypot(x1 - own.x, y1 - own.y) < SHOWN_M or math.hypot(x0 - own.x, y0 - own.y) < SHOWN_M:
                box(x1, y1, math.atan2(y1 - y0, x1 - x0), math.hypot(x1 - x0, y1 - y0), width, colour)

    for lane in mission.roads.lanes.values():
        if np.hypot(*(lane.spine.points - (own.x, own.y)).T).min() < lane.length + SHOWN_M:
            line(lane.spine.points, lane.width, _ROAD)
    near = way[np.hypot(*(way - (own.x, own.y)).T) < SHOWN_M]
    line(near[::4], 0.4, _WAY)
    for user in view.users:
        box(user.x, user.y, user.heading, user.body.length, user.body.width, _OTHER)
    box(own.x, own.y, own.heading, own.body.length, own.body.width, _EGO)
    return image


gymnasium.register("SumoReactive-v0", entry_point="sumo_reactive.gym:SumoReactiveEnv")
