"""What is observed of the others: one value per step, straight from the simulation or any other perception."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from struct import Struct
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

TWO_WHEELER_WIDTH_M = 1.2
"""A narrower vehicle is one."""

QUEUED_SPEED = 3.0
"""m/s; who is slower than this crawls in a queue, and may stop at once."""

FOLLOWER_STANDSTILL_GAP_M = 2.5
"""A follower keeps this gap at standstill (SUMO's minGap)."""

NO_POINTS: NDArray[np.float64] = np.empty((0, 2))
"""No static obstacle."""


GAINED_SHARE = 0.57
"""Who makes use of a gap speeds up by this share of what its kind can: cars by 1.5 of 2.6 m/s², motorcycles by 3.4 of 6."""


class Body(NamedTuple):
    """What does not change about a road user: m, m/s², m/s. `is_person` marks pedestrians. `first_part` (m): where a body in
    several parts bends (0: nowhere); seen is one box, all of it along the first part. `acceleration`: what its kind can
    (0: unknown)."""

    length: float
    width: float
    emergency_deceleration: float
    max_speed: float
    is_person: bool = False
    first_part: float = 0.0
    acceleration: float = 0.0

    def gains(self, usual: float) -> float:
        """Return how it may speed up, m/s²: as is `usual`, or more if its kind can."""
        return max(usual, GAINED_SHARE * self.acceleration)

    @property
    def turning_length(self) -> float:
        """The length (m) both ends of which keep to the way."""
        return self.first_part or self.length


class RoadUser(NamedTuple):
    """Another vehicle or a pedestrian.

    `x`, `y` is the centre of the front bumper (m), `heading` in rad, `speed` in m/s, `lane_position` the front's arc
    length on the spine of `lane_id` (m). `route` holds the edges still to drive, the present one first (empty: unknown).
    `waiting_time` is how long it has been standing, s. `is_halted`: it visibly stays where it is (parked, broken down, at a
    bus stop). `acceleration`: how it is seen to gain speed, m/s², negative while it brakes.
    """

    id: str
    x: float
    y: float
    heading: float
    speed: float
    lane_id: str
    lane_position: float
    body: Body
    route: tuple[str, ...] = ()
    waiting_time: float = 0.0
    is_halted: bool = False
    acceleration: float = 0.0


_BOX = Struct("6d")

BOX_BYTES = _BOX.size
"""A packed box takes so many."""


def packed_boxes(users: Iterable[RoadUser]) -> bytes:
    """Return the boxes of `users` as `boxes_of` does, packed."""
    pack = _BOX.pack
    return b"".join([pack(u[1], u[2], u[3], u[4], u[7][0], u[7][1]) for u in users])  # by place: it is done at every step


def boxes_of(users: Iterable[RoadUser]) -> NDArray[np.float64]:
    """Return the boxes (n, 6) of `users`: front x, y, heading, speed, length, width (m, rad, m/s)."""
    return np.frombuffer(bytearray(packed_boxes(users))).reshape(-1, 6)


Switches = Mapping[str, tuple[tuple[float, str], ...]]
"""By light id: the times (s) at which a light will switch, in order, and its letters from then on."""

NO_SWITCHES: Switches = {}
"""Nothing is known of the lights' future."""

NO_YELLOWS: Mapping[str, float] = {}
"""Nothing is known of when a yellow ends."""


@dataclass(frozen=True, kw_only=True)
class Traffic:
    """All that is seen at `time` (s): the others, and the letters of each traffic light by its id.

    `sight` (m): how far ahead the oncoming lane was looked at. `static` (k, 2): points, m, of what stands near for good,
    roads' borders apart, which the map tells. `beside`: pedestrians who are about to step on a crossing, their position
    negative or beyond its length; they are not on the road yet. `yellow_until` (s): when a light that is yellow will switch,
    by its id, as far as is known: how long a yellow lasts everybody sees who drives there. `switches`: what is known of the
    lights' future. `asker`: which other ego asks this one to let it in (empty: none does). `as_packed`: the boxes of all
    `users`, where whoever has seen them has packed them.
    """

    time: float
    users: tuple[RoadUser, ...]
    lights: Mapping[str, str]
    sight: float = 0.0
    static: NDArray[np.float64] = field(default_factory=lambda: NO_POINTS, compare=False)
    beside: tuple[RoadUser, ...] = ()
    yellow_until: Mapping[str, float] = field(default_factory=lambda: NO_YELLOWS)
    switches: Switches = field(default_factory=lambda: NO_SWITCHES)
    asker: str = ""
    as_packed: bytearray | None = field(default=None, compare=False, repr=False)

    @cached_property
    def boxes(self) -> NDArray[np.float64]:
        """The boxes (n, 6) of `users`, packed once for all who look at them."""
        return boxes_of(self.users) if self.as_packed is None else np.frombuffer(self.as_packed).reshape(-1, 6)
