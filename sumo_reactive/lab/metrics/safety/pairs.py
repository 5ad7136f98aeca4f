"""Who meets the ego, step by step: whom it follows, who follows it, who is beside it, measured along the way it drove."""

from __future__ import annotations

import math
from operator import attrgetter
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sumo_reactive.driver.geometry.polyline import Floats
from sumo_reactive.lab.metrics.moment import Moment, Nearby
from sumo_reactive.lab.metrics.way import along_way, driven_way

OTHERWISE, AHEAD, BEHIND, BESIDE = range(4)
"""How a user meets the ego."""

RELATIONS = ("otherwise", "ahead", "behind", "beside")
"""The same in words."""

SAME_DIRECTION = math.cos(math.radians(45.0))
"""Who turns away from the ego's way by more follows nobody and is followed by nobody there."""

NEAR_BESIDE_M = 4.0
"""Who has more room to the side than about a lane's width is not beside the ego."""


class Pairs(NamedTuple):
    """Arrays with a value a pair of the ego and a user near, and step.

    `row` counts pairs as they were kept, `step` the steps; `time`, `duration` of the step (s, NaN at first). `relation`: the
    nearest one ahead in the ego's way, the nearest behind on it, who is beside, or none of these. `gap` is the room along
    the way between both bodies (m, 0: none), `lateral_gap` that beside it, `spacing` the way from the ego's front to the
    user's. `ego_speed`, `user_speed` are along the way, `approach` is how fast the user comes nearer from the side (m/s),
    the accelerations are since the last step (m/s², NaN: unknown).
    """

    row: NDArray[np.int64]
    step: NDArray[np.int64]
    time: Floats
    duration: Floats
    relation: NDArray[np.int64]
    gap: Floats
    lateral_gap: Floats
    spacing: Floats
    ego_speed: Floats
    user_speed: Floats
    approach: Floats
    ego_acceleration: Floats
    user_acceleration: Floats

    def only(self, chosen: NDArray[np.bool_]) -> Pairs:
        """Return the pairs that are chosen."""
        return Pairs._make(np.asarray(column)[chosen] for column in self)

    def that_are(self, relation: int) -> Pairs:
        """Return the pairs of one relation."""
        return self.only(self.relation == relation)


class PairLog:
    """Keeps who was near at each step; what that comes to is worked out when all is over."""

    def __init__(self) -> None:
        self._ego: list[tuple[float, ...]] = []
        self._boxes: list[Floats] = []
        self._accelerations: list[Floats] = []
        self._ids: list[tuple[str, ...]] = []
        along_way(np.eye(2), np.zeros(1, dtype=np.int64), np.ones((1, 6)))  # loads the kernel before the clock starts

    def see(self, moment: Moment | Nearby) -> None:
        """Keep one step."""
        step = moment.step
        self._ego.append((step.time, step.x, step.y, step.heading, step.speed, moment.duration, moment.acceleration))
        self._boxes.append(moment.boxes)
        self._accelerations.append(moment.accelerations)
        self._ids.append(tuple(map(attrgetter("id"), moment.users)))

    @property
    def ids(self) -> list[str]:
        """The user of each row."""
        return [name for names in self._ids for name in names]

    @property
    def ego(self) -> Floats:
        """Time, front x, y, heading, speed, duration and acceleration of the ego at each step, (n, 7)."""
        return np.array(self._ego).reshape(-1, 7)

    @property
    def boxes(self) -> Floats:
        """The box of each row's user, (n, 6)."""
        return np.concatenate(self._boxes) if self._boxes else np.empty((0, 6))

    def pairs(self, length: float, width: float) -> Pairs:
        """Return all rows as pairs with an ego of this size (m)."""
        boxes = self.boxes
        if not len(boxes):
            return Pairs._make(np.empty((len(Pairs._fields), 0)))
        own = self.ego
        way = driven_way(*own[:, 1:4].T)
        step = np.repeat(np.arange(len(own)), [len(some) for some in self._boxes])
        front, rear, aside, rear_aside, turn = along_way(way.points, way.nearest[step], boxes).T
        time, _, _, _, ego_speed, duration, ego_acceleration = own[step].T
        ego, half = way.along[step], 0.5 * (width + boxes[:, 5])
        left, right = np.minimum(aside, rear_aside), np.maximum(aside, rear_aside)
        lateral_gap = np.maximum(np.maximum(left, -right) - half, 0.0)
        gap = np.maximum(np.maximum(rear - ego, ego - length - front), 0.0)
        is_along = np.cos(turn) > SAME_DIRECTION
        relation = _relations(step, is_along, gap, lateral_gap, front > ego)
        speed = boxes[:, 3]
        approach = -np.sign(left + right) * speed * np.sin(turn)
        return Pairs(
            np.arange(len(step)), step, time, duration, relation, gap, lateral_gap, front - ego,
            ego_speed, speed * np.cos(turn), approach, ego_acceleration, np.concatenate(self._accelerations),
        )  # fmt: skip


def _relations(
    step: NDArray[np.int64], is_along: NDArray[np.bool_], gap: Floats, lateral_gap: Floats, is_ahead: NDArray[np.bool_]
) -> NDArray[np.int64]:
    """Return how each user meets the ego; of those in its way only the nearest ahead and the nearest behind count."""
    relation = np.full(len(step), OTHERWISE)
    relation[is_along & (gap == 0.0) & (lateral_gap > 0.0) & (lateral_gap < NEAR_BESIDE_M)] = BESIDE
    in_way = is_along & (lateral_gap == 0.0)
    for side, chosen in ((AHEAD, in_way & is_ahead), (BEHIND, in_way & ~is_ahead)):
        nearest = np.full(int(step[-1]) + 1, np.inf)
        np.minimum.at(nearest, step[chosen], gap[chosen])
        relation[chosen & (gap == nearest[step])] = side
    return relation
