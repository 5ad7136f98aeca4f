"""The input that all judges share: the ego, who is near, and how near, by a ruler that is not the driver's."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from itertools import compress
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sumo_reactive.driver.compilation import kernel
from sumo_reactive.driver.geometry.polyline import Floats
from sumo_reactive.driver.nouns.record import Scene, StepRecord
from sumo_reactive.driver.nouns.traffic import RoadUser, boxes_of
from sumo_reactive.driver.world.lane import CROSSING_SINE
from sumo_reactive.driver.world.road_graph import RoadGraph

SHRINK_M = 0.05
"""Boxes are this much smaller on each side in the contact test: positions and mirrors are no more exact."""

MIN_SIDE_M = 0.05
"""…but never smaller than this; a pedestrian is 0.2 m long."""

SAME_VELOCITY = 1e-6
"""m/s; bodies whose velocities differ less keep their distance."""


@kernel
def contacts(own: Floats, boxes: Floats) -> Floats:
    """Return (2, n): overlap (0 or 1) and time to collision (s, infinite: none) of box `own` (6,) with `boxes` (n, 6).

    Columns are front x, y, heading, speed, length, width (m, rad, m/s). Both bodies keep their velocities: they touch as
    soon as their shadows on each of their four axes overlap, and shadows move evenly. It is the δ / ‖v − v_D‖ of F&L 1991,
    §3.3.2. Bodies that slide along each other do not collide.
    """
    out = np.empty((2, len(boxes)))
    for k in range(len(boxes)):
        out[0, k], out[1, k] = _meeting(own, boxes[k])
    return out


@kernel
def nearer(boxes: Floats, x: float, y: float, reach: float) -> tuple[NDArray[np.int64], Floats]:
    """Return which of `boxes` (n, 6) have their front nearer than `reach` to a place (m), and these, (m, 6)."""
    which, found, m = np.empty(len(boxes), dtype=np.int64), np.empty((len(boxes), 6)), 0
    for k in range(len(boxes)):
        dx, dy = boxes[k, 0] - x, boxes[k, 1] - y
        if dx * dx + dy * dy < reach * reach:
            which[m] = k
            for column in range(6):
                found[m, column] = boxes[k, column]
            m += 1
    return which[:m], found[:m]


@kernel
def meetings(owns: Floats, boxes: Floats) -> Floats:
    """Return (n,): the time to collision (s) of each of `owns` (n, 6) with its one of `boxes` (n, 6), as `contacts` does."""
    out = np.empty(len(boxes))
    for k in range(len(boxes)):
        out[k] = _meeting(owns[k], boxes[k])[1]
    return out


@kernel
def _meeting(own: Floats, other: Floats) -> tuple[float, float]:
    """Return what `contacts` does of one box: (overlap, time)."""
    dx, dy = _middle(other, 0) - _middle(own, 0), _middle(other, 1) - _middle(own, 1)
    vx = own[3] * math.cos(own[2]) - other[3] * math.cos(other[2])
    vy = own[3] * math.sin(own[2]) - other[3] * math.sin(other[2])
    overlaps, begin, end = 1.0, 0.0, np.inf if math.hypot(vx, vy) > SAME_VELOCITY else 0.0
    for axis in range(4):
        heading = (own[2] if axis < 2 else other[2]) + 0.5 * math.pi * (axis % 2)
        ux, uy = math.cos(heading), math.sin(heading)
        apart, closing = dx * ux + dy * uy, vx * ux + vy * uy
        reach = _reach(own, heading, 0.0) + _reach(other, heading, 0.0)
        if abs(apart) >= _reach(own, heading, SHRINK_M) + _reach(other, heading, SHRINK_M):
            overlaps = 0.0
        if abs(closing) > SAME_VELOCITY:
            near, far = (apart - reach) / closing, (apart + reach) / closing
            begin, end = max(begin, min(near, far)), min(end, max(near, far))
        elif abs(apart) >= reach:
            end = -np.inf
    return overlaps, begin if begin < end else np.inf


@kernel
def _middle(box: Floats, axis: int) -> float:
    """Return x (`axis` 0) or y (1) of the centre of a box, m."""
    along = math.cos(box[2]) if axis == 0 else math.sin(box[2])
    return float(box[axis] - 0.5 * box[4] * along)


@kernel
def _reach(box: Floats, heading: float, shrink: float) -> float:
    """Return half the length (m) of the shadow of a box, `shrink` m smaller on each side, on an axis along `heading`."""
    turn = heading - box[2]
    length, width = max(box[4] - 2.0 * shrink, MIN_SIDE_M), max(box[5] - 2.0 * shrink, MIN_SIDE_M)
    return float(0.5 * (length * abs(math.cos(turn)) + width * abs(math.sin(turn))))


Figures = dict[str, float | int | None]

JUDGED_REACH_M = 80.0
"""Users farther away (front to front) are not judged."""

ONCOMING = math.radians(135.0)
"""rad; who turns away from the ego by more comes towards it, and is not counted: on bends straight lines cross."""

GHOST = "reactive.ghost."


class Nearby(NamedTuple):
    """Who is near the ego after a step.

    `duration` is the time since the last step (s, NaN at first), `acceleration` the ego's since then (m/s²). `users` are
    all near; `boxes` (n, 6) holds their front x, y, heading, speed, length, width, `accelerations` (n,) how they gained
    speed since the last step (m/s², NaN: was not near then).
    """

    step: StepRecord
    duration: float
    acceleration: float
    users: tuple[RoadUser, ...]
    boxes: Floats
    accelerations: Floats


class Moment(NamedTuple):
    """A step as the judges see it, by an ego of a `length` and `width` (m).

    The first are those of `Nearby`. `times_to_collision` are those with its `boxes` (s, infinite: none). `touching` are
    those, of all that are beside, whose box and the ego's overlap. `slowing` maps those that slow down to their
    acceleration (m/s², negative). `crossed` and `world` are the scene's.
    """

    step: StepRecord
    duration: float
    acceleration: float
    users: tuple[RoadUser, ...]
    boxes: Floats
    accelerations: Floats
    length: float
    width: float
    touching: frozenset[str]
    times_to_collision: Sequence[float]
    slowing: Mapping[str, float]
    crossed: str
    world: RoadGraph | None

    @property
    def hardest_braking(self) -> float:
        """Acceleration of who brakes hardest, m/s²; 0 when nobody slows down."""
        return min(self.slowing.values(), default=0.0)


_NO_BOXES, _NOTHING = np.empty((0, 6)), np.empty(0)
_NOBODY: frozenset[str] = frozenset()


class Neighbourhood:
    """Looks who is near; remembers who was there last."""

    def __init__(self) -> None:
        self._last: StepRecord | None = None
        self._users: Mapping[str, RoadUser] = {}

    def look(self, scene: Scene) -> Nearby:
        """Return who is near in `scene`."""
        step, last = scene.step, self._last
        duration = step.time - last.time if last else math.nan
        acceleration = (step.speed - last.speed) / duration if last else math.nan
        (near, boxes), before = _near(scene.users, step.x, step.y, scene.boxes), self._users
        changes = [_change(before[user.id], user, duration) if user.id in before else math.nan for user in near]
        self._last, self._users = step, {user.id: user for user in near}
        return Nearby(step, duration, acceleration, near, boxes, np.array(changes) if near else _NOTHING)


class Watch:
    """Makes moments of scenes."""

    def __init__(self, length: float, width: float) -> None:
        self._length, self._width = length, width
        self._neighbourhood = Neighbourhood()
        contacts(np.ones(6), np.ones((1, 6)))  # loads the kernels before the clock of the run starts
        nearer(np.ones((1, 6)), 0.0, 0.0, 1.0)

    def moment(self, scene: Scene) -> Moment:
        """Return what there is to judge in `scene`."""
        nearby = self._neighbourhood.look(scene)
        step, near = scene.step, nearby.users
        touching, times = self._contacts(step, near, nearby.boxes) if near else (_NOBODY, ())
        known = {user.id for user in near}
        others, boxes = _near(tuple(user for user in scene.beside if user.id not in known), step.x, step.y)
        if others:
            touching |= self._contacts(step, others, boxes)[0]
        if touching and scene.apart is not None:
            touching -= _on_bridges((*near, *others), step, scene.apart)
        changes = zip(near, nearby.accelerations.tolist(), strict=True)
        slowing = {user.id: change for user, change in changes if change < 0.0}
        return Moment(*nearby, self._length, self._width, touching, times, slowing, scene.crossed, scene.world)

    def _contacts(
        self, step: StepRecord, users: tuple[RoadUser, ...], boxes: Floats
    ) -> tuple[frozenset[str], Sequence[float]]:
        own = np.array([step.x, step.y, step.heading, step.speed, self._length, self._width])
        touches, times = contacts(own, boxes).tolist()
        if not any(touches):
            return _NOBODY, times
        return frozenset(user.id for user, touch in zip(users, touches, strict=True) if touch), times


def _on_bridges(
    users: Sequence[RoadUser], step: StepRecord, apart: Callable[[str, str], bool]
) -> frozenset[str]:
    """Return who passes the ego on a bridge, or below one: across its way, on a lane that no junction joins to its own."""
    across = (one for one in users if abs(math.sin(one.heading - step.heading)) > CROSSING_SINE)
    return frozenset(one.id for one in across if apart(step.lane_id, one.lane_id))


def is_oncoming(boxes: Floats, heading: float) -> NDArray[np.bool_]:
    """Return which of `boxes` (n, 6) come towards who has a heading (rad), shape (n,)."""
    return np.asarray(np.cos(boxes[:, 2] - heading) < math.cos(ONCOMING))


def _change(before: RoadUser, user: RoadUser, duration: float) -> float:
    """Return a user's acceleration (m/s²) since `duration` s ago, on another lane what it is said to be: there a metre of
    SUMO's may be another, and with it the speed over ground."""
    return (user.speed - before.speed) / duration if user.lane_id == before.lane_id else user.acceleration


def _near(
    users: tuple[RoadUser, ...], x: float, y: float, boxes: Floats | None = None
) -> tuple[tuple[RoadUser, ...], Floats]:
    """Return who of `users` is near a place (m) and no stand-in, and their boxes (n, 6)."""
    if not users:
        return (), _NO_BOXES
    which, found = nearer(boxes_of(users) if boxes is None else boxes, x, y, JUDGED_REACH_M)
    near = tuple([users[k] for k in which.tolist()])
    if any(user.id.startswith(GHOST) for user in near):
        is_real = [not user.id.startswith(GHOST) for user in near]
        return tuple(compress(near, is_real)), found[is_real]
    return near, found
