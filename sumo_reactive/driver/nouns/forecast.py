"""What the others will do if each keeps its behaviour constant, and where there is room beside C."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sumo_reactive.driver.nouns.plan import ParallelLane
from sumo_reactive.driver.nouns.snapshot import Neighbour
from sumo_reactive.driver.nouns.traffic import RoadUser

PATH_STEP_M = 2.0
"""Spacing of the points on another's foreseen path."""


class Forecast(NamedTuple):
    """One path for each way that a road user may take, k in all.

    `points` (n, 3): x, y (m), heading (rad) of all paths, `PATH_STEP_M` apart; path i holds `counts[i]` of them from
    `first[i]` on. `bodies` (k, 6): where the front bumper is on the path now (m), how far left of it (m), speed (m/s),
    length, width (m), speed limit there (m/s). `user_ids` names the user of each path.
    """

    user_ids: tuple[str, ...]
    points: NDArray[np.float64]
    first: NDArray[np.int64]
    counts: NDArray[np.int64]
    bodies: NDArray[np.float64]


class LaneBeside(NamedTuple):
    """Another lane runs beside C between arc lengths `start` and `end` (m), its centre `lateral` m to the left of C's lane.

    `is_oncoming`: its traffic comes towards the ego; `is_entry`: from nowhere, since no road leads to it. `width` in m,
    `speed_limit` in m/s.
    """

    lane_id: str
    start: float
    end: float
    lateral: float
    width: float
    speed_limit: float
    is_oncoming: bool
    is_entry: bool = False


class Queued(NamedTuple):
    """A road user before the ego, its front `ahead` m before the ego's. `yields`: it turns off by a way on which it has to
    let traffic from a road go first that the ego need not wait for."""

    user: RoadUser
    ahead: float
    yields: bool


class Queue(NamedTuple):
    """Who is before the ego on lane `lane_id` up to the end of the junction behind it, the farthest first.

    `speed_limit` (m/s) is the lane's. `way` leads there from the ego's lane (None: it is the ego's own); then `near` are
    those whom a change must leave a gap.
    """

    lane_id: str
    users: tuple[Queued, ...]
    way: ParallelLane | None = None
    near: tuple[Neighbour, ...] = ()
    speed_limit: float = math.inf


class Hindered(NamedTuple):
    """Somebody near a standing ego. `is_waiting`: he has been standing, too, for a while, and has not halted. `is_free`: he
    would not touch the ego where it stands if he went on."""

    user_id: str
    is_waiting: bool
    is_free: bool


class TurningGround(NamedTuple):
    """Who keeps the ego from a turn in several moves that it is about to begin: who `comes_over` its ground, and who `stays`
    where it ends (empty: nobody)."""

    comes_over: str = ""
    stays: str = ""


FREE_GROUND = TurningGround()
"""Nobody does."""


class Outlook(NamedTuple):
    """What the pilot asks perception for when an event has activated it.

    `forecast` of the others; `beside`: the lanes to which the ego might move aside; `lane_width` of its own (m);
    `sight` (m): how far ahead along C the oncoming traffic was looked at; `queues`: the one that the ego is in, and those on
    the lanes beside by which it could go as well, if there are such lanes and somebody slow is ahead. `ground`: that of the
    next turn in several moves. `hindered`: who is near and might wait for an ego that does not get on.
    """

    forecast: Forecast
    beside: tuple[LaneBeside, ...]
    lane_width: float
    sight: float
    queues: tuple[Queue, ...] = ()
    ground: TurningGround = FREE_GROUND
    hindered: tuple[Hindered, ...] = ()
