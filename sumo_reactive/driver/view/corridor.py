"""Which bodies reach into the corridor that the ego will sweep along C."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d

from sumo_reactive.driver.caching import kept
from sumo_reactive.driver.compilation import kernel
from sumo_reactive.driver.geometry.curve import Curve
from sumo_reactive.driver.geometry.swept import off_tracking
from sumo_reactive.driver.parameters import CORRIDOR_MARGIN_M, NEAR_M, PLANS_KEPT, STANDING_SPEED, TURN_FORESEEN_S
from sumo_reactive.driver.vehicle.limits import VehicleLimits

Array = NDArray[np.float64]

SPEED_GAINED = 2.0
"""m/s; no command adds more to the ego's speed."""

WIDTHS_M = 5.0
"""m; no two bodies are wider together."""

BEHIND_SHARE = 0.5
"""Who is behind the rear axle by this share of the way to him stays behind the ego's middle, however it steers."""


class Band(NamedTuple):
    """How far the corridor reaches to the left and right of C at each sample (n,), and the farthest of all, m."""

    left: Array
    right: Array
    widest: float


def band_of(curve: Curve, limits: VehicleLimits) -> Band:
    """Return the corridor that the body sweeps while the front axle follows C.

    In a bend the rear axle cuts the inside and the front bumper swings to the outside.
    """
    return band_along(curve, limits.width, limits.wheelbase, limits.front_overhang)


@kept(PLANS_KEPT)
def band_along(curve: Curve, width: float, wheelbase: float, overhang: float) -> Band:
    """Return the corridor of a body of that `width`, `wheelbase` and front `overhang` (m)."""
    half = 0.5 * width
    bend = float(curve.curvature[: int(wheelbase / curve.step) + 1].mean())
    angle = math.asin(min(max(bend * wheelbase, -0.9), 0.9))  # as in a steady turn
    heading = float(curve.heading[0]) - angle
    sides = off_tracking(curve.x, curve.y, curve.heading, curve.step, heading, wheelbase, overhang)
    reach = np.maximum(np.max(sides, axis=0), CORRIDOR_MARGIN_M), np.maximum(-np.min(sides, axis=0), CORRIDOR_MARGIN_M)
    left, right = (half + maximum_filter1d(side, 3) for side in reach)  # between two samples it is as wide as at the wider
    return Band(left, right, float(max(left.max(), right.max())))


@kernel
def _cuts(px: float, py: float, tx: float, ty: float, half: float, box: Array, c: float, s: float) -> bool:
    """Whether the cross-section of half-width `half` at a place of C meets a box (front x, y, heading, -, length, width).

    C runs along (tx, ty) there, the box along (c, s).
    """
    dx, dy = px - box[0] + 0.5 * box[4] * c, py - box[1] + 0.5 * box[4] * s
    turn_c, turn_s = abs(tx * c + ty * s), abs(ty * c - tx * s)
    if abs(dx * c + dy * s) > 0.5 * box[4] + half * turn_s:
        return False
    if abs(dy * c - dx * s) > 0.5 * box[5] + half * turn_c:
        return False
    return bool(abs(dx * tx + dy * ty) <= 0.5 * (box[4] * turn_c + box[5] * turn_s))


@kernel
def _first_touch(px: float, py: float, heading: float, box: Array) -> float:
    """Least arc length, relative to a pose of C, at which a corner of the box lies (m)."""
    c, s = math.cos(box[2]), math.sin(box[2])
    tx, ty = math.cos(heading), math.sin(heading)
    middle = (box[0] - 0.5 * box[4] * c - px) * tx + (box[1] - 0.5 * box[4] * s - py) * ty
    return float(middle - 0.5 * (box[4] * abs(tx * c + ty * s) + box[5] * abs(ty * c - tx * s)))


@kernel
def near_boxes(
    boxes: Array, x: float, y: float, heading: float, speed: float, length: float
) -> tuple[Array, NDArray[np.int64]]:
    """Return those of `boxes` (n, 6) that are nearer than NEAR_M in |Δx| + |Δy|, (m, 8): with no turn rate and no end of
    their way; and which of them move and could touch an ego of `length` m within the time that turning is foreseen, (k, 2):
    their rows there and in `boxes`.

    The ego's rear axle is at (x, y), m. Who is behind it cannot: he has to look out himself.
    """
    c, s = math.cos(heading), math.sin(heading)
    own = length + (speed + SPEED_GAINED) * TURN_FORESEEN_S + WIDTHS_M
    near, touchable = np.zeros((len(boxes), 8)), np.empty((len(boxes), 2), dtype=np.int64)
    m = k = 0
    for i in range(len(boxes)):
        dx, dy = boxes[i, 0] - x, boxes[i, 1] - y
        away, reach = abs(dx) + abs(dy), own + boxes[i, 4] + boxes[i, 3] * TURN_FORESEEN_S
        if not away < NEAR_M:
            continue
        near[m, :6], near[m, 7] = boxes[i, :6], np.inf
        ahead = dx * c + dy * s > -BEHIND_SHARE * away
        if ahead and boxes[i, 3] > STANDING_SPEED and dx * dx + dy * dy < reach * reach:
            touchable[k, 0], touchable[k, 1] = m, i
            k += 1
        m += 1
    return near[:m], touchable[:k]


@kernel
def blocked_stretches(
    boxes: Array, cx: Array, cy: Array, ch: Array, step: float, start: float, end: float, left: Array,
    right: Array, widest: float,
) -> Array:  # fmt: skip
    """Return (n, 4): first and last arc length that each box blocks (m; NaN if none), velocity along and across C (m/s).

    `boxes` (n, 6): front x, y, heading, speed, length, width. The search runs from `start` to `end` along C and leaps
    where the body is far. The corridor reaches `left` and `right` (m) of each sample, at most `widest`.
    """
    out = np.full((len(boxes), 4), np.nan)
    low = max(0, int(start / step))
    high = min(len(cx) - 1, int(end / step))
    for k in range(len(boxes)):
        box = boxes[k]
        c, s = math.cos(box[2]), math.sin(box[2])
        mx, my = box[0] - 0.5 * box[4] * c, box[1] - 0.5 * box[4] * s
        radius = 0.5 * math.hypot(box[4], box[5]) + widest
        i = low
        while i <= high:
            dx, dy = cx[i] - mx, cy[i] - my
            away = math.sqrt(dx * dx + dy * dy) - radius
            if away > step:
                i += int(away / step)
                continue
            half, shift = 0.5 * (left[i] + right[i]), 0.5 * (left[i] - right[i])
            tx, ty = math.cos(ch[i]), math.sin(ch[i])
            if _cuts(cx[i] - shift * ty, cy[i] + shift * tx, tx, ty, half, box, c, s):
                if np.isnan(out[k, 0]):
                    touch = min(max(_first_touch(cx[i], cy[i], ch[i], box), -step), 0.0)
                    out[k, 0] = i * step + (touch if i > low else 0.0)
                    out[k, 2] = box[3] * math.cos(box[2] - ch[i])
                    out[k, 3] = box[3] * math.sin(box[2] - ch[i])
                out[k, 1] = i * step
            elif not np.isnan(out[k, 0]):
                break
            i += 1
    return out


@kernel
def blocking_ones(
    boxes: Array, cx: Array, cy: Array, ch: Array, step: float, start: float, end: float, left: Array,
    right: Array, widest: float,
) -> tuple[NDArray[np.int64], Array]:  # fmt: skip
    """Return which of `boxes` block a stretch (m,), and their rows of `blocked_stretches` (m, 4)."""
    stretches = blocked_stretches(boxes, cx, cy, ch, step, start, end, left, right, widest)
    blocking = np.flatnonzero(~np.isnan(stretches[:, 0]))
    return blocking, stretches[blocking]
