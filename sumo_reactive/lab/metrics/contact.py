"""The judges' own ruler: whether boxes overlap, and when they will, by separating axes. The driver measures otherwise."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from sumo_reactive.driver.compilation import kernel

Array = NDArray[np.float64]

SHRINK_M = 0.05
"""Boxes are this much smaller on each side in the contact test: positions and mirrors are no more exact."""

MIN_SIDE_M = 0.05
"""…but never smaller than this; a pedestrian is 0.2 m long."""

SAME_VELOCITY = 1e-6
"""m/s; bodies whose velocities differ less keep their distance."""


@kernel
def contacts(own: Array, boxes: Array) -> Array:
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
def _meeting(own: Array, other: Array) -> tuple[float, float]:
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
def _middle(box: Array, axis: int) -> float:
    """Return x (`axis` 0) or y (1) of the centre of a box, m."""
    along = math.cos(box[2]) if axis == 0 else math.sin(box[2])
    return float(box[axis] - 0.5 * box[4] * along)


@kernel
def _reach(box: Array, heading: float, shrink: float) -> float:
    """Return half the length (m) of the shadow of a box, `shrink` m smaller on each side, on an axis along `heading`."""
    turn = heading - box[2]
    length, width = max(box[4] - 2.0 * shrink, MIN_SIDE_M), max(box[5] - 2.0 * shrink, MIN_SIDE_M)
    return float(0.5 * (length * abs(math.cos(turn)) + width * abs(math.sin(turn))))
