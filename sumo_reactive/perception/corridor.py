"""Which bodies reach into the corridor that the ego will sweep along C."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from sumo_reactive.compilation import kernel

Array = NDArray[np.float64]


@kernel
def _cuts(px: float, py: float, heading: float, half: float, box: Array) -> bool:
    """Whether the cross-section of half-width `half` at a pose of C meets a box (front x, y, heading, -, length, width)."""
    c, s = math.cos(box[2]), math.sin(box[2])
    dx, dy = px - box[0] + 0.5 * box[4] * c, py - box[1] + 0.5 * box[4] * s
    tx, ty = math.cos(heading), math.sin(heading)
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
def near_boxes(boxes: Array, x: float, y: float, reach: float) -> Array:
    """Return those of `boxes` (n, 6: front x, y, …) that are nearer to (x, y) than `reach` in |Δx| + |Δy|, m."""
    out = np.empty_like(boxes)
    k = 0
    for i in range(len(boxes)):
        if abs(boxes[i, 0] - x) + abs(boxes[i, 1] - y) < reach:
            out[k] = boxes[i]
            k += 1
    return out[:k]


@kernel
def blocked_stretches(
    boxes: Array, cx: Array, cy: Array, ch: Array, step: float, start: float, end: float, half: float
) -> Array:
    """Return (n, 4): first and last arc length that each box blocks (m; NaN if none), velocity along and across C (m/s).

    `boxes` (n, 6): front x, y, heading, speed, length, width. The search runs from `start` to `end` along C and leaps
    where the body is far.
    """
    out = np.full((len(boxes), 4), np.nan)
    low = max(0, int(start / step))
    high = min(len(cx) - 1, int(end / step))
    for k in range(len(boxes)):
        box = boxes[k]
        mx, my = box[0] - 0.5 * box[4] * math.cos(box[2]), box[1] - 0.5 * box[4] * math.sin(box[2])
        radius = 0.5 * math.hypot(box[4], box[5]) + half
        i = low
        while i <= high:
            away = math.hypot(cx[i] - mx, cy[i] - my) - radius
            if away > step:
                i += int(away / step)
                continue
            if _cuts(cx[i], cy[i], ch[i], half, box):
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
