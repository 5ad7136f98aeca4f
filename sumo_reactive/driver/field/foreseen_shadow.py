"""U₂ from the foreseen motion: whom the ego will pass too near, and on which side (F&L 1991, §3.3.2)."""

from __future__ import annotations

import math

import numpy as np

from sumo_reactive.driver.compilation import kernel
from sumo_reactive.driver.geometry.polyline import Floats, wrapped
from sumo_reactive.driver.nouns.snapshot import NEAR_M

BEHIND_M = 10.0
"""Bodies so far behind the ego's rear may still come up beside it."""

ACROSS = 0.5
"""Who drives across C by more than the sine of 30° is no matter of passing: the regions decide."""

DRIFT_S = 1.5
"""Who moves aside is taken to go on so for no longer than this."""

LEAST_WAY_M = 5.0
"""δ is lengthened by this, so that U₂ does not leap beside a body, and is small where the ego creeps past…"""

LEAST_S = 0.7
"""…nor a time to collision below this: an oncoming car counts no more than one that stands."""

LATEST_S = 5.0
"""Who is passed later than this casts nothing yet."""

FADES_M = 5.0
FADES_S = 0.8
"""Over the last metres, or seconds, before who is passed is behind the ego it asks for ever less room beside him: it returns
to C smoothly, its front first."""

IN_THE_WAY_M = 0.3
"""Nearer than this beside the way along C, a body is ever less a matter of leaning; who is in it is in R_D wherever in its
lane the ego drives, and v_d's matter."""

HIT_M = -1.0
"""Clearance of who is in the way: no lean makes it positive."""

BESIDE_M = 0.6
"""The ego leans no nearer than this to somebody on the other side…"""

SIDE_S = 2.0
"""…who is beside it within this time."""


@kernel
def _nearest(x: float, y: float, cx: Floats, cy: Floats, low: int, high: int, step: float, radius: float) -> int:
    """Return the sample of C from `low` to `high` nearest to a point, leaping where it is farther than `radius` m; −1: none
    is nearer than that."""
    found, least, i = -1, radius, low
    while i <= high:
        away = math.hypot(cx[i] - x, cy[i] - y)
        if away < least:
            found, least = i, away
        elif found >= 0 and away > radius:
            break
        i += max(int((away - radius) / step), 1)
    return found


@kernel
def _extent(box: Floats, angle: float, along: float, left: float, bend: float) -> tuple[float, float]:
    """Return how far (m, left positive) a box beside C reaches to the right and to the left.

    Its centre is `left` m beside and `along` m ahead of a sample of C, where C bends by `bend` (1/m); the box is turned by
    `angle` (rad) against C.
    """
    c, s = math.cos(angle), math.sin(angle)
    low, high = np.inf, -np.inf
    for end in (-0.5, 0.0, 0.5):
        for side in (-0.5, 0.5):
            x = along + end * box[4] * c - side * box[5] * s
            y = left + end * box[4] * s + side * box[5] * c - 0.5 * bend * x * x
            low, high = min(low, y), max(high, y)
    return low, high


@kernel
def foreseen_shadows(
    boxes: Floats, speed: float, half: float, ahead: float, behind: float, cx: Floats, cy: Floats, ch: Floats, step: float,
    s: float, room: Floats, scale: float, clearance: float,
) -> Floats:  # fmt: skip
    """Return (n, 3): side (+1 left, −1 right), clearance on C (m) and weight of each body that the ego passes.

    R_D follows the foreseen motion: M drives along C, D keeps its speed along C and what it moves aside, so that who keeps
    to a lane beside it stays beside in a bend. The weight is that of U_D, k₀‖v − v_D‖/δ, k₀ the
    `scale`, s. M's body reaches `ahead` and `behind` m of its front axle, at `s` of C, and `half` m to both sides. `room`
    (2), m, how far M may lean to the left and right, is made smaller where somebody is beside; `clearance` (m) is what it
    likes to have there. `boxes` (n, 6 or more).
    """
    out, n = np.empty((len(boxes), 3)), 0
    low = max(int((s - behind - BEHIND_M) / step), 0)
    high = min(int((s + ahead + NEAR_M) / step), len(cx) - 2)
    for k in range(len(boxes)):
        box = boxes[k]
        c, w = math.cos(box[2]), math.sin(box[2])
        mx, my = box[0] - 0.5 * box[4] * c, box[1] - 0.5 * box[4] * w
        i = _nearest(mx, my, cx, cy, low, high, step, 0.5 * (box[4] + box[5]) + half + clearance)
        if i < 0:
            continue
        tc, ts = math.cos(ch[i]), math.sin(ch[i])
        along, left = (mx - cx[i]) * tc + (my - cy[i]) * ts, (my - cy[i]) * tc - (mx - cx[i]) * ts
        angle = wrapped(box[2] - ch[i])
        across = math.sin(angle)
        if abs(across) > ACROSS and box[3] > 0.0:
            continue
        bend = wrapped(ch[i + 1] - ch[i]) / step
        right_end, left_end = _extent(box, angle, along, left, bend)
        reach = 0.5 * (box[4] * abs(math.cos(angle)) + box[5] * abs(across))
        gap, beside = i * step + along - reach - s - ahead, i * step + along + reach - s + behind
        closing = speed - box[3] * math.cos(angle)
        aside = box[3] * across * min(max(gap, 0.0) / max(closing, 0.1), DRIFT_S)
        side = 1.0 if right_end + left_end > 0.0 else -1.0
        near = side * (right_end if side > 0.0 else left_end) - half
        if near > 0.0 and gap < max(closing, 0.0) * SIDE_S and beside > min(closing, 0.0) * SIDE_S:
            j = 0 if side > 0.0 else 1
            room[j] = min(room[j], max(near - BESIDE_M, 0.0))
        clear = near + side * aside
        after = max((max(gap, 0.0) + LEAST_WAY_M) / max(closing, 1e-3), LEAST_S)
        weight = 1.0 / after - 1.0 / LATEST_S
        if weight <= 0.0 or beside <= 0.0 or clear >= clearance:
            continue
        left_over = min(beside / max(FADES_M, FADES_S * closing), 1.0)
        out[n, 0], out[n, 2] = side, scale * weight
        if clear > 0.0:
            out[n, 1] = clearance - left_over * (clearance - clear)
            out[n, 2] *= min(clear / IN_THE_WAY_M, 1.0)
        else:
            out[n, 1] = HIT_M
        n += 1
    return out[:n]


@kernel
def foreseen_potential(shadows: Floats, d: float, room: Floats, clearance: float) -> float:
    """U₂ = Σ_D U_D of an ego `d` m to the left of C, by the share of R_D, widened by the `clearance`
    (m), in which D is.

    It falls to nothing where every body of `shadows` (n, 3) is passed with that clearance; beyond the `room` (2), m, that
    the ego may take nothing is gained.
    """
    total = 0.0
    for k in range(len(shadows)):
        lean = max(d, -room[1]) if shadows[k, 0] > 0.0 else -min(d, room[0])  # towards the body
        missing = 1.0 - max(shadows[k, 1] - lean, 0.0) / clearance
        if missing > 0.0:
            total += shadows[k, 2] * missing * missing
    return total
