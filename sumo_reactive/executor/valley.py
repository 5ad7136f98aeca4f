"""U₁, the trajectory valley (F&L 1991, §3.3.1), with exact distances."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from sumo_reactive.compilation import kernel

Array = NDArray[np.float64]


@kernel
def project_on_curve(x: float, y: float, cx: Array, cy: Array, step: float, s_guess: float, window: float) -> tuple[float, float]:
    """Return (s, d): closest point of C within `window` m of `s_guess`, and the signed distance, left positive (m)."""
    first = max(0, int((s_guess - window) / step))
    last = min(len(cx) - 2, int((s_guess + window) / step))
    best = 1e18
    s = s_guess
    d = 0.0
    for i in range(first, last + 1):
        ex, ey = cx[i + 1] - cx[i], cy[i + 1] - cy[i]
        px, py = x - cx[i], y - cy[i]
        squared = ex * ex + ey * ey
        t = (px * ex + py * ey) / squared
        low = -1e9 if i == 0 else 0.0
        high = 1e9 if i == len(cx) - 2 else 1.0
        t = min(max(t, low), high)
        dx, dy = px - t * ex, py - t * ey
        away = dx * dx + dy * dy
        if away < best:
            best = away
            s = (i + t) * step
            d = math.copysign(math.sqrt(away), ex * py - ey * px)
    return s, d


@kernel
def taxicab_to_points(x: float, y: float, points: Array) -> float:
    """Return min over o of |x − x_o| + |y − y_o| for `points` (n, 2); infinite when there are none (m)."""
    nearest = np.inf
    for i in range(len(points)):
        away = abs(points[i, 0] - x) + abs(points[i, 1] - y)
        if away < nearest:
            nearest = away
    return nearest


@kernel
def valley_potential(distance: float, to_static: float, attraction: float, repulsion: float) -> float:
    """U_p = α·d₁(p, C) + β·d₁(p, C) / min_o d₁(p, o) (F&L 1991, §3.3.1).

    The repulsion is scaled by the distance to C, so the valley floor stays on C even beside an obstacle. α in 1/m,
    β dimensionless.
    """
    return attraction * distance + repulsion * distance / max(to_static, 1e-3)
