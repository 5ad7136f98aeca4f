"""Step 1 of the pilot: simulate the planned manoeuvre ahead, the others keeping their behaviour (F&L 1991, §2)."""

from __future__ import annotations

import math
from collections.abc import Collection
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sumo_reactive.driver.ablation import Mechanism
from sumo_reactive.driver.compilation import kernel
from sumo_reactive.driver.geometry.footprint import boxes_overlap
from sumo_reactive.driver.geometry.polyline import Floats
from sumo_reactive.driver.nouns.assessment import Assessment, Encounter, PlanOutcome
from sumo_reactive.driver.nouns.constraint import TimeConstraint
from sumo_reactive.driver.nouns.forecast import PATH_STEP_M, Forecast
from sumo_reactive.driver.nouns.plan import NominalPlan
from sumo_reactive.driver.nouns.snapshot import Foe, PathObstacle, Snapshot
from sumo_reactive.driver.nouns.state import STANDING_SPEED
from sumo_reactive.driver.parameters import Parameters
from sumo_reactive.driver.pilot.passages import View
from sumo_reactive.driver.pilot.rules.gaps import Passing, Threat, is_enough
from sumo_reactive.driver.vehicle.limits import VehicleLimits
from sumo_reactive.driver.vehicle.safe_speed import following_speed, stopping_speed

ASSESSMENT_STEP_S = 0.2
"""Step of the simulation ahead: 2.8 m at city speed, less than a car's length."""


class Way(NamedTuple):
    """What the front axle is to follow: samples x, y, heading (n,) `step` m apart, and the speeds allowed there, m/s.

    `stop`: where the front bumper is to stop (m of it).
    """

    x: Floats
    y: Floats
    heading: Floats
    speed_limits: Floats
    step: float
    stop: float = math.inf


def way_of(plan: NominalPlan, stop: float = math.inf) -> Way:
    """Return the curve C of a plan, up to where the front bumper is to stop on it (m)."""
    curve = plan.curve
    return Way(curve.x, curve.y, curve.heading, plan.speed_limits, curve.step, stop)


@kernel
def drive_ahead(
    s: float, heading: float, speed: float, x: Floats, y: Floats, headings: Floats, limits: Floats, step: float,
    stop: float, leaders: Floats, acceleration: float, gaining: float, jerk: float, approach: float, deceleration: float,
    headway: float, gap: float, wheelbase: float, overhang: float, dt: float, out: Floats,
) -> None:  # fmt: skip
    """Fill `out` (n, 5) with front bumper x, y, heading, speed, s of F, every `dt` s: M with its front axle on C.

    θ̇ = v sin φ / L with φ the angle from the body to C (F&L 1991, §3.1). `stop`: where the bumper is to stop (m of C);
    `leaders` (m, 3): rear's arc length, speed, and the arc length beyond which it is not in the way. It speeds up as the
    executor does: `gaining` (m/s²) now, more with `jerk` (m/s³), a limit within the time constant `approach` (s).
    """
    last = len(x) - 1
    for k in range(len(out)):
        u = min(max(s / step, 0.0), last - 1e-6)
        i = int(u)
        f = u - i
        px, py = x[i] + f * (x[i + 1] - x[i]), y[i] + f * (y[i + 1] - y[i])
        c, w = math.cos(heading), math.sin(heading)
        out[k, 0], out[k, 1], out[k, 2], out[k, 3], out[k, 4] = px + overhang * c, py + overhang * w, heading, speed, s
        gaining = min(gaining + jerk * dt, acceleration)
        wanted = min(limits[i], speed + min(gaining * dt, max(limits[i] - speed, 0.0) * min(1.0, dt / approach)))
        wanted = min(wanted, stopping_speed(stop - s - overhang, deceleration, dt))
        for m in range(len(leaders)):
            at = leaders[m, 0] + leaders[m, 1] * k * dt
            if at < leaders[m, 2]:
                wanted = min(wanted, following_speed(at - s - overhang - gap, leaders[m, 1], deceleration, headway))
        speed = max(wanted, 0.0, speed - 2.0 * deceleration * dt)
        heading += speed * math.sin(headings[i] + f * (headings[i + 1] - headings[i]) - heading) / wheelbase * dt
        s += speed * dt


@kernel
def first_contact(
    trace: Floats, length: float, width: float, points: Floats, first: NDArray[np.int64], count: NDArray[np.int64],
    bodies: Floats, speeds: Floats, leads: Floats, dt: float, path_step: float,
) -> tuple[int, int]:  # fmt: skip
    """Return (path, step of `trace`) where the ego's box first meets another's; (-1, -1) when it never does.

    Path k is driven at `speeds[k]` m/s (NaN: not looked at) from `leads[k]` s ahead of where its user is.
    """
    for n in range(len(trace)):
        ex = trace[n, 0] - 0.5 * length * math.cos(trace[n, 2])
        ey = trace[n, 1] - 0.5 * length * math.sin(trace[n, 2])
        for k in range(len(first)):
            if math.isnan(speeds[k]):
                continue
            u = (bodies[k, 0] + speeds[k] * (n * dt + leads[k])) / path_step
            i = min(max(int(u), 0), count[k] - 2)
            a, b = points[first[k] + i], points[first[k] + i + 1]
            f = u - i  # beyond the end: straight on
            h = a[2]
            c, w = math.cos(h), math.sin(h)
            back = 0.5 * bodies[k, 3]
            bx = a[0] + f * (b[0] - a[0]) - back * c - bodies[k, 1] * w
            by = a[1] + f * (b[1] - a[1]) - back * w + bodies[k, 1] * c
            if boxes_overlap(ex, ey, trace[n, 2], length, width, bx, by, h, bodies[k, 3], bodies[k, 4]):
                return k, n
    return -1, -1


def simulate(
    snapshot: Snapshot, way: Way, leaders: Floats, limits: VehicleLimits, duration: float, headway: float = 1.0
) -> Floats:
    """Return the ego's motion along `way`, (n, 5) as `drive_ahead` gives it, behind `leaders` (m, 3).

    `headway`: share of the driver's own that is kept.
    """
    out = np.empty((round(duration / ASSESSMENT_STEP_S), 5))
    ego = snapshot.ego
    drive_ahead(
        snapshot.s, ego.pose.heading, ego.speed, way.x, way.y, way.heading, way.speed_limits, way.step,
        way.stop, leaders, limits.acceleration_in_plan, max(ego.acceleration, 0.0),
        snapshot.parameters.comfort_jerk, snapshot.parameters.speed_approach_s,
        limits.comfort_deceleration, headway * limits.time_headway, limits.standstill_gap, limits.wheelbase,
        limits.front_overhang, ASSESSMENT_STEP_S, out,
    )  # fmt: skip
    return out


def passing(motion: Floats, earliest: float, to_region: float, to_clear: float, length: float) -> Passing:
    """Read off a simulated motion (n, 5) until when the ego is in a region where it may be from `earliest` on (s); ways in m
    from the front bumper (`to_clear`: until the rear is out), `length` its own (m)."""
    merged = time_of(motion, to_region + length, ASSESSMENT_STEP_S)
    last = min(int(merged / ASSESSMENT_STEP_S), len(motion) - 1)
    return Passing(earliest, time_of(motion, to_clear, ASSESSMENT_STEP_S), merged, float(motion[last, 3]))


@kernel
def time_of(motion: Floats, way: float, dt: float) -> float:
    """Return when a motion (n, 5), in steps of `dt` s, has covered a `way` (m), s: 0 when it is behind; beyond its end it
    goes on at its last speed."""
    if way <= 0.0:
        return 0.0
    for k in range(1, len(motion)):
        beyond = motion[k, 4] - motion[0, 4] - way
        if beyond >= 0.0:
            return float(dt * (k - beyond / (motion[k, 4] - motion[k - 1, 4])))
    last = len(motion) - 1
    return float(dt * last + (way - motion[last, 4] + motion[0, 4]) / max(motion[last, 3], 0.1))


def followed(snapshot: Snapshot) -> list[PathObstacle]:
    """Return whom the ego follows: bodies in its corridor that drive along C or stand."""
    return [o for o in snapshot.on_path if o.along > -STANDING_SPEED and abs(o.across) <= max(o.along, STANDING_SPEED)]


def leader_table(snapshot: Snapshot) -> Floats:
    """Return the leaders as `drive_ahead` wants them: in the way for ever."""
    return np.array([(o.start, max(o.along, 0.0), math.inf) for o in followed(snapshot)]).reshape(-1, 3)


def assess(
    view: View, forecast: Forecast, stop: TimeConstraint | None, target: TimeConstraint | None, trusted: Collection[str]
) -> Assessment:
    """Return how the plan ends if the ego goes on for a while: fine, late for `target`, or in touch with somebody.

    Who comes from behind has to look out himself, and so has who is `trusted` to yield and still can.
    """
    snapshot, plan, limits = view.snapshot, view.plan, view.limits
    way = way_of(plan) if stop is None else way_of(plan, stop.s)
    trace = simulate(snapshot, way, leader_table(snapshot), limits, snapshot.parameters.assessed_s)
    late = max(plan.on_schedule(float(trace[-1, 4]), snapshot.time + len(trace) * ASSESSMENT_STEP_S)[0], 0.0)
    speeds = _speeds(snapshot, forecast, limits, trusted)
    k, n = first_contact(
        trace, limits.length, limits.width, forecast.points, forecast.first, forecast.counts, forecast.bodies, speeds,
        np.zeros(len(speeds)), ASSESSMENT_STEP_S, PATH_STEP_M,
    )  # fmt: skip
    place = target.s if target else plan.curve.length
    if k >= 0 and snapshot.parameters.has(Mechanism.FAILURE):
        x, y, _, _, s = trace[n].tolist()
        meets = Encounter(forecast.user_ids[k], snapshot.time + n * ASSESSMENT_STEP_S, s + limits.front_overhang, x, y)
        return Assessment(PlanOutcome.FAILURE, late, place, meets)
    is_late = late > snapshot.parameters.excessive_delay_s
    return Assessment(PlanOutcome.DEGRADED if is_late else PlanOutcome.FINE, late, place)


def would_meet(
    own: Passing, foe: Foe, other: Threat, parameters: Parameters, patience: float = 1.0, *, may_follow: bool
) -> bool:
    """Whether an ego that goes on and a foe that does would be in a region at the same time, but for too small a gap: a
    FAILURE of the plan there, and the reason to ask who gives way. `patience` (0..1] scales the gaps."""
    return parameters.has(Mechanism.FAILURE) and not is_enough(own, foe, other, parameters, patience, may_follow=may_follow)


def failing_at(assessment: Assessment, met: Encounter | None) -> Assessment:
    """Return the assessment with whom the ego would meet in a region, unless it meets somebody earlier."""
    known = assessment.encounter
    if met is None or (known is not None and known.time <= met.time):
        return assessment
    return assessment._replace(outcome=PlanOutcome.FAILURE, encounter=met)


def _speeds(snapshot: Snapshot, forecast: Forecast, limits: VehicleLimits, trusted: Collection[str]) -> Floats:
    """The speed of each path (k,), m/s; NaN where its user need not be looked at."""
    pose = snapshot.ego.pose
    middle = limits.front_to_rear_axle - 0.5 * limits.length
    speeds = speeds_ahead(forecast.points, forecast.first, forecast.bodies, pose.x, pose.y, pose.heading, middle)
    for k, user_id in enumerate(forecast.user_ids):
        if user_id in trusted:
            speeds[k] = math.nan
    return speeds


@kernel
def speeds_ahead(
    points: Floats, first: NDArray[np.int64], bodies: Floats, x: float, y: float, heading: float, middle: float
) -> Floats:
    """Return the speed of each path (k,), m/s, NaN for those who follow: their front is behind the ego's middle, which is
    `middle` m ahead of its rear axle at (x, y)."""
    c, s = math.cos(heading), math.sin(heading)
    speeds = bodies[:, 2].copy()
    for k in range(len(first)):
        px, py, ph = points[first[k], 0], points[first[k], 1], points[first[k], 2]
        along = math.cos(ph - heading)
        ahead = (px - x) * c + (py - y) * s + bodies[k, 0] * along
        if along > 0.5 and ahead < middle:
            speeds[k] = np.nan
    return speeds
