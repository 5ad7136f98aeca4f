"""Curves sampled at even arc length, with heading and curvature: the shape of the nominal trajectory C."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class Curve:
    """A smooth curve sampled every `step` m; all arrays have shape (n,), n ≥ 2.

    `x`, `y` in m, `heading` in rad (unwrapped), `curvature` in 1/m, left turns positive. Arc length of sample i is
    i · step.
    """

    x: NDArray[np.float64]
    y: NDArray[np.float64]
    heading: NDArray[np.float64]
    curvature: NDArray[np.float64]
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
        return (
            float(self.x[i] + f * (self.x[i + 1] - self.x[i])),
            float(self.y[i] + f * (self.y[i + 1] - self.y[i])),
            float(self.heading[i] + f * (self.heading[i + 1] - self.heading[i])),
        )
