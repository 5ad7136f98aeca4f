"""The input that all judges share: the ego, who is near, and how near, computed once a step."""

from __future__ import annotations

import math
from array import array
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sumo_reactive.compilation import kernel
from sumo_reactive.executor.shadow import corners_of, shadow_distance
from sumo_reactive.geometry.footprint import boxes_overlap
from sumo_reactive.messages.record import Scene, StepRecord
from sumo_reactive.messages.traffic import RoadUser

Array = NDArray[np.float64]
Figures = dict[str, float | int | None]

JUDGED_REACH_M = 80.0
"""Users farther away (front to front) are not judged."""

SHRINK_M = 0.05
"""Boxes are this much smaller on each side in the contact test: positions and mirrors are no more exact."""

MIN_SIDE_M = 0.05
"""…but never smaller than this; a pedestrian is 0.2 m long."""

GHOST = "reactive.ghost."


class Moment(NamedTuple):
    """A step as the judges see it.

    `duration` is the time since the last step (s, NaN at first), `acceleration` the ego's since then (m/s²). `users` are
    all near; `boxes` (n, 6) holds their front x, y, heading, speed, length, width, `touches` whether each box and the ego's
    overlap, `times_to_collision` what it says (s, infinite: none). `slowing` maps those that slow down to their
    acceleration (m/s², negative).
    """

    step: StepRecord
    duration: float
    acceleration: float
    length: float
    width: float
    users: tuple[RoadUser, ...]
    boxes: Array
    touches: Sequence[float]
    times_to_collision: Sequence[float]
    slowing: Mapping[str, float]

    @property
    def hardest_braking(self) -> float:
        """Acceleration of who brakes hardest, m/s²; 0 when nobody slows down."""
        return min(self.slowing.values(), default=0.0)


_NO_BOXES = np.empty((0, 6))


class Watch:
    """Makes moments of scenes; remembers the last speeds."""

    def __init__(self, length: float, width: float) -> None:
        self._length, self._width = length, width
        self._last: StepRecord | None = None
        self._speeds: dict[str, float] = {}
        contacts(np.ones((1, 6)), np.ones((1, 6)))  # loads the kernel before the clock of the run starts

    def moment(self, scene: Scene) -> Moment:
        """Return what there is to judge in `scene`."""
        step, last = scene.step, self._last
        duration = step.time - last.time if last else math.nan
        acceleration = (step.speed - last.speed) / duration if last else math.nan
        near = _near(scene.users, step.x, step.y)
        boxes = _boxes(near) if near else _NO_BOXES
        touches, times = self._contacts(step, boxes) if near else ((), ())
        speeds = {user.id: user.speed for user in near}
        before = self._speeds
        slowing = {
            name: (speed - before[name]) / duration for name, speed in speeds.items() if speed < before.get(name, 0.0)
        }
        self._last, self._speeds = step, speeds
        return Moment(step, duration, acceleration, self._length, self._width, near, boxes, touches, times, slowing)

    def _contacts(self, step: StepRecord, boxes: Array) -> tuple[Sequence[float], Sequence[float]]:
        own = np.array([[step.x, step.y, step.heading, step.speed, self._length, self._width]])
        touches, times = contacts(own, boxes).tolist()
        return touches, times


def _near(users: tuple[RoadUser, ...], x: float, y: float) -> tuple[RoadUser, ...]:
    reach = JUDGED_REACH_M * JUDGED_REACH_M
    near = [u for u in users if (dx := u.x - x) * dx + (dy := u.y - y) * dy < reach and not u.id.startswith(GHOST)]
    return tuple(near)


def _boxes(users: tuple[RoadUser, ...]) -> Array:
    flat: list[float] = []
    for user in users:
        body = user.body
        flat += (user.x, user.y, user.heading, user.speed, body.length, body.width)
    return np.frombuffer(array("d", flat)).reshape(-1, 6)


@kernel
def contacts(own: Array, boxes: Array) -> Array:
    """Return (2, n): overlap (0 or 1) and time to collision δ / ‖v − v_D‖ (s) of box `own` (1, 6) with `boxes` (n, 6).

    Columns are front x, y, heading, speed, length, width. Both bodies keep their velocities (F&L 1991, §3.3.2).
    """
    out = np.empty((2, len(boxes)))
    mine, theirs = corners_of(own), corners_of(boxes)
    own_length, own_width = own[0, 4] - 2.0 * SHRINK_M, own[0, 5] - 2.0 * SHRINK_M
    for k in range(len(boxes)):
        length = max(MIN_SIDE_M, boxes[k, 4] - 2.0 * SHRINK_M)
        width = max(MIN_SIDE_M, boxes[k, 5] - 2.0 * SHRINK_M)
        touching = boxes_overlap(
            mine[0, 5, 0], mine[0, 5, 1], own[0, 2], own_length, own_width,
            theirs[k, 5, 0], theirs[k, 5, 1], boxes[k, 2], length, width,
        )  # fmt: skip
        rx, ry = mine[0, 4, 0] - theirs[k, 4, 0], mine[0, 4, 1] - theirs[k, 4, 1]
        relative = math.hypot(rx, ry)
        out[0, k] = 1.0 if touching else 0.0
        out[1, k] = np.inf
        if relative > 1e-6:
            out[1, k] = shadow_distance(mine[0, :4], theirs[k, :4], rx / relative, ry / relative) / relative
    return out
