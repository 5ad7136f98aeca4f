"""The way that the ego drove, as a ruler: how far along and beside it others are, round bends and through junctions."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sumo_reactive.driver.compilation import kernel
from sumo_reactive.driver.geometry.polyline import Floats
from sumo_reactive.lab.metrics.moment import JUDGED_REACH_M

SPACING_M = 1.0
"""Between two points of the way."""

REACH_POINTS = int(1.2 * JUDGED_REACH_M / SPACING_M)
"""So many points before and behind the ego are looked at: who is judged is no farther, bends apart."""


class DrivenWay(NamedTuple):
    """Where the middle of the front bumper went, straight on before the start and behind the end.

    `points` (m, 2) stand SPACING_M apart; `nearest` (n,) is the one nearest to the ego's place at each step, `along` (n,)
    that place in m from the first point.
    """

    points: Floats
    nearest: NDArray[np.int64]
    along: Floats


def driven_way(x: Floats, y: Floats, heading: Floats) -> DrivenWay:
    """Return the way of an ego that was there (m, rad), a value a step, one or more."""
    lead = JUDGED_REACH_M
    along = lead + np.concatenate(([0.0], np.cumsum(np.hypot(np.diff(x), np.diff(y)))))
    moves = np.concatenate(([True], np.diff(along) > 0.0))
    places = np.concatenate(([0.0], along[moves], [along[-1] + lead]))
    even = np.arange(0.0, places[-1], SPACING_M)
    columns = (
        np.concatenate(([own[0] - lead * ahead[0]], own[moves], [own[-1] + lead * ahead[-1]]))
        for own, ahead in ((x, np.cos(heading)), (y, np.sin(heading)))
    )
    points: Floats = np.column_stack([np.interp(even, places, column) for column in columns])
    return DrivenWay(points, np.rint(along / SPACING_M).astype(np.int64), along)


@kernel
def along_way(points: Floats, index: NDArray[np.int64], boxes: Floats) -> Floats:
    """Return (n, 5): front and rear of each body along the way, the same beside it (m, left positive), its turn (rad).

    `boxes` (n, 6) holds front x, y, heading, speed, length, width, `index` (n,) the point of the way at which the ego was
    then: around it each is looked for. The turn is its heading less that of the way there, from −π to π.
    """
    out = np.empty((len(boxes), 5))
    for n in range(len(boxes)):
        x, y, heading, length = boxes[n, 0], boxes[n, 1], boxes[n, 2], boxes[n, 4]
        c, s = np.cos(heading), np.sin(heading)
        k = _nearest(points, index[n], x - 0.5 * length * c, y - 0.5 * length * s)
        out[n, 0], out[n, 2] = _beside(points, _descended(points, k, x, y), x, y)
        rear_x, rear_y = x - length * c, y - length * s
        out[n, 1], out[n, 3] = _beside(points, _descended(points, k, rear_x, rear_y), rear_x, rear_y)
        k = min(k, len(points) - 2)
        turn = heading - np.arctan2(points[k + 1, 1] - points[k, 1], points[k + 1, 0] - points[k, 0])
        out[n, 4] = (turn + np.pi) % (2.0 * np.pi) - np.pi
    return out


@kernel
def _nearest(points: Floats, index: int, x: float, y: float) -> int:
    """Return which point within reach of `index` is nearest."""
    first, last = max(index - REACH_POINTS, 0), min(index + REACH_POINTS, len(points) - 1)
    best, nearest = np.inf, first
    for k in range(first, last + 1):
        square = (points[k, 0] - x) ** 2 + (points[k, 1] - y) ** 2
        if square < best:
            best, nearest = square, k
    return nearest


@kernel
def _descended(points: Floats, k: int, x: float, y: float) -> int:
    """Return the point nearest to a place that is reached from the k-th without ever going away from it."""
    best = (points[k, 0] - x) ** 2 + (points[k, 1] - y) ** 2
    for step in (1, -1):
        while 0 <= k + step < len(points):
            square = (points[k + step, 0] - x) ** 2 + (points[k + step, 1] - y) ** 2
            if square >= best:
                break
            best, k = square, k + step
    return k


@kernel
def _beside(points: Floats, k: int, x: float, y: float) -> tuple[float, float]:
    """Return how far along the way and to its left a place is, by the side of the k-th point on which it lies, m."""
    k = min(k, len(points) - 2)
    for _ in range(2):
        ux, uy = points[k + 1, 0] - points[k, 0], points[k + 1, 1] - points[k, 1]
        size = max(np.hypot(ux, uy), 1e-9)
        dx, dy = x - points[k, 0], y - points[k, 1]
        ahead = (dx * ux + dy * uy) / size
        aside = (dy * ux - dx * uy) / size
        if ahead >= 0.0 or k == 0:
            break
        k -= 1
    return SPACING_M * k + ahead, aside
