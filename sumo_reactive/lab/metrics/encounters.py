"""How near the ego comes to others: contacts, times to collision and after encroachment, hard braking caused."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from sumo_reactive.driver.geometry.polyline import Floats
from sumo_reactive.driver.nouns.traffic import RoadUser
from sumo_reactive.lab.fault import COLLISION, HARD_BRAKING, Fault
from sumo_reactive.lab.metrics.moment import Figures, Moment, is_oncoming


class Collisions:
    """Counts each contact once, from touch to parting; pedestrians count too."""

    def __init__(self) -> None:
        self.faults: list[Fault] = []
        self._touching: frozenset[str] = frozenset()

    def see(self, moment: Moment) -> None:
        """Note who touches the ego now and did not before."""
        for user_id in sorted(moment.touching - self._touching):
            self.faults.append(Fault(moment.step.time, COLLISION, user_id, moment.step.lane_id))
        self._touching = moment.touching

    def figures(self) -> Figures:
        """Return the number of collisions."""
        return {"collisions": len(self.faults)}


MOVING_SPEED = 0.1
"""m/s; a standing body enters and leaves nothing, and has no near miss of its own."""

NO_CONFLICT_S = 10.0
"""Longer times are no conflict."""

NEAR_BELOW_S = 1.5
"""A shorter time to collision or post-encroachment time is a near miss: SSAM's bound of the former (Gettman 2008)."""


class TimeToCollision:
    """min δ / ‖v − v_D‖: both bodies keep their velocities, δ is exact for their boxes (F&L 1991, §3.3.2).

    Straight extrapolation: cars that meet on a bend are on collision course for a moment without any danger.
    """

    def __init__(self) -> None:
        self._smallest = NO_CONFLICT_S
        self._when = math.nan
        self._near = set[str]()

    def see(self, moment: Moment) -> None:
        """Note the smallest time of this step, and with whom it is a near miss."""
        smallest = min(moment.times_to_collision, default=math.inf)
        if smallest < self._smallest:
            self._smallest, self._when = smallest, moment.step.time
        if smallest < NEAR_BELOW_S and moment.step.speed > MOVING_SPEED:
            counts = (np.array(moment.times_to_collision) < NEAR_BELOW_S) & ~is_oncoming(moment.boxes, moment.step.heading)
            self._near |= {user.id for user, is_near in zip(moment.users, counts, strict=True) if is_near}

    def figures(self) -> Figures:
        """Return the smallest time and when it was, None if nobody was on collision course; and how many near misses."""
        smallest, when = (None, None) if math.isnan(self._when) else (round(self._smallest, 3), round(self._when, 3))
        return {
            "min_time_to_collision_s": smallest,
            "min_time_to_collision_at_s": when,
            "near_misses_by_ttc": len(self._near),
        }


HARD_BRAKING_M_S2 = -4.6
"""m/s²; harder than SUMO's cars brake in comfort (4.5)."""

LEADER_REACH_M = 60.0
"""A leader farther ahead is not the cause."""


class HardBraking:
    """Counts vehicles that begin to brake below −4.6 m/s² while the ego is their leader.

    The leader is the nearest body ahead, within 60 m, that is on the same lane or in the straight corridor of the
    vehicle's width.
    """

    def __init__(self) -> None:
        self.faults: list[Fault] = []
        self._braking: set[str] = set()

    def see(self, moment: Moment) -> None:
        """Note who begins to brake hard behind the ego."""
        if moment.hardest_braking >= HARD_BRAKING_M_S2 and not self._braking:
            return
        braking = {name for name, acceleration in moment.slowing.items() if acceleration < HARD_BRAKING_M_S2}
        for user in moment.users:
            is_new = user.id in braking and user.id not in self._braking
            if is_new and not user.body.is_person and _follows_ego(user, moment):
                self.faults.append(Fault(moment.step.time, HARD_BRAKING, user.id, moment.step.lane_id))
        self._braking = braking

    def figures(self) -> Figures:
        """Return the number of vehicles that the ego made brake hard."""
        return {"hard_braking_caused": len(self.faults)}


def _follows_ego(user: RoadUser, moment: Moment) -> bool:
    step = moment.step
    gap = _gap(user, step.x, step.y, step.heading, (moment.length, moment.width), step.lane_id)
    return 0.0 <= gap < LEADER_REACH_M and all(not 0.0 <= other < gap for other in _gaps(user, moment))


def _gaps(user: RoadUser, moment: Moment) -> Iterator[float]:
    for other in moment.users:
        if other.id != user.id and not other.body.is_person:
            yield _gap(user, other.x, other.y, other.heading, (other.body.length, other.body.width), other.lane_id)


def _gap(user: RoadUser, x: float, y: float, heading: float, size: tuple[float, float], lane_id: str) -> float:
    """Return the way (m) from the front of `user` to the rear of a body, along its heading; infinite: not in its way."""
    (length, width), c, s = size, math.cos(user.heading), math.sin(user.heading)
    dx, dy = x - length * math.cos(heading) - user.x, y - length * math.sin(heading) - user.y
    ahead, aside = dx * c + dy * s, abs(dy * c - dx * s)
    on_the_way = aside < 0.5 * (user.body.width + width) or (bool(lane_id) and lane_id == user.lane_id)
    if not on_the_way or (x - user.x) * c + (y - user.y) * s <= 0.0:
        return math.inf
    return max(0.0, ahead)


NO_ENCOUNTER_S = 10.0
"""Longer times are no encounter."""

CELL_M = 0.5
"""Side of a cell; a cell is covered while its centre is."""

CROSSING_ANGLE = math.radians(20.0)
"""rad; bodies whose headings differ less follow one another: their time apart is a headway, no encroachment."""

FAR_CELL_M = 10.0
"""Side of the coarse cells that sort out who never came near the ego's way."""

CHUNK = 500_000
"""Cells looked at at a time: bounds the memory."""


class PostEncroachment:
    """PET, from when one leaves a cell of 0.5 m to when the other enters it with a crossing heading (s; Allen et al. 1978).

    Where the ego and the users near it were is kept, and laid on the grid at the end.
    """

    def __init__(self, length: float, width: float) -> None:
        self._size = (length, width)
        self._ego: list[tuple[float, ...]] = []
        self._others: list[tuple[float, Floats]] = []
        self._ids: list[tuple[str, ...]] = []

    def see(self, moment: Moment) -> None:
        """Keep the boxes."""
        step = moment.step
        if step.speed > MOVING_SPEED:
            self._ego.append((step.time, step.x, step.y, step.heading, *self._size, -1.0))
        if len(moment.boxes):
            self._others.append((step.time, moment.boxes))
            self._ids.append(tuple(user.id for user in moment.users))

    def figures(self) -> Figures:
        """Return the smallest time (s), None without an encounter; and the number of near misses."""
        smallest, near = NO_ENCOUNTER_S, 0
        if self._ego and self._others:
            ego, others = np.array(self._ego), _moving(self._others, self._ids)
            users, times = _apart(ego, others[_on_the_way(ego, others)])
            smallest, near = min(smallest, float(times.min(initial=math.inf))), len(np.unique(users[times < NEAR_BELOW_S]))
        least = round(smallest, 3) if smallest < NO_ENCOUNTER_S else None
        return {"min_post_encroachment_s": least, "near_misses_by_pet": near}


def _moving(boxes: list[tuple[float, Floats]], ids: list[tuple[str, ...]]) -> Floats:
    """Return (n, 7): time, front x, y, heading, length, width, number of the user of the moving among boxes by time."""
    times = np.repeat([time for time, _ in boxes], [len(some) for _, some in boxes])
    all_of_them = np.concatenate([some for _, some in boxes])
    numbers: dict[str, int] = {}
    users = [numbers.setdefault(name, len(numbers)) for names in ids for name in names]
    x, y, heading, speed, length, width = all_of_them.T
    rows: Floats = np.column_stack((times, x, y, heading, length, width, users))[speed > MOVING_SPEED]
    return rows


def _on_the_way(ego: Floats, others: Floats) -> NDArray[np.bool_]:
    """Return which of `others` (n, 7) come within a coarse cell of where the ego ever is with another heading."""
    around = [(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1)]
    keys = [_key(ego[:, 1] + i * FAR_CELL_M, ego[:, 2] + j * FAR_CELL_M, FAR_CELL_M) for i, j in around]
    cells, index = np.unique(np.concatenate(keys), return_inverse=True)
    sectors = np.zeros(len(cells), dtype=np.int64)
    np.bitwise_or.at(sectors, index.ravel(), np.tile(_sector(ego[:, 3]), len(around)))
    own, near = _sector(others[:, 3]), np.zeros(len(others), dtype=np.bool_)
    for share in (0.0, 0.5, 1.0):
        back = share * others[:, 4]
        key = _key(others[:, 1] - back * np.cos(others[:, 3]), others[:, 2] - back * np.sin(others[:, 3]), FAR_CELL_M)
        at = np.minimum(np.searchsorted(cells, key), len(cells) - 1)
        near |= (cells[at] == key) & ((sectors[at] & ~own) != 0)
    return near


def _sector(heading: Floats) -> NDArray[np.int64]:
    """Return the bit of the sector, as wide as CROSSING_ANGLE, that holds each heading (rad)."""
    return np.left_shift(1, np.floor(heading % (2.0 * math.pi) / CROSSING_ANGLE).astype(np.int64))


def _key(x: Floats, y: Floats, cell: float) -> NDArray[np.int64]:
    """Return one number for each cell of side `cell`."""
    return (np.floor(x / cell).astype(np.int64) << 32) + np.floor(y / cell).astype(np.int64)


def _apart(ego: Floats, others: Floats) -> tuple[Floats, Floats]:
    """Return users and times (s) between ego and each in one cell, in either order, with crossing headings."""
    cells, rows = _covered(np.vstack([ego, others]))
    boxes = np.vstack([ego, others])[rows]
    mine, theirs = cells[boxes[:, 6] < 0.0], cells[boxes[:, 6] >= 0.0]
    common = np.isin(cells, np.intersect1d(mine, theirs))
    cells, boxes = cells[common], boxes[common]
    order = np.lexsort((boxes[:, 0], cells))
    cells, boxes = cells[order], boxes[order]
    first, second = boxes[:-1], boxes[1:]
    meets = (cells[:-1] == cells[1:]) & ((first[:, 6] < 0.0) != (second[:, 6] < 0.0))
    turn = np.abs((first[:, 3] - second[:, 3] + math.pi) % (2.0 * math.pi) - math.pi)
    apart = meets & (turn > CROSSING_ANGLE)
    return np.maximum(first[:, 6], second[:, 6])[apart], (second[:, 0] - first[:, 0])[apart]


def _covered(boxes: Floats) -> tuple[NDArray[np.int64], NDArray[np.intp]]:
    """Return the cells that boxes (n, 7; the last column is −1 for the ego) cover, and the row of each."""
    keys, rows = [], []
    sizes, of_size = np.unique(boxes[:, 4:6], axis=0, return_inverse=True)
    for k, (length, width) in enumerate(sizes):
        of_this = np.flatnonzero(of_size.ravel() == k)
        at_a_time = max(CHUNK // (2 * _reach(length, width) + 1) ** 2, 1)
        for index in np.array_split(of_this, 1 + len(of_this) // at_a_time):
            key, covered = _cells(boxes[index], float(length), float(width))
            keys.append(key[covered])
            rows.append(np.broadcast_to(index[:, None], covered.shape)[covered])
    return np.concatenate(keys), np.concatenate(rows)


def _cells(boxes: Floats, length: float, width: float) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """Return the cells around each of `boxes` of one size, shape (n, m), and which of them it covers."""
    c, s = np.cos(boxes[:, 3])[:, None], np.sin(boxes[:, 3])[:, None]
    mx, my = boxes[:, 1:2] - 0.5 * length * c, boxes[:, 2:3] - 0.5 * length * s
    half = _reach(length, width)
    i, j = (grid.ravel() for grid in np.mgrid[-half : half + 1, -half : half + 1])
    x = (np.floor(mx / CELL_M) + i + 0.5) * CELL_M
    y = (np.floor(my / CELL_M) + j + 0.5) * CELL_M
    ahead, aside = (x - mx) * c + (y - my) * s, (y - my) * c - (x - mx) * s
    return _key(x, y, CELL_M), (np.abs(ahead) < 0.5 * length) & (np.abs(aside) < 0.5 * width)


def _reach(length: float, width: float) -> int:
    """Return how many cells the middle of a box may be from those that it covers."""
    return math.ceil(0.5 * math.hypot(length, width) / CELL_M)
