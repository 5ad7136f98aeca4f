"""One command from the potential field: expand the grid, discard, score, choose (F&L 1991, §3.2)."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sumo_reactive.executor.command_grid import CommandGrid, fine_grid, gentlest_brake, paper_grid, wide_grid
from sumo_reactive.executor.field import EMERGENCY, choose_command
from sumo_reactive.executor.valley_map import NO_MAP, ValleyMap
from sumo_reactive.executor.velocity import cruise_speed
from sumo_reactive.geometry.angle import wrapped
from sumo_reactive.messages.completed_plan import CompletedPlan
from sumo_reactive.messages.decision import Instruction
from sumo_reactive.messages.plan import TimeConstraint
from sumo_reactive.messages.snapshot import Neighbour, Snapshot
from sumo_reactive.messages.state import Command, VehicleState
from sumo_reactive.parameters import (
    BACK_UP_SPEED,
    BRAKING_SHARE,
    COMFORT_EXCESS,
    EXCESS_GAIN,
    HARD_STOP_MARGIN_M,
    SAFE_GAP_M,
    SLOT_HEADWAY_S,
    SPEED_APPROACH_S,
    SPEED_SLACK,
    STEERING_GAIN,
    STOP_LINE_MARGIN_M,
    TIME_TOLERANCE_S,
)
from sumo_reactive.vehicle.bicycle import advance
from sumo_reactive.vehicle.limits import VehicleLimits
from sumo_reactive.vehicle.safe_speed import following_speed, stopping_speed

Array = NDArray[np.float64]


class Potentials(NamedTuple):
    """U and its three terms for the chosen command."""

    total: float
    valley: float
    shadow: float
    velocity: float


class Execution(NamedTuple):
    """The command for the next control period, the state it leads to, and feedback to the pilot.

    `emergency`: no command left a way to stop clear, so the hardest brake along C was taken.
    """

    command: Command
    state: VehicleState
    desired_speed: float
    potentials: Potentials
    emergency: bool


def desired_speed(snapshot: Snapshot, completed: CompletedPlan, limits: VehicleLimits, period: float) -> float:
    """v_d: the least speed that the time constraint, the road ahead, the stop and every leader leave (m/s).

    It falls with the comfortable deceleration, or with the one that a stop or a leader needs if that is greater.
    """
    speed, front, profile = snapshot.ego.speed, snapshot.front, completed.tuning.profile
    comfort = limits.comfort_deceleration * profile.deceleration
    free = min(_cruise(snapshot, completed, limits, period), profile.top_speed)
    best = max(free, speed - _easing(snapshot, completed, limits, comfort) * period)
    headway = limits.time_headway * profile.headway
    if completed.stop is not None:
        away = completed.stop.s - STOP_LINE_MARGIN_M - front
        room = max(away, BRAKING_SHARE * (completed.stop.s - HARD_STOP_MARGIN_M - front))
        braking = max(comfort, _needed(speed, 0.0, room, limits))
        best = min(best, max(stopping_speed(away, comfort, period), speed - braking * period))
    for leader in snapshot.leaders:
        gap = leader.s - front - limits.standstill_gap
        room = max(gap, BRAKING_SHARE * (leader.s - SAFE_GAP_M - front))
        braking = max(comfort, _needed(speed, leader.speed, room, limits))
        following = following_speed(gap, leader.speed, comfort, headway)
        best = min(best, max(following, speed - braking * period))
    slot = _slot(snapshot, completed.slot) if completed.slot else None
    if slot is not None:
        gap = slot.ahead - slot.user.body.length
        following = following_speed(gap, slot.user.speed, comfort, SLOT_HEADWAY_S)
        best = min(best, max(following, speed - comfort * period))
    return max(best, 0.0)


def _easing(snapshot: Snapshot, completed: CompletedPlan, limits: VehicleLimits, comfort: float) -> float:
    """Deceleration (m/s²) towards the road's speed: comfortable, harder where a bend comes that the ego is too fast for."""
    excess = snapshot.ego.speed - completed.plan.road_speed(snapshot.s) - SPEED_SLACK
    return min(comfort + EXCESS_GAIN * max(excess, 0.0), max(comfort, limits.service_deceleration))


def _slot(snapshot: Snapshot, user_id: str) -> Neighbour | None:
    return next((n for n in snapshot.neighbours if n.user.id == user_id), None)


def _target(snapshot: Snapshot, completed: CompletedPlan) -> TimeConstraint | None:
    """Return the next (l, t_l) of P⁺."""
    return next((c for c in completed.time_constraints if c.s > snapshot.front), None)


def _cruise(snapshot: Snapshot, completed: CompletedPlan, limits: VehicleLimits, period: float) -> float:
    """The speed that road and time constraint ask for, approached gently from below (m/s)."""
    plan, speed, target = completed.plan, snapshot.ego.speed, _target(snapshot, completed)
    acceleration = limits.max_acceleration * completed.tuning.profile.acceleration
    sample = int((snapshot.s + speed * period) / plan.curve.step) + 1
    road = plan.speed_limits.item(min(max(sample, 0), len(plan.speed_limits) - 1))
    best = road
    if target is not None:
        left = target.time - snapshot.time - TIME_TOLERANCE_S
        best = min(road, cruise_speed(speed, target.s - snapshot.front, left, road, acceleration))
    return speed + (best - speed) * min(1.0, period / SPEED_APPROACH_S) if best > speed else best


def _without_jerk(wanted: float, ego: VehicleState, limits: VehicleLimits, period: float) -> float:
    """Bound the fall of v_d by the comfortable jerk as long as comfortable braking is enough (m/s)."""
    if wanted < ego.speed - COMFORT_EXCESS * limits.comfort_deceleration * period:
        return wanted
    return max(wanted, ego.speed + gentlest_brake(ego.acceleration, period) * period)


def _needed(speed: float, final: float, distance: float, limits: VehicleLimits) -> float:
    """Deceleration (m/s²) that reaches `final` speed within `distance` m, at most the emergency's."""
    if speed <= final:
        return 0.0
    needed = (speed * speed - final * final) / (2.0 * max(distance, 0.1))
    return min(needed, limits.emergency_deceleration)


def steering_rate_of_curve(snapshot: Snapshot, completed: CompletedPlan, limits: VehicleLimits, period: float) -> float:
    """The steering rate (rad/s) that turns the front wheels' velocity along C, and back onto it, within one period."""
    ego = snapshot.ego
    turn = ego.speed * math.sin(ego.steering_angle) / limits.wheelbase * period
    ahead = snapshot.s + 0.5 * ego.speed * period
    along = completed.plan.curve.at(ahead)[2] - ego.pose.heading - 0.5 * turn
    back = math.atan2(STEERING_GAIN * snapshot.d, ego.speed + 1.0)
    return (wrapped(along - back) - ego.steering_angle) / period


def room_to_brake(snapshot: Snapshot, completed: CompletedPlan) -> float:
    """Way (m) within which the hardest braking must stop the front bumper: line, region, and braking leaders."""
    room = math.inf
    if completed.stop is not None:
        room = completed.stop.s - HARD_STOP_MARGIN_M - snapshot.front
    for leader in snapshot.leaders:
        braking = leader.speed * leader.speed / (2.0 * leader.deceleration)
        room = min(room, leader.s - snapshot.front - SAFE_GAP_M + braking)
    return room


def execute(
    snapshot: Snapshot,
    completed: CompletedPlan,
    limits: VehicleLimits,
    period: float,
    *,
    nine_commands: bool = False,
    valley: ValleyMap = NO_MAP,
) -> Execution:
    """Choose the admissible command that minimises U = w₁U₁ + w₂U₂ + w₃U₃ (F&L 1991, §3.2).

    `nine_commands` takes the paper's command space instead of the fine grid, `valley` its bitmaps instead of exact
    distances.
    """
    if completed.instruction is Instruction.BACK_UP:
        return back_up(snapshot, completed, limits, period)
    ego = snapshot.ego
    wanted = _without_jerk(desired_speed(snapshot, completed, limits, period), ego, limits, period)
    if nine_commands:
        grid = paper_grid(limits, ego.speed, period)
    else:
        lock = limits.max_steering_angle
        steering = steering_rate_of_curve(snapshot, completed, limits, period)
        steering = min(max(steering, (-lock - ego.steering_angle) / period), (lock - ego.steering_angle) / period)
        grid = fine_grid(limits, ego.speed, ego.acceleration, (wanted - ego.speed) / period, steering, period)
    if completed.tuning.wide_grid:
        grid = wide_grid(limits)
    room = room_to_brake(snapshot, completed)
    index, verdict, *terms = _choose(snapshot, completed, grid, limits, period, room, wanted, valley)
    command = Command(
        float(grid.accelerations[index // len(grid.steering_rates)]),
        float(grid.steering_rates[index % len(grid.steering_rates)]),
    )
    w = completed.tuning.weights
    total = w.valley * terms[0] + w.shadow * terms[1] + w.velocity * terms[2]
    state = advance(ego, command, limits.wheelbase, period)
    return Execution(command, state, wanted, Potentials(total, *terms), verdict == EMERGENCY)


def _choose(
    snapshot: Snapshot,
    completed: CompletedPlan,
    grid: CommandGrid,
    limits: VehicleLimits,
    period: float,
    room: float,
    wanted: float,
    valley: ValleyMap,
) -> tuple[int, int, float, float, float]:
    ego, curve, w = snapshot.ego, completed.plan.curve, completed.tuning.weights
    p = ego.pose
    state = np.array((p.x, p.y, p.heading, ego.speed, ego.steering_angle))
    lateral = abs(ego.speed**2 * math.sin(ego.steering_angle) / limits.wheelbase)
    bounds = np.array(
        (
            limits.wheelbase,
            limits.front_to_rear_axle,
            limits.length,
            limits.width,
            limits.max_speed,
            max(limits.max_steering_angle, abs(ego.steering_angle)),
            limits.max_lateral_acceleration,
            limits.emergency_deceleration,
            lateral,
        )
    )
    boxes = snapshot.boxes
    return choose_command(
        state, grid.accelerations, grid.steering_rates, bounds, period, room, wanted,
        np.array((w.valley, w.shadow, w.velocity)), curve.x, curve.y, curve.heading, curve.step, snapshot.s, snapshot.static,
        valley.bitmaps, valley.x0, valley.y0, valley.cell, boxes, boxes,
    )  # fmt: skip


def back_up(snapshot: Snapshot, completed: CompletedPlan, limits: VehicleLimits, period: float) -> Execution:
    """Drive backwards at walking speed, wheels straight, until the front bumper is at the stop that the pilot named."""
    ego = snapshot.ego
    left = max(snapshot.front - completed.stop.s, 0.0) if completed.stop else 0.0
    calm = limits.max_acceleration * completed.tuning.profile.acceleration
    faster = max(-ego.speed, 0.0) + calm * period
    wanted = -min(BACK_UP_SPEED, math.sqrt(2.0 * calm * left), faster)
    steering = -ego.steering_angle / period
    rate = max(-limits.max_steering_rate, min(limits.max_steering_rate, steering))
    command = Command((wanted - ego.speed) / period, rate)
    state = advance(ego, command, limits.wheelbase, period, lowest=-BACK_UP_SPEED)
    return Execution(command, state, wanted, Potentials(0.0, 0.0, 0.0, 0.0), emergency=False)
