"""The input that all judges share: the ego, who is near, and how near, computed once a step."""

from __future__ import annotations

import math
from array import array
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sumo_reactive.driver.nouns.record import Scene, StepRecord
from sumo_reactive.driver.nouns.traffic import RoadUser
from sumo_reactive.lab.metrics.contact import contacts

Array = NDArray[np.float64]
Figures = dict[str, float | int | None]

JUDGED_REACH_M = 80.0
"""Users farther away (front to front) are not judged."""

GHOST = "reactive.ghost."


class Moment(NamedTuple):
    """A step as the judges see it.

    `duration` is the time since the last step (s, NaN at first), `acceleration` the ego's since then (m/s²). `users` are
    all near; `boxes` (n, 6) holds their front x, y, heading, speed, length, width, `times_to_collision` what it says (s,
    infinite: none). `touching` are those, of all that are beside, whose box and the ego's overlap. `slowing` maps those that
    slow down to their acceleration (m/s², negative). `crossed` is the scene's.
    """

    step: StepRecord
    duration: float
    acceleration: float
    length: float
    width: float
    users: tuple[RoadUser, ...]
    boxes: Array
    touching: frozenset[str]
    times_to_collision: Sequence[float]
    slowing: Mapping[str, float]
    crossed: str

    @property
    def hardest_braking(self) -> float:
        """Acceleration of who brakes hardest, m/s²; 0 when nobody slows down."""
        return min(self.slowing.values(), default=0.0)


_NO_BOXES = np.empty((0, 6))
_NOBODY: frozenset[str] = frozenset()


class Watch:
    """Makes moments of scenes; remembers the last speeds."""

    def __init__(self, length: float, width: float) -> None:
        self._length, self._width = length, width
        self._last: StepRecord | None = None
        self._speeds: dict[str, float] = {}
        contacts(np.ones(6), np.ones((1, 6)))  # loads the kernel before the clock of the run starts

    def moment(self, scene: Scene) -> Moment:
        """Return what there is to judge in `scene`."""
        step, last = scene.step, self._last
        duration = step.time - last.time if last else math.nan
        acceleration = (step.speed - last.speed) / duration if last else math.nan
        near = _near(scene.users, step.x, step.y)
        boxes = _boxes(near) if near else _NO_BOXES
        touching, times = self._contacts(step, near, boxes) if near else (_NOBODY, ())
        known = {user.id for user in near}
        others = _near(tuple(user for user in scene.beside if user.id not in known), step.x, step.y)
        if others:
            touching |= self._contacts(step, others, _boxes(others))[0]
        speeds = {user.id: user.speed for user in near}
        before = self._speeds
        slowing = {
            name: (speed - before[name]) / duration for name, speed in speeds.items() if speed < before.get(name, 0.0)
        }
        self._last, self._speeds = step, speeds
        size = self._length, self._width
        return Moment(step, duration, acceleration, *size, near, boxes, touching, times, slowing, scene.crossed)

    def _contacts(
        self, step: StepRecord, users: tuple[RoadUser, ...], boxes: Array
    ) -> tuple[frozenset[str], Sequence[float]]:
        own = np.array([step.x, step.y, step.heading, step.speed, self._length, self._width])
        touches, times = contacts(own, boxes).tolist()
        if not any(touches):
            return _NOBODY, times
        return frozenset(user.id for user, touch in zip(users, touches, strict=True) if touch), times


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
