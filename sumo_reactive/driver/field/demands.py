"""What P⁺, the leaders and the car ask of v_d, in numbers: the rows that the kernels read."""

from __future__ import annotations

import math
from collections.abc import Iterable
from struct import Struct
from typing import Any, NamedTuple

import numpy as np

from sumo_reactive.driver.ablation import Mechanism
from sumo_reactive.driver.caching import PLANS_KEPT, kept
from sumo_reactive.driver.compilation import kernel
from sumo_reactive.driver.field.field import driver_of
from sumo_reactive.driver.geometry.polyline import Floats
from sumo_reactive.driver.nouns.completed_plan import CompletedPlan, Weights
from sumo_reactive.driver.nouns.constraint import TimeConstraint
from sumo_reactive.driver.nouns.decision import INSTRUCTION_NUMBERS, Instruction, Reason
from sumo_reactive.driver.nouns.plan import NominalPlan
from sumo_reactive.driver.nouns.snapshot import Snapshot
from sumo_reactive.driver.parameters import Parameters
from sumo_reactive.driver.vehicle.limits import VehicleLimits
from sumo_reactive.driver.vehicle.safe_speed import CURVATURE_WINDOW_M

PLACE, TIME, SPEED, IS_BEHIND, HIS_BRAKING, IS_CERTAIN, IS_ON_SCHEDULE = range(7)
"""Columns of the row of a time constraint: s (m), time (s), speed (m/s), whether it is a leader's rear, his braking (m/s²),
whether its time is known, whether it is of the schedule."""

_ROW = Struct("7d")
_NO_ROWS: Floats = np.empty((0, 7))
NO_SLOTS: Floats = np.empty((0, 2))
"""The ego falls in behind nobody."""


class Manner(NamedTuple):
    """How the car is driven under an instruction: decelerations and accelerations in m/s², times in s, ways in m.

    `comfort`, `planned`, `emergency`: how hard it brakes; `eases`: what the driver calls comfortable under any instruction;
    `gains`: how fast it gains speed under this one, `most`: at the most. `headway` and `gap` are kept to a leader, a
    `line_margin` to a line. `lateral`: the largest lateral acceleration, `steering_rate` in rad/s. `has_times`, `has_room`:
    1, or 0 with that mechanism taken out. The rest are parameters.
    """

    comfort: float
    planned: float
    emergency: float
    eases: float
    gains: float
    most: float
    headway: float
    gap: float
    line_margin: float
    jerk: float
    pressing_gain: float
    rolling_share: float
    tolerance: float
    approach: float
    slot_headway: float
    lateral: float
    steering_rate: float
    lateral_jerk: float
    has_times: float
    has_room: float


@kernel
def manner_in(row: Floats) -> Manner:
    """Return the manner that a row (20,) holds."""
    return Manner(
        row[0], row[1], row[2], row[3], row[4], row[5], row[6], row[7], row[8], row[9], row[10], row[11], row[12], row[13],
        row[14], row[15], row[16], row[17], row[18], row[19],
    )  # fmt: skip


@kept(4)
def manner_of(completed: CompletedPlan, limits: VehicleLimits) -> Floats:
    """Return how the car is driven under the plan's instruction, (20,): an array is the cheapest to hand over."""
    p, profile = limits.parameters, completed.tuning.profile
    return np.array(Manner(
        comfort=min(limits.comfort_deceleration * profile.deceleration, limits.planned_deceleration),
        planned=limits.planned_deceleration, emergency=limits.emergency_deceleration, eases=limits.comfort_deceleration,
        gains=limits.max_acceleration * profile.acceleration, most=limits.max_acceleration,
        headway=limits.time_headway * profile.headway, gap=limits.standstill_gap, line_margin=p.stop_line_margin_m,
        jerk=p.comfort_jerk, pressing_gain=p.pressing_gain, rolling_share=p.rolling_share, tolerance=p.time_tolerance_s,
        approach=p.speed_approach_s, slot_headway=p.slot_headway_s, lateral=limits.max_lateral_acceleration,
        steering_rate=limits.max_steering_rate, lateral_jerk=p.max_lateral_jerk, has_times=float(p.has(Mechanism.TIMES)),
        has_room=float(p.has(Mechanism.ROOM_TO_STOP)),
    ))  # fmt: skip


@kept(4)
def car_of(completed: CompletedPlan, limits: VehicleLimits) -> Floats:
    """Return what the car can do and what its instruction weighs as `choose_command` takes them, (17,), no state in it."""
    w = weights_of(completed, limits.parameters)
    return np.array((
        0.0, 0.0, 0.0, 0.0, 0.0, limits.wheelbase, limits.front_to_rear_axle, limits.length, limits.width, limits.max_speed,
        limits.max_steering_angle, limits.max_lateral_acceleration, limits.emergency_deceleration, 0.0,
        w.valley, w.shadow, w.velocity,
    ))  # fmt: skip


@kept(4)
def held_of(completed: CompletedPlan, limits: VehicleLimits) -> tuple[Any, ...]:
    """Return what stays as it is while the plan is in force, in the order in which `commanded` takes it: manner, car,
    driver, rows of the (l, t_l) and of the speeds, and P."""
    plan, curve = completed.plan, completed.plan.curve
    return (
        manner_of(completed, limits), car_of(completed, limits), driver_of(limits.parameters),
        timed_rows(completed), speed_rows(completed),
        curve.x, curve.y, curve.heading, curve.curvature, bends_of(plan), plan.speed_limits, plan.times, curve.step,
    )  # fmt: skip


def weights_of(completed: CompletedPlan, parameters: Parameters) -> Weights:
    """Return w₁, w₂, w₃ of the instruction."""
    w = completed.tuning.weights
    if parameters.shares_of not in (0.0, INSTRUCTION_NUMBERS[completed.instruction]):
        return w
    return Weights(
        w.valley * parameters.valley_share, w.shadow * parameters.shadow_share, w.velocity * parameters.velocity_share
    )


def hard_ones(snapshot: Snapshot, completed: CompletedPlan) -> tuple[TimeConstraint, ...]:
    """Return the constraints that the ego can stop for: the pilot's, and the leaders, who move.

    Who stands is no leader of an ego that squeezes out of a local minimum: only that no command may touch him holds it.
    """
    return completed.hard + _leaders(snapshot, completed)


def hard_rows(snapshot: Snapshot, completed: CompletedPlan) -> Floats:
    """Return the rows (n, 7) of the hard constraints."""
    return _unpacked(_hard_packed(completed) + b"".join(map(_packed, _leaders(snapshot, completed))))


def _leaders(snapshot: Snapshot, completed: CompletedPlan) -> tuple[TimeConstraint, ...]:
    if completed.instruction is not Instruction.WIDEN:
        return snapshot.leaders
    return tuple(leader for leader in snapshot.leaders if leader.speed > 0.0)


@kept(1)
def _hard_packed(completed: CompletedPlan) -> bytes:
    return b"".join(map(_packed, completed.hard))


@kept(1)
def timed_rows(completed: CompletedPlan) -> Floats:
    """Return the rows (n, 7) of the (l, t_l) that set no more than the desired speed."""
    return _rows(completed.timed_ones)


@kept(1)
def speed_rows(completed: CompletedPlan) -> Floats:
    """Return the rows (n, 7) of what the ego is to be no faster at."""
    return _rows(completed.speeds)


def slot_rows(snapshot: Snapshot, completed: CompletedPlan, limits: VehicleLimits) -> Floats:
    """Return whom the ego falls in behind, (n, 2): the gap to his rear (m), his speed (m/s).

    Behind whom it lets in, it falls back to its usual distance: he has to find the gap long enough.
    """
    found, more = [], limits.time_headway - limits.parameters.slot_headway_s
    beside = {neighbour.user.id: neighbour for neighbour in reversed(snapshot.neighbours)}
    for one in completed.slots:
        if (other := beside.get(one.behind)) is not None:
            found.append((other.ahead - other.user.body.length, other.user.speed))
        elif (asker := snapshot.asker) is not None and asker.user.id == one.behind:
            kept = limits.standstill_gap + more * asker.user.speed
            found.append((asker.ahead - asker.user.body.length - kept, asker.user.speed))
    return np.array(found).reshape(-1, 2)


def _rows(constraints: Iterable[TimeConstraint]) -> Floats:
    return _unpacked(b"".join(map(_packed, constraints)))


def _packed(one: TimeConstraint) -> bytes:
    s, time, speed, _, reason, _, _, behind, braking = one
    is_certain = time < math.inf and one.is_certain
    return _ROW.pack(s, time, speed, bool(behind), braking, is_certain, reason is Reason.ON_SCHEDULE)


def _unpacked(packed: bytes) -> Floats:
    return np.frombuffer(bytearray(packed)).reshape(-1, 7) if packed else _NO_ROWS


@kept(PLANS_KEPT)
def bends_of(plan: NominalPlan) -> Floats:
    """Return how much C bends on average over CURVATURE_WINDOW_M from each sample on, 1/m, as far as that is whole."""
    curve = plan.curve
    window = bend_window(curve.step)
    if len(curve.curvature) <= window:
        return np.empty(0)
    return np.convolve(np.abs(curve.curvature), np.full(window, 1.0 / window), "valid")


@kernel
def bend_window(step: float) -> int:
    """Return how many samples, `step` m apart, the curvature is averaged over."""
    return max(int(CURVATURE_WINDOW_M / step), 1)
