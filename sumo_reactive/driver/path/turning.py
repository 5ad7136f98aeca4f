"""Turns that the car cannot steer: refitted by heading, so that C swings out where it would need a larger angle."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.linalg import cho_factor, cho_solve
from scipy.ndimage import maximum_filter1d

from sumo_reactive.driver.geometry.curve import CURVE_STEP_M
from sumo_reactive.driver.geometry.polyline import Floats, Points, curvature_of
from sumo_reactive.driver.geometry.swept import steering_along
from sumo_reactive.driver.vehicle.limits import VehicleLimits

TURN_REACH = 2.8
"""A turn too tight to steer is refitted this many turning radii on both sides: room to swing out and come back."""

MAX_STEERING_PER_M = 0.2
"""rad/m; C turns the wheels no faster in a turn that was refitted: 0.8 rad/s at 4 m/s."""

STEERING_MARGIN = 0.95
"""Share of the largest steering angle that C aims at; the executor needs the rest to correct errors."""

ITERATIONS = 30
MOST_STEPS = 90
"""A turn is refitted in no more steps than this, so that a long vehicle's takes no longer than a car's."""
STEERING_EXCESS_WEIGHT = 40.0
"""Cost of 1 rad too much, in metres of deviation: 0.01 rad excess costs as much as 0.4 m."""
STEERING_RATE_WEIGHT = 10.0
"""Cost of 1 rad/m more than MAX_STEERING_PER_M, in metres of deviation."""
CURVATURE_RATE_WEIGHT = 5.0
"""Cost of a change of curvature within CURVE_STEP_M, per 1/m, in metres."""
U_TURN_RAD = 2.8
"""A turn by more leads back beside the way it came…"""
INSIDE_WEIGHT = 4.0
"""…where traffic comes: a deviation to its inside costs as much as one this many times as wide."""
SWING_M = 0.5
"""In another turn the middle of the front bumper may pass this far from the line on the side of oncoming traffic…"""
SWING_WEIGHT = 2.0
"""…and farther at this cost, in metres of deviation per metre."""
LEAVING_M, MOST_LEAVING_M = 1.3, 2.4
"""On the other side it may be this far and half the car's width away, at most MOST_LEAVING_M: a body 2.5 m wide whose front
is 2.85 m from the centre of a lane of 3.2 m is off it…"""
LEAVING_WEIGHT = 12.0
"""…and farther at this cost."""
JOINT_WEIGHT = 100.0
"""Cost of missing the place or heading where the turn must end, per metre or radian."""
DAMPING = 1e-3
SETTLED = 2e-3
"""Iterations end when no heading changes by more than this, rad."""


@dataclass(frozen=True)
class Steered:
    """What of a car matters for a turn: wheelbase and front overhang (m), largest steering angle (rad) that C may ask for,
    on which side oncoming traffic is (`oncoming`: 1 left, −1 right), how far from the middle of its lane its front begins
    to leave the road (`leaving`, m), and how far it may be on the side of oncoming traffic (`swing`, m)."""

    wheelbase: float
    overhang: float
    most: float
    oncoming: int
    leaving: float
    swing: float = SWING_M


def turnable(
    points: Points, line: Points, limits: VehicleLimits, steering_angle: float, left_hand: bool, kept: Sequence[slice] = ()
) -> tuple[Points, Floats]:
    """Return `points` (n, 2) with turns that ask for more than the car's largest steering angle refitted near `line` (n, 2).

    `steering_angle` (rad) is the car's at the first; turns that touch what is `kept` stay as they are. The second result
    (n,) is the index on `line` of each point, not whole where a turn was refitted.
    """
    index = np.arange(len(points), dtype=np.float64)
    result, most = points.copy(), STEERING_MARGIN * limits.max_steering_angle
    if not (np.abs(curvature_of(points)) > math.sin(most) / limits.wheelbase).any():  # then no angle grows beyond
        return result, index
    ways = np.diff(points, axis=0)
    headings, steps = np.unwrap(np.arctan2(ways[:, 1], ways[:, 0])), np.hypot(*ways.T)
    angles = steering_along(headings, steps, limits.wheelbase, steering_angle)
    leaving = min(LEAVING_M + 0.5 * limits.width, MOST_LEAVING_M)
    body = Steered(limits.wheelbase, limits.front_overhang, most, -1 if left_hand else 1, leaving)
    reach = int(TURN_REACH / limits.max_curvature / CURVE_STEP_M)
    wide = maximum_filter1d(np.append(np.abs(angles), 0.0) > most, 2 * reach + 1).astype(np.int8)
    edges = np.flatnonzero(np.diff(np.concatenate(([0], wide, [0]))))
    for first, end in zip(edges[::2], edges[1::2], strict=True):
        part = slice(int(first), int(end))
        if end - first < 8 or any(one.start < end and first < one.stop for one in kept):
            continue
        result[part] = _refitted(points[part], line[part], body, float(angles[first]))
        index[part] = first + _nearest(result[part], line[part])
    return result, np.maximum.accumulate(index)


def _refitted(points: Points, line: Points, body: Steered, angle: float) -> Points:
    """Return the turn `points` (m, 2) steered by at most what `body` allows where its ends, held fixed, leave room.

    Gauss–Newton on the headings of its steps and one common step length; `angle` (rad) is the steering angle at first.
    """
    at = np.linspace(0.0, len(points) - 1.0, min(len(points), MOST_STEPS))
    if len(at) < len(points):
        own = np.arange(len(points))
        fewer, rail = (np.column_stack([np.interp(at, own, part[:, k]) for k in (0, 1)]) for part in (points, line))
        places = _refitted(fewer, rail, body, angle)
        return np.asarray(CubicSpline(at, places)(own))
    headings, step = _stepped(points)
    first, last = headings[0], headings[-1]
    leads_back = abs(last - first) > U_TURN_RAD
    body = replace(body, swing=body.leaving if leads_back else SWING_M)
    keeps = not leads_back or _has_room(points, float(first), body)
    for _ in range(ITERATIONS):
        places = _walked(points[0], headings, step)
        angles, rows = _steering(headings, step, body.wheelbase, angle)
        parts = (
            _deviation(places, line, headings, step),
            *((_swing(places, line, headings, step, (angles, rows), body),) if keeps else ()),
            _excess(angles, rows, step, body.most),
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


def _has_room(points: Points, heading: float, body: Steered) -> bool:
    """Whether the turn `points` (m, 2), which leads back from `heading`, is wide enough to be swept on the road."""
    ways = points - points[0]
    extent = float(np.abs(ways[:, 1] * math.cos(heading) - ways[:, 0] * math.sin(heading)).max())
    return extent + 2.0 * body.leaving > 2.0 * body.wheelbase / math.sin(body.most)


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
    aside, normal = _aside(places, line)
    turned = headings[-1] - headings[0]
    inside = (aside * turned > 0.0) & (abs(turned) > U_TURN_RAD)
    weight = math.sqrt(step) * np.where(inside, INSIDE_WEIGHT, 1.0)
    rows = np.einsum("ik,kij->ij", normal, _place_jacobian(headings, step, places))
    return weight * aside, weight[:, None] * rows


def _swing(
    places: Points, line: Points, headings: Floats, step: float, steering: tuple[Floats, Floats], body: Steered
) -> tuple[Floats, Floats]:
    """Return residual (m − 1,) and Jacobian of how far the front bumper swings out more than it may to oncoming traffic, and
    off the road to the other side.

    `steering`: the angles (m − 1,), rad, with their Jacobian. The bumper is ahead of the front axle by the overhang along
    the body, which is turned from the way of the axle by them.
    """
    angles, rows = steering
    along = headings - angles
    ways = body.overhang * np.column_stack([np.cos(along), np.sin(along)])
    aside, normal = _aside(places + np.vstack([ways[:1], ways]), line)
    turned = np.eye(len(headings), len(headings) + 1) - rows
    moved = (normal * np.column_stack([-ways[:, 1], ways[:, 0]])).sum(axis=1)[:, None] * turned
    moved += np.einsum("ik,kij->ij", normal, _place_jacobian(headings, step, places))
    is_oncoming = aside * body.oncoming > 0.0
    weight = np.where(is_oncoming, SWING_WEIGHT, LEAVING_WEIGHT) * math.sqrt(step)
    return _beyond(aside, moved, np.where(is_oncoming, body.swing, body.leaving), weight)


def _aside(places: Points, line: Points) -> tuple[Floats, Points]:
    """Return how far (m − 1,), m, each place but the first is to the left of `line`, and the left normals (m − 1, 2)."""
    at = _nearest(places, line)[1:]
    own = np.arange(len(line))
    feet = np.column_stack([np.interp(at, own, line[:, k]) for k in (0, 1)])
    way = np.gradient(line, axis=0)
    normal = np.column_stack([np.interp(at, own, -way[:, 1]), np.interp(at, own, way[:, 0])])
    normal /= np.maximum(np.hypot(*normal.T), 1e-9)[:, None]
    return (normal * (places[1:] - feet)).sum(axis=1), normal


def _place_jacobian(headings: Floats, step: float, places: Points) -> Floats:
    """Return ∂(x, y) of each place but the first by headings and log step, shape (2, m − 1, m)."""
    lower = np.tri(len(headings))
    turned = np.stack([-np.sin(headings) * lower, np.cos(headings) * lower]) * step
    return np.concatenate([turned, (places[1:] - places[0]).T[:, :, None]], axis=2)


def _steering(headings: Floats, step: float, wheelbase: float, angle: float) -> tuple[Floats, Floats]:
    """Return the steering angles (m − 1,), rad, of even steps along `headings`, and their Jacobian.

    `angle` is that of the first step, rad.
    """
    count = len(headings)
    angles = steering_along(headings, np.full(count, step), wheelbase, angle)
    shrink, half = math.exp(-step / wheelbase), np.tan(0.5 * angles)
    kept = shrink * (1.0 + half**2) / (1.0 + (shrink * half) ** 2)
    longer = -2.0 * step / wheelbase * shrink * half / (1.0 + (shrink * half) ** 2)
    rows = np.zeros((count, count + 1))
    for k in range(1, count):
        rows[k] = kept[k - 1] * rows[k - 1]
        rows[k, k] += 1.0
        rows[k, k - 1] -= 1.0
        rows[k, -1] += longer[k - 1]
    return angles, rows


def _excess(angles: Floats, rows: Floats, step: float, most: float) -> tuple[Floats, Floats]:
    """Return residual (2m − 3,) and Jacobian of the steering angle beyond `most` and its change beyond what is allowed.

    `angles` (m − 1,) with Jacobian `rows`, as `_steering` returns them.
    """
    count = len(angles)
    return _beyond(
        np.concatenate([angles, np.diff(angles) / step]),
        np.vstack([rows, np.diff(rows, axis=0) / step]),
        np.repeat([most, MAX_STEERING_PER_M], [count, count - 1]),
        np.repeat([STEERING_EXCESS_WEIGHT, STEERING_RATE_WEIGHT], [count, count - 1]),
    )


def _beyond(values: Floats, rows: Floats, most: Floats, weight: Floats) -> tuple[Floats, Floats]:
    """Return weighted residual and Jacobian of what `values` (k,), with Jacobian `rows`, exceed `most` by."""
    over = weight * np.sign(values) * np.maximum(np.abs(values) - most, 0.0)
    return over, rows * (weight * (over != 0.0))[:, None]


def _bend_rate(headings: Floats, step: float) -> tuple[Floats, Floats]:
    """Return residual (m − 3,) and Jacobian of the change of curvature per sample."""
    weight = CURVATURE_RATE_WEIGHT * math.sqrt(CURVE_STEP_M / step) / step
    rate = np.diff(headings, 2) * weight
    rows = np.zeros((len(rate), len(headings) + 1))
    k = np.arange(len(rate))
    for shift, factor in ((0, 1.0), (1, -2.0), (2, 1.0)):
        rows[k, k + shift] = factor * weight
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
