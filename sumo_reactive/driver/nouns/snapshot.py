"""The local world as the pilot and the executor see it: the others, related to C and to the regions on it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sumo_reactive.driver.nouns.constraint import TimeConstraint
from sumo_reactive.driver.nouns.state import VehicleState
from sumo_reactive.driver.nouns.traffic import NO_SWITCHES, NO_YELLOWS, RoadUser, Switches
from sumo_reactive.driver.parameters import USUAL, Parameters
from sumo_reactive.driver.world.junction import Connection
from sumo_reactive.driver.world.regions import ConflictRegion

NEAR_M = 45.0
"""Users nearer than this cast U₂ and are tested for contact."""


class PathObstacle(NamedTuple):
    """A road user whose body reaches into the corridor along C.

    `start`, `end`: the stretch of C that it blocks (m); `along`, `across`: its velocity along C and to the left (m/s).
    """

    user: RoadUser
    start: float
    end: float
    along: float
    across: float


class Conflict(NamedTuple):
    """One conflict region on the way, and who goes first there.

    `must_yield`: the ego lets the other connection go first; `is_yielded_to`: the other connection lets the ego go first;
    `lets_pass`: the ids of all connections that it lets go first. `waits_in_the_way`: who waits for the ego
    where the map says has his body in its corridor. `reaches_over`: how far before the ego's stop line a long
    body on the other connection reaches over its way, m.
    """

    region: ConflictRegion
    other: Connection
    must_yield: bool
    is_yielded_to: bool
    lets_pass: frozenset[str] = frozenset()
    waits_in_the_way: bool = False
    reaches_over: float = 0.0


class Foe(NamedTuple):
    """A road user that can reach a conflict region on passage `passage` of the plan.

    `to_stop_line`, `to_region`, `to_clear`: its front's way (m) to its stop line, to the region, and until its rear has
    left the region; negative when behind it.
    """

    user: RoadUser
    passage: int
    conflict: Conflict
    to_stop_line: float
    to_region: float
    to_clear: float


class Neighbour(NamedTuple):
    """A vehicle on the lane that the next lane change leads to, or that the body will cut into, or one that asks to be let
    in; `ahead` is its front minus the ego's front (m)."""

    user: RoadUser
    ahead: float


class OffTracking(NamedTuple):
    """The body covers lane `lane_id`, beside its own, with the front axle from `start` to `end` of C (m)."""

    start: float
    end: float
    left: bool
    lane_id: str


class Snapshot(NamedTuple):
    """The ego and its surroundings at `time`.

    `s`, `d`: front axle on C (m, left positive); `front`: front bumper on C. `boxes` (n, 8): x, y, heading, speed, length,
    width, turn rate (rad/s), way left on the road (m) of every user near (front bumper centre). `static` (k, 2): points of
    O_S, m. `leaders`: bodies that the ego must stay behind, now. `foes`: none while the pilot's decision rests on
    none. `lights`: letters by light id. `passages`: the plan's passages in sight, by index. `off_tracking`: the next place,
    on a road, where the body will cover the lane beside; `neighbours` are then those on that lane. `room`: how far the ego
    may lean to the left and right of C inside its lane, m. `parameters`: the driver's. `switches`: when lights will
    switch, if the driver knows. `asker`: who on a lane of the ego's road asks to be let in. `yellow_until`: when a light
    that is yellow will switch, s, by its id, as far as is known.
    """

    time: float
    ego: VehicleState
    s: float
    d: float
    front: float
    boxes: NDArray[np.float64]
    static: NDArray[np.float64]
    on_path: tuple[PathObstacle, ...]
    leaders: tuple[TimeConstraint, ...]
    foes: tuple[Foe, ...]
    neighbours: tuple[Neighbour, ...]
    lights: Mapping[str, str]
    passages: tuple[int, ...] = ()
    off_tracking: OffTracking | None = None
    room: tuple[float, float] = (0.0, 0.0)
    parameters: Parameters = USUAL
    switches: Switches = NO_SWITCHES
    asker: Neighbour | None = None
    yellow_until: Mapping[str, float] = NO_YELLOWS
