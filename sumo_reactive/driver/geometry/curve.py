"""Curves sampled at even arc length, with heading and curvature: the shape of the nominal trajectory C."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sumo_reactive.driver.compilation import kernel

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Curve:
    """A smooth curve sampled every `step` m; all arrays have shape (n,), n ≥ 2.

    `x`, `y` in m, `heading` in rad (unwrapped), `curvature` in 1/m, left turns positive. Arc length of sample i is
    i · step.
    """

    x: Array
    y: Array
    heading: Array
    curvature: Array
    step: float

    def __post_init__(self) -> None:
        if len(self.x) < 2 or self.step <= 0.0:
            raise ValueError("a curve needs at least two samples and a positive step")
        if not len(self.x) == len(self.y) == len(self.heading) == len(self.curvature):
            raise ValueError("the arrays of a curve have one length")

    @property
    def length(self) -> float:
        """Arc length from the first to the last sample, m."""
        return (len(self.x) - 1) * self.step

    def at(self, s: float) -> tuple[float, float, float]:
        """Return (x, y, heading) at arc length `s`, interpolated, clamped to the ends."""
        u = min(max(s / self.step, 0.0), len(self.x) - 1.0)
        i = min(int(u), len(self.x) - 2)
        f = u - i
        x, y, heading = self.x.item(i), self.y.item(i), self.heading.item(i)
        return (
            x + f * (self.x.item(i + 1) - x),
            y + f * (self.y.item(i + 1) - y),
            heading + f * (self.heading.item(i + 1) - heading),
        )

    def heading_at(self, s: float) -> float:
        """Return the heading at arc length `s`, interpolated, clamped to the ends, rad."""
        u = min(max(s / self.step, 0.0), len(self.heading) - 1.0)
        i = min(int(u), len(self.heading) - 2)
        heading = self.heading.item(i)
        return heading + (u - i) * (self.heading.item(i + 1) - heading)


@kernel
def project_on_curve(
    x: float, y: float, cx: Array, cy: Array, step: float, s_guess: float, window: float
) -> tuple[float, float]:
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
