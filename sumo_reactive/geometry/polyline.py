"""Polylines measured by arc length."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Polyline:
    """An open chain of straight segments; `points` has shape (n, 2), n ≥ 2, in m."""

    points: Points

    def __post_init__(self) -> None:
        if self.points.ndim != 2 or self.points.shape[1] != 2 or len(self.points) < 2:
            raise ValueError(f"a polyline needs points of shape (n ≥ 2, 2), got {self.points.shape}")

    @cached_property
    def arc_lengths(self) -> NDArray[np.float64]:
        """Arc length at each point, shape (n,), m, starting at 0."""
        steps = np.hypot(*np.diff(self.points, axis=0).T)
        return np.concatenate(([0.0], np.cumsum(steps)))

    @property
    def length(self) -> float:
        """Total arc length, m."""
        return float(self.arc_lengths[-1])

    def at(self, s: float) -> tuple[float, float]:
        """Return the point (x, y) at arc length `s`, clamped to the ends."""
        return (
            float(np.interp(s, self.arc_lengths, self.points[:, 0])),
            float(np.interp(s, self.arc_lengths, self.points[:, 1])),
        )

    def heading_at(self, s: float) -> float:
        """Return the direction of travel (rad) of the segment that holds arc length `s`."""
        last = len(self.points) - 2
        i = int(np.clip(np.searchsorted(self.arc_lengths, s, side="right") - 1, 0, last))
        while i > 0 and self.arc_lengths[i + 1] == self.arc_lengths[i]:
            i -= 1
        dx, dy = self.points[i + 1] - self.points[i]
        return math.atan2(dy, dx)

    def project(self, x: float, y: float) -> tuple[float, float]:
        """Return (s, d) of the closest point: arc length and signed distance, left positive, m."""
        a, b = self.points[:-1], self.points[1:]
        step = b - a
        squared = np.maximum((step**2).sum(axis=1), 1e-12)
        t = np.clip((((x, y) - a) * step).sum(axis=1) / squared, 0.0, 1.0)
        foot = a + t[:, None] * step
        away = (x, y) - foot
        i = int(np.argmin((away**2).sum(axis=1)))
        side = step[i, 0] * away[i, 1] - step[i, 1] * away[i, 0]
        s = self.arc_lengths[i] + t[i] * math.sqrt(squared[i])
        return float(s), math.copysign(math.hypot(*away[i]), side)


def eased(share: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return 10t³ − 15t⁴ + 6t⁵: from 0 to 1 with no slope and no bend at either end, for `share` t in [0, 1]."""
    return share**3 * (10.0 - 15.0 * share + 6.0 * share**2)


def moved_aside(line: Points, lateral: NDArray[np.float64]) -> Points:
    """Return `line` (n, 2) moved to its left by `lateral` (n,), m."""
    along = np.gradient(line, axis=0)
    along /= np.maximum(np.hypot(*along.T), 1e-9)[:, None]
    return np.asarray(line + lateral[:, None] * np.column_stack([-along[:, 1], along[:, 0]]))


def joined(parts: list[Points]) -> Points:
    """Chain point arrays into one, dropping a repeated point where two parts meet."""
    kept = [parts[0]]
    for part in parts[1:]:
        meets = np.hypot(*(part[0] - kept[-1][-1])) < 1e-3
        kept.append(part[1:] if meets and len(part) > 1 else part)
    return np.vstack(kept)


def cut(line: Polyline, start: float, end: float) -> Points:
    """Return the part of `line` between two arc lengths, shape (n ≥ 2, 2), prolonged straight where they lie outside."""
    arc, points = line.arc_lengths, line.points
    inner = points[(arc > start + 1e-6) & (arc < end - 1e-6)]
    return np.vstack([_point(line, start), inner, _point(line, end)])


def _point(line: Polyline, s: float) -> Points:
    """Return the point (2,) at arc length `s`, straight on beyond the ends."""
    outside = s - min(max(s, 0.0), line.length)
    point = np.array(line.at(s))
    if outside == 0.0:
        return point
    heading = line.heading_at(s)
    return np.asarray(point + outside * np.array([np.cos(heading), np.sin(heading)]))
