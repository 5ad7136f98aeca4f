"""Polylines measured by arc length, and angles."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sumo_reactive.driver.compilation import kernel

Floats = NDArray[np.float64]
Points = NDArray[np.float64]


BEYOND = 1e6
"""The ends of a chain are prolonged by so many times their length: without end."""


@dataclass(frozen=True, eq=False)
class Polyline:
    """An open chain of straight segments; `points` has shape (n, 2), n ≥ 2, in m."""

    points: Points

    def __post_init__(self) -> None:
        if self.points.ndim != 2 or self.points.shape[1] != 2 or len(self.points) < 2:
            raise ValueError(f"a polyline needs points of shape (n ≥ 2, 2), got {self.points.shape}")

    @cached_property
    def arc_lengths(self) -> Floats:
        """Arc length at each point, shape (n,), m, starting at 0."""
        steps = np.hypot(*np.diff(self.points, axis=0).T)
        return np.concatenate(([0.0], np.cumsum(steps)))

    @cached_property
    def length(self) -> float:
        """Total arc length, m."""
        return float(self.arc_lengths[-1])

    def at(self, s: float) -> tuple[float, float]:
        """Return the point (x, y) at arc length `s`, clamped to the ends."""
        return _at(*self.columns, self.arc_lengths, float(s))

    def heading_at(self, s: float) -> float:
        """Return the direction of travel (rad) of the segment that holds arc length `s`."""
        return _heading_at(*self.columns, self.arc_lengths, float(s))

    @cached_property
    def columns(self) -> tuple[Floats, Floats]:
        """All x and all y of the points, shape (n,) each, m, as compiled code likes them."""
        return np.ascontiguousarray(self.points[:, 0]), np.ascontiguousarray(self.points[:, 1])

    def points_at(self, s: Floats) -> Points:
        """Return the points (n, 2) at arc lengths `s` (n,), clamped to the ends, m."""
        return np.column_stack([np.interp(s, self.arc_lengths, column) for column in self.columns])

    def project(self, x: float, y: float) -> tuple[float, float]:
        """Return (s, d) of the closest point: arc length and signed distance, left positive, m."""
        return _place(*self.columns, self.arc_lengths, x, y, 0.0)

    def offset(self, x: float, y: float) -> float:
        """Return how far left of the polyline, prolonged straight at its ends, a place is, m."""
        return _place(*self.columns, self.arc_lengths, x, y, BEYOND)[1]

    def arc_lengths_at(self, places: Points) -> Floats:
        """Return the arc length (n,), m, of the closest point to each of `places` (n, 2), m."""
        return _places(*self.columns, self.arc_lengths, np.ascontiguousarray(places), 0.0)[:, 0]

    def offsets(self, places: Points) -> Floats:
        """Return how far left of the polyline, prolonged straight at its ends, each of `places` (n, 2) is, (n,), m."""
        return _places(*self.columns, self.arc_lengths, np.ascontiguousarray(places), BEYOND)[:, 1]

    def sampled(self, step: float) -> Floats:
        """Return x, y (m) and heading (rad, unwrapped) every `step` m up to the first sample beyond the end, (n ≥ 2, 3)."""
        return _sampled(np.ascontiguousarray(self.points), self.arc_lengths, step)


@kernel
def foot(
    xs: Floats, ys: Floats, x: float, y: float, first: int, last: int, beyond: float
) -> tuple[int, float, float]:
    """Return where (x, y) is nearest to the chain through `xs`, `ys` (n,), m, on its segments `first` to `last`: segment,
    share of it and signed distance (m, left positive).

    The chain's first and last segment are prolonged by `beyond` times their length.
    """
    best, segment, share, away = math.inf, first, 0.0, 0.0
    for i in range(first, last + 1):
        ex, ey = xs[i + 1] - xs[i], ys[i + 1] - ys[i]
        px, py = x - xs[i], y - ys[i]
        low, high = -beyond if i == 0 else 0.0, 1.0 + beyond if i == len(xs) - 2 else 1.0
        t = min(max((px * ex + py * ey) / max(ex * ex + ey * ey, 1e-12), low), high)
        dx, dy = px - t * ex, py - t * ey
        squared = dx * dx + dy * dy
        if squared < best:
            best, segment, share, away = squared, i, t, math.copysign(math.sqrt(squared), ex * dy - ey * dx)
    return segment, share, away


@kernel
def nearest_point(xs: Floats, ys: Floats, x: float, y: float, first: int, last: int) -> int:
    """Return which of the points `xs`, `ys` (n,), from index `first` to `last`, is nearest to (x, y), m."""
    nearest, least = first, math.inf
    for i in range(first, last + 1):
        squared = (xs[i] - x) ** 2 + (ys[i] - y) ** 2
        if squared < least:
            nearest, least = i, squared
    return nearest


@kernel
def _segment(arc: Floats, s: float) -> int:
    """Return the segment that holds arc length `s`, m; past the ends, the one there."""
    behind = int(np.searchsorted(arc, s, side="right"))
    return min(max(behind - 1, 0), len(arc) - 2)


@kernel
def _at(xs: Floats, ys: Floats, arc: Floats, s: float) -> tuple[float, float]:
    i = _segment(arc, s)
    inside, length = min(max(s - arc[i], 0.0), arc[i + 1] - arc[i]), arc[i + 1] - arc[i]
    if inside == length:
        return xs[i + 1], ys[i + 1]
    return (xs[i + 1] - xs[i]) / length * inside + xs[i], (ys[i + 1] - ys[i]) / length * inside + ys[i]


@kernel
def _heading_at(xs: Floats, ys: Floats, arc: Floats, s: float) -> float:
    i = _segment(arc, s)
    while i > 0 and arc[i + 1] == arc[i]:
        i -= 1
    return math.atan2(ys[i + 1] - ys[i], xs[i + 1] - xs[i])


@kernel
def _place(
    xs: Floats, ys: Floats, arc: Floats, x: float, y: float, beyond: float
) -> tuple[float, float]:
    i, share, away = foot(xs, ys, x, y, 0, len(xs) - 2, beyond)
    return arc[i] + share * math.sqrt(max((xs[i + 1] - xs[i]) ** 2 + (ys[i + 1] - ys[i]) ** 2, 1e-12)), away


@kernel
def _places(
    xs: Floats, ys: Floats, arc: Floats, places: Points, beyond: float
) -> Points:
    found = np.empty((len(places), 2))
    for k in range(len(places)):
        found[k, 0], found[k, 1] = _place(xs, ys, arc, places[k, 0], places[k, 1], beyond)
    return found


@kernel
def _sampled(points: Points, arc_lengths: Floats, step: float) -> Floats:
    last = len(points) - 1
    n = max(math.ceil((arc_lengths[last] + step) / step - 1e-9), 2)
    out = np.empty((n, 3))
    i = 0
    for k in range(n):
        s = min(k * step, arc_lengths[last])
        while i < last - 1 and arc_lengths[i + 1] < s:
            i += 1
        t = (s - arc_lengths[i]) / max(arc_lengths[i + 1] - arc_lengths[i], 1e-12)
        out[k, 0] = points[i, 0] + t * (points[i + 1, 0] - points[i, 0])
        out[k, 1] = points[i, 1] + t * (points[i + 1, 1] - points[i, 1])
    for k in range(n):
        a, b = max(k - 1, 0), min(k + 1, n - 1)
        heading = math.atan2(out[b, 1] - out[a, 1], out[b, 0] - out[a, 0])
        if k > 0:
            heading -= 2.0 * math.pi * math.floor((heading - out[k - 1, 2]) / (2.0 * math.pi) + 0.5)
        out[k, 2] = heading
    return out


def eased(share: Floats) -> Floats:
    """Return 10t³ − 15t⁴ + 6t⁵: from 0 to 1 with no slope and no bend at either end, for `share` t in [0, 1]."""
    return share**3 * (10.0 - 15.0 * share + 6.0 * share**2)


def moved_aside(line: Points, lateral: Floats) -> Points:
    """Return `line` (n, 2) moved to its left by `lateral` (n,), m."""
    along = np.gradient(line, axis=0)
    along /= np.maximum(np.hypot(*along.T), 1e-9)[:, None]
    return np.asarray(line + lateral[:, None] * np.column_stack([-along[:, 1], along[:, 0]]))


def curvature_of(points: Points) -> Floats:
    """Return the signed curvature (n,), 1/m, of evenly sampled `points` (n, 2) by central differences."""
    first = np.gradient(points, axis=0)
    second = np.zeros_like(points)
    second[1:-1] = points[2:] - 2.0 * points[1:-1] + points[:-2]
    cross = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
    return np.asarray(cross / np.maximum(np.hypot(first[:, 0], first[:, 1]) ** 3, 1e-9))


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


@kernel
def wrapped(angle: float) -> float:
    """Return `angle` (rad) in (-π, π]."""
    return math.pi - (math.pi - angle) % (2.0 * math.pi)
