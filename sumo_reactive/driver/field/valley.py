"""U₁, the trajectory valley (F&L 1991, §3.3.1), with exact distances."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sumo_reactive.driver.compilation import kernel

Array = NDArray[np.float64]


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
