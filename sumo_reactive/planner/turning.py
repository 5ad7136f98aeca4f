"""Turns that the car cannot steer: refitted by heading, so that C swings out where a tighter bend would be needed."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve
from scipy.ndimage import maximum_filter1d

from sumo_reactive.geometry.polyline import Points
from sumo_reactive.parameters import CURVE_STEP_M, TURN_REACH_M

Floats = NDArray[np.float64]

ITERATIONS = 12
CURVATURE_EXCESS_WEIGHT = 60.0
"""Cost of 1/m too much, in metres of deviation: 0.01/m excess costs as much as 0.6 m."""
CURVATURE_RATE_WEIGHT = 5.0
"""Cost of a change of curvature from sample to sample, per 1/m, in metres."""
JOINT_WEIGHT = 100.0
"""Cost of missing the place or heading where the turn must end, per metre or radian."""
DAMPING = 1e-3
SETTLED = 2e-3
"""Iterations end when no heading changes by more than this, rad."""


def turnable(points: Points, line: Points, bend: Floats, max_curvature: float) -> tuple[Points, Floats]:
    """Return `points` (n, 2) with turns tighter than `max_curvature` (1/m) refitted near `line` (n, 2).

    `bend` is the curvature (n,) of `points`. The second result (n,) is the index on `line` of each point, not whole
    where a turn was refitted.
    """
    index = np.arange(len(points), dtype=np.float64)
    reach = int(TURN_REACH_M / CURVE_STEP_M)
    wide = maximum_filter1d(np.abs(bend) > max_curvature, 2 * reach + 1).astype(np.int8)
    edges = np.flatnonzero(np.diff(np.concatenate(([0], wide, [0]))))
    result = points.copy()
    for first, end in zip(edges[::2], edges[1::2], strict=True):
        part = slice(int(first), int(end))
        if end - first < 8:
            continue
        result[part] = _refitted(points[part], line[part], max_curvature)
        index[part] = first + _nearest(result[part], line[part])
    return result, np.maximum.accumulate(index)


def _refitted(points: Points, line: Points, max_curvature: float) -> Points:
    """Return the turn `points` (m, 2) bent no tighter than `max_curvature` where its ends, held fixed, leave room.

    Gauss–Newton on the headings of its steps and one common step length.
    """
    headings, step = _stepped(points)
    first, last = headings[0], headings[-1]
    for _ in range(ITERATIONS):
        places = _walked(points[0], headings, step)
        residual, jacobian = _deviation(places, line, headings, step)
        parts = (
            (residual, jacobian),
            _excess(headings, step, max_curvature),
            _bend_rate(headings, step),
            _joint(places[-1] - points[-1], headings, step, first, last),
        )
        r = np.concatenate([part[0] for part in parts])
        j = np.vstack([part[1] for part in parts])
        normal = j.T @ j
        normal[np.diag_indices_from(normal)] += DAMPING
        change = cho_solve(cho_factor(normal), -j.T @ r)
        change *= min(1.0, 0.3 / max(float(np.abs(change[:-1]).max()), 1e-9))
        if float(np.abs(change).max()) < SETTLED:
            break
        headings, step = headings + change[:-1], step * float(np.exp(np.clip(change[-1], -0.2, 0.2)))
    places = _walked(points[0], headings, step)
    miss = points[-1] - places[-1]
    return np.asarray(places + miss * np.linspace(0.0, 1.0, len(places))[:, None])


def _stepped(points: Points) -> tuple[Floats, float]:
    """Return the headings (m − 1,) and common length of even steps along `points` (m, 2)."""
    arc = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))))
    even = np.linspace(0.0, arc[-1], len(points))
    ways = np.diff(np.column_stack([np.interp(even, arc, points[:, k]) for k in (0, 1)]), axis=0)
    return np.unwrap(np.arctan2(ways[:, 1], ways[:, 0])), float(even[1])


def _walked(start: Floats, headings: Floats, step: float) -> Points:
    """Return the points (m, 2) reached from `start` by even steps along `headings` (m − 1,)."""
    ways = step * np.column_stack([np.cos(headings), np.sin(headings)])
    return np.vstack([start, start + np.cumsum(ways, axis=0)])


def _nearest(places: Points, line: Points) -> Floats:
    """Return the index (m,) on `line` nearest to each place, not whole, never far from the place's own index."""
    m = len(line)
    own = np.arange(m)
    distance = ((places[:, None, :] - line) ** 2).sum(axis=2) + 1e9 * (np.abs(own[:, None] - own) > m // 4)
    k = np.clip(np.argmin(distance, axis=1), 1, m - 2)
    way = line[k + 1] - line[k - 1]
    along = ((places - line[k]) * way).sum(axis=1) / np.maximum((way**2).sum(axis=1), 1e-9) * 2.0
    return np.asarray(np.clip(k + np.clip(along, -1.0, 1.0), 0.0, m - 1.0))


def _deviation(places: Points, line: Points, headings: Floats, step: float) -> tuple[Floats, Floats]:
    """Return residual (m − 1,) and Jacobian of the signed distance of each place from `line`."""
    at = _nearest(places, line)[1:]
    own = np.arange(len(line))
    feet = np.column_stack([np.interp(at, own, line[:, k]) for k in (0, 1)])
    way = np.gradient(line, axis=0)
    normal = np.column_stack([np.interp(at, own, -way[:, 1]), np.interp(at, own, way[:, 0])])
    normal /= np.maximum(np.hypot(*normal.T), 1e-9)[:, None]
    moved = _place_jacobian(headings, step, places)
    weight = np.sqrt(CURVE_STEP_M)
    return weight * (normal * (places[1:] - feet)).sum(axis=1), weight * np.einsum("ik,kij->ij", normal, moved)


def _place_jacobian(headings: Floats, step: float, places: Points) -> Floats:
    """Return ∂(x, y) of each place but the first by headings and log step, shape (2, m − 1, m)."""
    lower = np.tri(len(headings))
    turned = np.stack([-np.sin(headings) * lower, np.cos(headings) * lower]) * step
    return np.concatenate([turned, (places[1:] - places[0]).T[:, :, None]], axis=2)


def _excess(headings: Floats, step: float, max_curvature: float) -> tuple[Floats, Floats]:
    """Return residual (m − 2,) and Jacobian of the curvature beyond what the car can steer."""
    bend = np.diff(headings) / step
    over = np.maximum(np.abs(bend) - max_curvature, 0.0)
    active = CURVATURE_EXCESS_WEIGHT * (over > 0.0)
    rows = np.zeros((len(bend), len(headings) + 1))
    k = np.arange(len(bend))
    rows[k, k], rows[k, k + 1], rows[:, -1] = -active / step, active / step, -active * bend
    return CURVATURE_EXCESS_WEIGHT * over * np.sign(bend), rows


def _bend_rate(headings: Floats, step: float) -> tuple[Floats, Floats]:
    """Return residual (m − 3,) and Jacobian of the change of curvature per sample."""
    rate = np.diff(headings, 2) / step * CURVATURE_RATE_WEIGHT
    rows = np.zeros((len(rate), len(headings) + 1))
    k = np.arange(len(rate))
    for shift, factor in ((0, 1.0), (1, -2.0), (2, 1.0)):
        rows[k, k + shift] = factor / step * CURVATURE_RATE_WEIGHT
    return rate, rows


def _joint(miss: Floats, headings: Floats, step: float, first: float, last: float) -> tuple[Floats, Floats]:
    """Return residual (4,) and Jacobian of the ends: both headings and the last place, which `miss` (2,) is off."""
    rows = np.zeros((4, len(headings) + 1))
    rows[0, :-1], rows[1, :-1] = -np.sin(headings) * step, np.cos(headings) * step
    span = step * np.array([np.cos(headings).sum(), np.sin(headings).sum()])
    rows[0, -1], rows[1, -1] = span
    rows[2, 0] = rows[3, -2] = 1.0
    residual = np.array([miss[0], miss[1], headings[0] - first, headings[-1] - last])
    return JOINT_WEIGHT * residual, JOINT_WEIGHT * rows
