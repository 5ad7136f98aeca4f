"""How fast C may be driven, and when the car can be where: the (l, t_l) of P (F&L 1991, §1.3)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.ndimage import uniform_filter1d

from sumo_reactive.driver.geometry.curve import Curve
from sumo_reactive.driver.geometry.polyline import Floats
from sumo_reactive.driver.nouns.constraint import TimeConstraint
from sumo_reactive.driver.nouns.plan import NominalPlan, PlannedStop
from sumo_reactive.driver.vehicle.limits import VehicleLimits
from sumo_reactive.driver.vehicle.safe_speed import CURVATURE_WINDOW_M

MIN_SPEED = 0.1
"""m/s; keeps the time of a sample finite where a speed limit or a standing start is 0."""


def speed_envelope(curve: Curve, lane_limits: Floats, limits: VehicleLimits) -> Floats:
    """Return the highest speed (n,), m/s, at each sample that lanes, bends and comfortable braking allow.

    `lane_limits` (n,) in m/s.
    """
    window = max(int(CURVATURE_WINDOW_M / curve.step), 1)
    bend = uniform_filter1d(np.abs(curve.curvature), window, mode="nearest")
    cornering = np.sqrt(limits.comfort_lateral_acceleration / np.maximum(bend, 1e-6))
    free = np.minimum(np.minimum(lane_limits, limits.max_speed), cornering)
    return braking_to(free, curve.step, limits.comfort_deceleration)


def braking_to(speeds: Floats, step: float, deceleration: float) -> Floats:
    """Return `speeds` (n,) lowered so that each can be braked to the next ones with `deceleration` (m/s²)."""
    potential = 2.0 * deceleration * step * np.arange(len(speeds))
    lowest = np.minimum.accumulate((speeds**2 + potential)[::-1])[::-1]
    return np.asarray(np.minimum(speeds, np.sqrt(np.maximum(lowest - potential, 0.0))))


def accelerating_from(speeds: Floats, step: float, acceleration: float) -> Floats:
    """Return `speeds` (n,) lowered so that each can be reached from the ones before with `acceleration` (m/s²)."""
    return braking_to(speeds[::-1], step, acceleration)[::-1]


def time_constraints(
    step: float, envelope: Floats, places: Sequence[float], stops: Sequence[PlannedStop], limits: VehicleLimits,
    start: tuple[float, float],
) -> tuple[tuple[TimeConstraint, ...], Floats]:  # fmt: skip
    """Return when the front bumper reaches `places` and `stops` (m on C) at the earliest, and the times (n,) of F.

    `envelope` (n,) are the highest speeds (m/s) at samples `step` m apart; `start` is (time s, speed m/s). A stop's
    constraint holds the arrival there; later ones wait for its duration and `until`.
    """
    time, speed = start
    first, found, schedule = 0, [], np.full(len(envelope), time)
    pending = sorted(place for place in set(places) if place > 0.0)
    for stop in sorted(stops, key=lambda stop: stop.s):
        last = max(_sample_of(stop.s, step, len(envelope), limits), first)
        times = time + _leg(envelope[first : last + 1], step, speed, 0.0, limits)
        schedule[first : last + 1] = times
        reached = [place for place in pending if place < stop.s] + [stop.s]
        found += _constraints(reached, first, times, step, limits)
        pending = [place for place in pending if place > stop.s]
        time = max(float(times[-1]) + stop.stop.duration, -np.inf if stop.stop.until is None else stop.stop.until)
        first, speed = last, 0.0
    times = time + _leg(envelope[first:], step, speed, None, limits)
    schedule[first + 1 :] = times[1:]
    return (*found, *_constraints(pending, first, times, step, limits)), schedule


def retimed(
    plan: NominalPlan, s: float, speed: float, time: float, limits: VehicleLimits, stops: Sequence[PlannedStop]
) -> tuple[TimeConstraint, ...]:
    """Return the time constraints ahead of a car with its front axle at `s` m and `speed` m/s: as planned where limits
    allow, else the earliest that they do. This is the answer that the paper names for a delay (F&L 1991, §2).

    `stops`: those of the plan that are still to be served, for the time that is left of them.
    """
    step = plan.curve.step
    first = min(int(s / step), len(plan.speed_limits) - 2)
    began = first * step
    front = s + limits.front_overhang
    ahead = [constraint for constraint in plan.time_constraints if constraint.s > front]
    stops = [replace(stop, s=stop.s - began) for stop in stops if stop.s > front]
    places = [constraint.s - began for constraint in ahead]
    earliest, _ = time_constraints(step, plan.speed_limits[first:], places, stops, limits, (time, speed))
    at = {round(constraint.s + began, 3): constraint.time for constraint in earliest}
    return tuple(TimeConstraint(c.s, max(c.time, at.get(round(c.s, 3), c.time))) for c in ahead)


def _sample_of(place: float, step: float, count: int, limits: VehicleLimits) -> int:
    """Return the sample where the front axle is when the bumper is at `place`."""
    return min(max(round((place - limits.front_overhang) / step), 0), count - 1)


def _leg(envelope: Floats, step: float, speed: float, last_speed: float | None, limits: VehicleLimits) -> Floats:
    """Return the time (n,), s, since the first sample when driven from `speed` to `last_speed` (None: any)."""
    bounded = envelope.copy()
    if last_speed is not None:
        bounded[-1] = last_speed
    bounded = braking_to(bounded, step, limits.comfort_deceleration)
    bounded[0] = speed
    driven = accelerating_from(bounded, step, limits.max_acceleration)
    mean = np.maximum(0.5 * (driven[1:] + driven[:-1]), MIN_SPEED)
    return np.concatenate(([0.0], np.cumsum(step / mean)))


def _constraints(
    places: Sequence[float], first: int, times: Floats, step: float, limits: VehicleLimits
) -> list[TimeConstraint]:
    """Return the constraints of `places` on a leg that starts at sample `first`."""
    axle = (np.asarray(places) - limits.front_overhang) / step - first
    at = np.interp(axle, np.arange(len(times)), times)
    return [TimeConstraint(float(s), float(t)) for s, t in zip(places, at, strict=True)]
