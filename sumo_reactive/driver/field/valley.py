"""U₁, the trajectory valley (F&L 1991, §3.3.1), with exact distances."""

from __future__ import annotations

import math

import numpy as np

from sumo_reactive.driver.compilation import kernel
from sumo_reactive.driver.geometry.polyline import Floats

LEAST_ROOM_M = 0.2
"""d₁ to O_S is not taken below this: nearer, U₁ is steep enough."""

STEPS_TO_BESIDE = 6
"""The place of C beside a point is found by so many steps along C: two on a straight road, more in a turn."""


@kernel
def least_to_static(
    static: Floats, cx: Floats, cy: Floats, ch: Floats, step: float, s: float, half: float, ahead: float, behind: float
) -> tuple[float, float]:
    """Return min over o of d₁ from the body to the points of O_S left and right of C, m; infinite where there is none.

    The taxicab distance is taken along and across C: the body, its front axle at `s` of C, reaches from `behind` to `ahead`
    m of it and `half` m to both sides. `static` (n, 2).
    """
    left = right = np.inf
    for k in range(len(static)):
        at = s
        for _ in range(STEPS_TO_BESIDE):  # along a bend the tangent at F misses the place beside; the one there does not
            i = min(max(int(at / step), 0), len(cx) - 1)
            c, w = math.cos(ch[i]), math.sin(ch[i])
            dx, dy = static[k, 0] - cx[i], static[k, 1] - cy[i]
            before, at = at, i * step + dx * c + dy * w
            if abs(at - before) < step:
                break
        aside = dy * c - dx * w
        along = max(at - s - ahead, s - behind - at, 0.0)
        if aside > 0.0:
            left = min(left, along + aside - half)
        else:
            right = min(right, along - aside - half)
    return left, right


@kernel
def valley_potential(distance: float, to_static: float, attraction: float, repulsion: float) -> float:
    """U_p = α·d₁(p, C) + β·d₁(p, C) / min_o d₁(p, o) (F&L 1991, §3.3.1).

    The repulsion is scaled by the distance to C, so the valley floor stays on C even beside an obstacle. α in 1/m,
    β dimensionless.
    """
    return attraction * distance + repulsion * distance / max(to_static, LEAST_ROOM_M)
