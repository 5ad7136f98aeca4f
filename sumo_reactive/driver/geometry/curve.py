"""Curves sampled at even arc length, with heading and curvature: the shape of the nominal trajectory C."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from sumo_reactive.driver.compilation import kernel
from sumo_reactive.driver.geometry.polyline import BEYOND, Floats, foot

CURVE_STEP_M = 0.5
"""Arc length between samples of C."""

PROJECTION_WINDOW_M = 8.0
"""How far along C the ego is looked for around its last place: more than one second at 7 m/s, less than a loop."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Curve:
    """A smooth curve sampled every `step` m; all arrays have shape (n,), n ≥ 2.

    `x`, `y` in m, `heading` in rad (unwrapped), `curvature` in 1/m, left turns positive. Arc length of sample i is
    i · step.
    """

    x: Floats
    y: Floats
    heading: Floats
    curvature: Floats
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

    def sample_at(self, s: float) -> tuple[int, float]:
        """Return the sample before arc length `s`, clamped to the ends, and how far on to the next one that is, in steps."""
        u = min(max(s / self.step, 0.0), len(self.x) - 1.0)
        i = min(int(u), len(self.x) - 2)
        return i, u - i

    def at(self, s: float) -> tuple[float, float, float]:
        """Return (x, y, heading) at arc length `s`, interpolated, clamped to the ends."""
        i, f = self.sample_at(s)
        x, y = self.x.item(i), self.y.item(i)
        return x + f * (self.x.item(i + 1) - x), y + f * (self.y.item(i + 1) - y), self.heading_at(s)

    def heading_at(self, s: float) -> float:
        """Return the heading at arc length `s`, interpolated, clamped to the ends, rad."""
        i, f = self.sample_at(s)
        heading = self.heading.item(i)
        return heading + f * (self.heading.item(i + 1) - heading)


@kernel
def project_on_curve(
    x: float, y: float, cx: Floats, cy: Floats, step: float, s_guess: float, window: float
) -> tuple[float, float]:
    """Return (s, d): closest point of C within `window` m of `s_guess`, and the signed distance, left positive (m)."""
    first, last = max(0, int((s_guess - window) / step)), min(len(cx) - 2, int((s_guess + window) / step))
    if last < first:
        return s_guess, 0.0
    i, share, away = foot(cx, cy, x, y, first, last, BEYOND)
    return (i + share) * step, away


@kernel
def located(
    x: float, y: float, heading: float, wheelbase: float, cx: Floats, cy: Floats, step: float, s_before: float
) -> tuple[float, float]:
    """Return (s, d) of the front axle on C near `s_before` (m, left positive); the rear axle is at (x, y), m."""
    fx, fy = x + wheelbase * math.cos(heading), y + wheelbase * math.sin(heading)
    return project_on_curve(fx, fy, cx, cy, step, s_before, PROJECTION_WINDOW_M)


@kernel
def project_each(points: Floats, cx: Floats, cy: Floats, step: float, guesses: Floats, window: float) -> Floats:
    """Return the arc lengths (n,), m, of C closest to `points` (n, 2), each within `window` m of its guess."""
    found = np.empty(len(points))
    for k in range(len(points)):
        found[k], _ = project_on_curve(points[k, 0], points[k, 1], cx, cy, step, guesses[k], window)
    return found
