"""The smooth curve C: the reference met from the car's pose, smoothed, sampled at even arc length (F&L 1991, §1.3)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.linalg import solveh_banded
from scipy.ndimage import maximum_filter1d

from sumo_reactive.driver.geometry.curve import CURVE_STEP_M, Curve, project_each
from sumo_reactive.driver.geometry.polyline import Floats, Points, Polyline, curvature_of, cut, eased, moved_aside, wrapped
from sumo_reactive.driver.nouns.plan import Aside, lateral_of
from sumo_reactive.driver.path.aside import COMFORT_DEVIATION_M, centred, clear_of_oncoming, clear_of_others
from sumo_reactive.driver.path.reference import Piece, Reference
from sumo_reactive.driver.path.turning import turnable
from sumo_reactive.driver.vehicle.limits import VehicleLimits
from sumo_reactive.driver.vehicle.travel_time import (
    MAX_START_BLEND_M,
    MIN_START_BLEND_M,
    QUINTIC_STEP_CURVATURE,
    QUINTIC_TURN_CURVATURE,
    side_step_length,
)

PLAN_HORIZON_M = 2000.0
"""C is planned this far ahead and prolonged before it runs out."""

MIN_STEP_LATERAL = 0.7
"""m/s²; lateral acceleration that is left for a move aside in the tightest bend."""

MAX_SWING_OUT_M = 0.3
"""A transition from a pose that heads out of its lane leads at most this much farther out, if the car can turn so soon."""

SMOOTHING_LENGTH_M = 1.6
"""Length over which a kink of the centre line is rounded at first; a 4.4 m turn then keeps within 0.15 m of its lane."""

SMOOTHING_GROWTH = 1.35
"""Growth of the smoothing length per pass where C is still too tight; one pass adds some 35 % of deviation."""

SMOOTHING_REACH_M = 5.0
"""A place that is too tight loosens C this far on both sides: half of a car's turn."""

SMOOTHING_PASSES = 9
"""Most passes of smoothing: 1.35⁹ ≈ 15 times the first length; past that the greatest deviation holds C."""

TURN_LEAD_M = 15.0
"""So far around a turn in several moves the car keeps to the middle of its lane."""

STRAIGHT_ON_RAD = 0.1
"""A way through a junction turns if the road behind goes on in another direction by more than this."""

DEVIATION_SHARE = 0.65
"""Elsewhere C may use this share of the room beside the car in its lane: a kink of the map's line, or a lane that it moves
aside by half a lane within a few metres, is no bend to brake for."""

FOOT_REACH_M = 2.5
"""A place of the reference is looked for this far along C around the sample that smoothing has moved from it."""
MIN_STRETCH = 0.05
"""Least metres of C per metre of reference: inside a bend about a point of the line its places keep their order."""
PINNED_LENGTH_M = 0.05
"""Smoothing length of samples that must stay where they are."""


class CurveStart(NamedTuple):
    """Where C begins: place of the front axle (m), direction of its motion (rad), speed (m/s) and steering angle (rad).

    `speed_factor` scales lane limits.
    """

    x: float
    y: float
    heading: float
    speed: float
    steering_angle: float = 0.0
    speed_factor: float = 1.0


@dataclass(frozen=True, eq=False)
class Trajectory:
    """C with places known by both arc lengths, on the reference and on C (m,), and where the start transition ends."""

    curve: Curve
    reference_arc: Floats
    arc: Floats
    blend_end: float

    def s(self, u: float) -> float:
        """Return the arc length on C of reference arc length `u`, m."""
        return u if u < 0.0 else float(np.interp(u, self.reference_arc, self.arc))

    def reference_at(self, s: Floats) -> Floats:
        """Return the reference arc lengths at arc lengths `s` on C, m."""
        return np.asarray(np.interp(s, self.arc, self.reference_arc))


def trajectory(
    reference: Reference, start: CurveStart, limits: VehicleLimits, aside: Aside | None = None,
    in_moves: Sequence[tuple[float, float]] = (),
) -> Trajectory:  # fmt: skip
    """Return the smooth curve from `start` along the reference.

    `aside` leads it beside the reference for a while. `in_moves`: from where to where (m of the reference) the car turns in
    moves, so that C need not be steered.
    """
    centre = Polyline(np.vstack(reference.points))
    if reference.goal is None and centre.length > PLAN_HORIZON_M:
        centre = Polyline(cut(centre, 0.0, PLAN_HORIZON_M))
    u = CURVE_STEP_M * np.arange(int(centre.length / CURVE_STEP_M) + 1, dtype=np.float64)
    line = centre.points_at(u)
    line = clear_of_oncoming(line, reference, limits) if aside is None else moved_aside(line, lateral_of(aside, u))
    width, left_hand = reference.pieces[0].lane.width, reference.graph.left_hand
    lanes, _ = _met_from(line, start, width, limits)
    pace, half_widths = lanes_at(reference.pieces, u)
    line = clear_of_others(centred(line, half_widths, limits, left_hand), half_widths, reference, limits)
    line, blend = _met_from(line, start, width, limits)
    pace = np.minimum(pace * start.speed_factor, limits.max_speed)
    comfort = limits.comfort_lateral_acceleration / np.maximum(pace, 1.0) ** 2
    exact = [(0.0, max(blend, aside.until if aside is not None else 0.0) + 2.0 * SMOOTHING_REACH_M)]
    exact += [(a - TURN_LEAD_M, b + TURN_LEAD_M) for a, b in in_moves]
    fitted = smoothed(line, CURVE_STEP_M, comfort, _deviation(reference, half_widths, exact, limits))
    kept = [slice(int(a / CURVE_STEP_M), int(b / CURVE_STEP_M)) for a, b in in_moves]
    fitted, index = turnable(fitted, lanes, limits, start.steering_angle, left_hand, kept)
    curve, arc = _even(fitted)
    places = np.union1d(u, centre.arc_lengths[centre.arc_lengths < u[-1]])
    feet = _feet(centre.points_at(places), places, curve, np.interp(places, CURVE_STEP_M * index, arc))
    return Trajectory(curve, places, feet, float(np.interp(blend, places, feet)))


def lanes_at(pieces: list[Piece], u: Floats) -> tuple[Floats, Floats]:
    """Return the lanes' speed limits (n,), m/s, and half their widths (n,), m, at reference arc lengths `u` (n,)."""
    index = np.clip(np.searchsorted([piece.u for piece in pieces], u, side="right") - 1, 0, None)
    limits, halves = np.array([(piece.lane.speed_limit, 0.5 * piece.lane.width) for piece in pieces])[index].T
    return limits, halves


def _met_from(line: Points, start: CurveStart, width: float, limits: VehicleLimits) -> tuple[Points, float]:
    """Return `line` bent at its beginning to lead from `start` in its direction, and the length of the transition, m.

    A quintic takes the offset and the difference of direction to zero. `width` (m) is the lane's.
    """
    x, y, heading, speed = start[:4]
    ahead = line[1] - line[0]
    direction = math.atan2(ahead[1], ahead[0])
    offset = np.array([x, y]) - line[0]
    turn = np.array([math.cos(heading), math.sin(heading)]) - ahead / max(float(np.hypot(*ahead)), 1e-9)
    error = wrapped(heading - direction)
    away = float(np.hypot(*offset))
    length = max(side_step_length(away, abs(error), speed, width, limits), _length_in_bend(line, away, speed, limits))
    aside = float(ahead[0] * offset[1] - ahead[1] * offset[0]) / max(float(np.hypot(*ahead)), 1e-9)
    length = min(length, (len(line) - 1) * CURVE_STEP_M)
    turning = _turning_length(length, aside, error, speed, width, limits)
    at = (np.arange(len(line)) * CURVE_STEP_M)[:, None]
    back, turned = (np.minimum(at / reach, 1.0) for reach in (length, turning))
    return line + offset * (1.0 - eased(back)) + turn * turning * _led_out(turned), length


def _led_out(t: Floats) -> Floats:
    """Return how far aside (n,), in lengths, a quintic of unit length leads at `t` (n,) from slope 1 to slope 0."""
    return np.asarray(t - t**3 * (6.0 - 8.0 * t + 3.0 * t**2))


def _turning_length(
    length: float, aside: float, error: float, speed: float, width: float, limits: VehicleLimits
) -> float:
    """Return the length (m) in which a car `aside` m to the left of its line takes out its heading `error` (rad, left).

    It is that of the whole transition, `length`, unless this would lead the car out of its lane, `width` m wide, or farther
    out than it is: then it turns sooner, as tightly as it can.
    """
    t = np.linspace(0.0, 1.0, 41)
    held = max(0.5 * (width - limits.width), abs(aside) + MAX_SWING_OUT_M)
    most = min(limits.max_curvature, limits.max_lateral_acceleration / max(speed, 1.0) ** 2)
    shortest = max(QUINTIC_TURN_CURVATURE * abs(error) / most, MIN_START_BLEND_M)
    back, turning = aside * (1.0 - eased(t)), length
    while turning > shortest:
        led = back + error * turning * _led_out(np.minimum(t * length / turning, 1.0))
        if float(np.abs(led).max()) <= held:
            return turning
        turning = max(0.9 * turning, shortest)
    return turning


def _length_in_bend(line: Points, offset: float, speed: float, limits: VehicleLimits) -> float:
    """Return the length (m) of a step of `offset` m to the side that adds no more lateral acceleration at `speed` (m/s) than
    the bend of `line` leaves of the comfortable one."""
    reach = line[: int(MAX_START_BLEND_M / CURVE_STEP_M)]
    along = np.diff(reach, axis=0)
    turned = abs(wrapped(math.atan2(along[-1, 1], along[-1, 0]) - math.atan2(along[0, 1], along[0, 0])))
    bend = speed * speed * turned / (len(reach) * CURVE_STEP_M)
    left = max(limits.comfort_lateral_acceleration - bend, MIN_STEP_LATERAL)
    return min(speed * math.sqrt(QUINTIC_STEP_CURVATURE * offset / left), MAX_START_BLEND_M)


def _feet(points: Points, u: Floats, curve: Curve, guess: Floats) -> Floats:
    """Return the arc lengths (n,), m, where the `points` (n, 2) at `u` (n,) project on C near `guess`, increasing.

    Smoothing moves samples along the line too: into a turn that it shortens, by up to 0.3 m on either side.
    """
    found = np.maximum(project_each(points, curve.x, curve.y, curve.step, guess, FOOT_REACH_M), 0.0)
    least = MIN_STRETCH * u
    return np.asarray(np.minimum(np.maximum.accumulate(found - least) + least, curve.length))


def _even(points: Points) -> tuple[Curve, Floats]:
    """Return the curve through `points` (n, 2) at even arc length, and the arc length (n,) of each point on it."""
    chord = np.concatenate(([0.0], np.cumsum(np.maximum(np.hypot(*np.diff(points, axis=0).T), 1e-6))))
    spline = CubicSpline(chord, points)
    middle = 0.5 * (chord[1:] + chord[:-1])
    pace = (np.hypot(*spline(chord, 1).T), np.hypot(*spline(middle, 1).T))
    steps = np.diff(chord) * (pace[0][:-1] + 4.0 * pace[1] + pace[0][1:]) / 6.0
    arc = np.concatenate(([0.0], np.cumsum(steps)))
    at = np.interp(np.arange(int(arc[-1] / CURVE_STEP_M) + 1) * CURVE_STEP_M, arc, chord)
    (x, y), (dx, dy), (ddx, ddy) = spline(at).T, spline(at, 1).T, spline(at, 2).T
    heading = np.unwrap(np.arctan2(dy, dx))
    curvature = (dx * ddy - dy * ddx) / np.maximum(np.hypot(dx, dy) ** 3, 1e-9)
    x, y = np.ascontiguousarray(x), np.ascontiguousarray(y)
    return Curve(x=x, y=y, heading=heading, curvature=curvature, step=CURVE_STEP_M), arc


def _deviation(
    reference: Reference, half_widths: Floats, exact: Sequence[tuple[float, float]], limits: VehicleLimits
) -> Floats:
    """Return how far C may leave the centre line to be driven at the road's speed (n,), m: a share of the room beside the
    car, but no more than comfort asks for in turns, where others wait beside it, where it changes lanes, and where it is to
    be `exact` (from, to; m): as it comes from where the car is, beside somebody, around turns in moves."""
    is_held, lanes = np.zeros(len(half_widths), np.bool_), reference.graph.lanes
    held = [*exact, *((change.start, change.end) for change in reference.changes)]
    for connection, start, end in reference.passages:
        before, behind = lanes[connection.from_lane].spine, lanes[connection.to_lane].spine
        if abs(wrapped(behind.heading_at(0.0) - before.heading_at(before.length))) > STRAIGHT_ON_RAD:
            held.append((start, end))
    for start, end in held:
        is_held[max(int(start / CURVE_STEP_M), 0) : int(end / CURVE_STEP_M) + 1] = True
    free = DEVIATION_SHARE * (half_widths - 0.5 * limits.width)
    return np.where(is_held, COMFORT_DEVIATION_M, np.maximum(free, COMFORT_DEVIATION_M))


def smoothed(line: Points, step: float, comfort_curvature: Floats, deviation: Floats) -> Points:
    """Return `line` (n, 2), sampled every `step` m, made smooth; its first two samples stay.

    Where |curvature| exceeds `comfort_curvature` (n,), 1/m, the line is loosened step by step, until it does not or
    leaves the centre line by `deviation` (n,), m.
    """
    lengths = np.full(len(line), SMOOTHING_LENGTH_M)
    stiffness = _third_difference_bands(len(line), step)
    reach = 2 * int(SMOOTHING_REACH_M / step) + 1
    result = _fitted(line, stiffness, lengths)
    for _ in range(SMOOTHING_PASSES):
        away = maximum_filter1d(np.hypot(*(result - line).T), reach)
        tight = (np.abs(curvature_of(result)) > comfort_curvature) & (away < deviation / SMOOTHING_GROWTH)
        if not tight.any():
            break
        lengths = np.where(maximum_filter1d(tight, reach), lengths * SMOOTHING_GROWTH, lengths)
        result = _fitted(line, stiffness, lengths)
    return np.asarray(result)


def _fitted(line: Points, stiffness: Floats, lengths: Floats) -> Points:
    """Return argmin Σ ‖p − line‖² / length⁶ + Σ ‖third derivative of p‖², shape (n, 2)."""
    weights = lengths**-6.0
    weights[:2] = PINNED_LENGTH_M**-6.0
    bands = stiffness.copy()
    bands[-1] += weights
    centre = line.mean(axis=0)
    fitted: Points = solveh_banded(bands, weights[:, None] * (line - centre), check_finite=False)
    return np.asarray(fitted + centre)


def _third_difference_bands(n: int, step: float) -> Floats:
    """Return the upper bands (4, n) of DᵀD for the third-derivative operator D on n samples."""
    row = np.array([-1.0, 3.0, -3.0, 1.0])
    bands = np.zeros((4, n))
    for a in range(4):
        for b in range(a, 4):
            bands[3 - (b - a), b : b + n - 3] += row[a] * row[b]
    return bands / step**6
