"""One command from the potential field: expand the grid, discard, score, choose (F&L 1991, §3.2)."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from sumo_reactive.driver.field.command_grid import CommandGrid, lattice, paper_grid, wide_grid
from sumo_reactive.driver.field.demands import NO_SLOTS, car_of, hard_rows, held_of, slot_rows
from sumo_reactive.driver.field.desired_speed import (
    HARDER_BY,
    desired_speed,
    hazard_named,
    on_curve,
    room_to_brake,
    without_jerk,
)
from sumo_reactive.driver.field.field import ADMISSIBLE, NO_COMMAND, choose_command, driver_of, potentials_over
from sumo_reactive.driver.field.moves import moved_on
from sumo_reactive.driver.field.one_pass import STANDS, car_in, commanded
from sumo_reactive.driver.field.valley_map import NO_MAP, ValleyMap
from sumo_reactive.driver.geometry.curve import Curve
from sumo_reactive.driver.geometry.footprint import boxes_overlap
from sumo_reactive.driver.geometry.polyline import Floats
from sumo_reactive.driver.nouns.completed_plan import CompletedPlan
from sumo_reactive.driver.nouns.decision import Instruction
from sumo_reactive.driver.nouns.record import TOO_NEAR, CommandField
from sumo_reactive.driver.nouns.snapshot import Snapshot
from sumo_reactive.driver.nouns.state import Command, Pose, VehicleState
from sumo_reactive.driver.vehicle.bicycle import advance
from sumo_reactive.driver.vehicle.body import box_of, clear_behind, own_box
from sumo_reactive.driver.vehicle.limits import VehicleLimits
from sumo_reactive.driver.vehicle.safe_speed import HARD_STOP_MARGIN_M

BACK_UP_SPEED = 1.0
"""m/s; walking speed."""

LEFT_BEHIND_M = 0.4
"""An ego that backs up stops this far before whoever is behind it."""

COARSE_STOP_MARGIN_M = 0.4
"""Distance to a line that none of the nine commands gives up, each held half a second: with less they creep on until it is
too late to stop."""


class Potentials(NamedTuple):
    """U and its three terms for the chosen command."""

    total: float
    valley: float
    shadow: float
    velocity: float


NO_POTENTIALS = Potentials(0.0, 0.0, 0.0, 0.0)
"""Of a command that no field has chosen."""


class Execution(NamedTuple):
    """The command for the next control period, the state it leads to, and feedback to the pilot.

    `emergency`: it brakes harder than planned, because nothing milder stops clear of `hazard` (see `StepRecord`); with none,
    no command is admissible, and it is the hardest brake along C. `place`: (s, d) of the front axle of `state` on C (m, left
    positive; None: to be found, as where another has put the state there).
    """

    command: Command
    state: VehicleState
    desired_speed: float
    potentials: Potentials
    emergency: bool
    hazard: str = ""
    place: tuple[float, float] | None = None

    def after(self, before: Execution) -> Execution:
        """Return the execution, an emergency if the one `before` it in the same step was."""
        return self._replace(emergency=True, hazard=before.hazard) if before.emergency else self


class _Bounds(NamedTuple):
    """The time that a command lasts (s), the room to brake in (m), the speeds wanted and lowest planned behind it (m/s)."""

    period: float
    room: float
    wanted: float
    lowest: float


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

    `nine_commands` takes the paper's command space instead of the lattice, `valley` its bitmaps instead of exact
    distances.
    """
    if completed.instruction is Instruction.BACK_UP:
        return back_up(snapshot, completed, limits, period)
    if completed.move is not None:
        calm = limits.max_acceleration * completed.tuning.profile.acceleration
        command, state = moved_on(snapshot, completed.move, calm, limits, period)
        return Execution(command, state, state.speed, NO_POTENTIALS, emergency=False)
    if nine_commands or completed.tuning.wide_grid:
        return _of_grid(snapshot, completed, limits, period, valley if nine_commands else None)
    return _of_lattice(snapshot, completed, limits, period)


def _of_lattice(snapshot: Snapshot, completed: CompletedPlan, limits: VehicleLimits, period: float) -> Execution:
    """Choose from the lattice: one compiled pass from the constraints to the state that the command leads to."""
    pose, speed, angle, acceleration = snapshot.ego
    numbers: tuple[Any, ...] = (
        snapshot.time, snapshot.s, snapshot.d, snapshot.front, *pose, speed, angle, acceleration, period,
        *held_of(completed, limits), hard_rows(snapshot, completed),
        slot_rows(snapshot, completed, limits) if completed.slots else NO_SLOTS,
        snapshot.static, snapshot.boxes, *snapshot.room,
    )  # fmt: skip
    verdict, wanted, hazard, gain, rate, total, u1, u2, u3, x, y, heading, faster, turned, s, d = commanded(*numbers)
    if verdict == STANDS:
        stays = snapshot.ego._replace(acceleration=0.0)
        return Execution(Command(0.0, 0.0), stays, wanted, NO_POTENTIALS, emergency=False, place=(s, d))
    state = VehicleState(Pose(x, y, heading), faster, turned, (faster - speed) / period)
    emergency = verdict != ADMISSIBLE or faster < speed - (limits.planned_deceleration + HARDER_BY) * period
    said = _hazard(hazard_named(hazard, snapshot, completed), verdict) if emergency else ""
    return Execution(Command(gain, rate), state, wanted, Potentials(total, u1, u2, u3), emergency, said, (s, d))


def _of_grid(
    snapshot: Snapshot, completed: CompletedPlan, limits: VehicleLimits, period: float, valley: ValleyMap | None
) -> Execution:
    """Choose from the nine commands, with a `valley`, or from the wide grid that leads out of a local minimum."""
    is_paper, speed = valley is not None, snapshot.ego.speed
    wish = desired_speed(snapshot, completed, limits, period)
    wanted = without_jerk(wish.speed, wish.is_pressing, on_curve(snapshot), period, limits.parameters.comfort_jerk)
    if wanted <= 0.0 and speed == 0.0 and not is_paper:  # there is nothing to choose
        return Execution(Command(0.0, 0.0), snapshot.ego._replace(acceleration=0.0), wanted, NO_POTENTIALS, emergency=False)
    if completed.tuning.wide_grid:
        grid, snapshot = wide_grid(limits), snapshot._replace(boxes=_apart_from(snapshot, limits))
    else:
        grid = paper_grid(limits, speed, period)
    planned = limits.service_deceleration if is_paper else limits.planned_deceleration
    room = room_to_brake(snapshot, completed, COARSE_STOP_MARGIN_M if is_paper else HARD_STOP_MARGIN_M)
    bounds = _Bounds(period, room, wanted, min(wanted, speed - planned * period))
    car = _car(snapshot.ego, completed, limits)
    command, verdict, potentials, state = _choose(snapshot, completed.plan.curve, car, bounds, grid, valley or NO_MAP)
    emergency = verdict != ADMISSIBLE or state.speed < speed - (planned + HARDER_BY) * period
    return Execution(command, state, wanted, potentials, emergency, _hazard(wish.hazard, verdict) if emergency else "")


def _apart_from(snapshot: Snapshot, limits: VehicleLimits) -> Floats:
    """Return the boxes without those beside or behind the ego that touch it already: it could not be kept clear of them by
    any command, and would stand there for ever."""
    own = x, y, heading, length, _ = own_box(snapshot.ego.pose, limits)
    c, s = math.cos(heading), math.sin(heading)

    def is_apart(row: list[float]) -> bool:
        box = bx, by, *_ = box_of(*row[:3], *row[4:6])
        return (bx - x) * c + (by - y) * s > 0.5 * length or not boxes_overlap(*own, *box)

    return snapshot.boxes[[k for k, box in enumerate(snapshot.boxes.tolist()) if is_apart(box)]]


def _hazard(named: str, verdict: int) -> str:
    """Return what an emergency is for; nothing if no command is admissible."""
    return "" if verdict == NO_COMMAND else named or TOO_NEAR


def field_over(
    snapshot: Snapshot, completed: CompletedPlan, limits: VehicleLimits, period: float
) -> CommandField | None:
    """Return U over the coarsest lattice among which `execute` chooses; None while it follows a move or backs up.

    Each value is that of the kernel which chooses, asked for one command alone.
    """
    if completed.move is not None or completed.instruction is Instruction.BACK_UP:
        return None
    ego, grid = snapshot.ego, lattice(limits, snapshot.ego.speed, snapshot.ego.acceleration, period)
    wish = desired_speed(snapshot, completed, limits, period)
    wanted = without_jerk(wish.speed, wish.is_pressing, on_curve(snapshot), period, limits.parameters.comfort_jerk)
    room = room_to_brake(snapshot, completed, HARD_STOP_MARGIN_M)
    curve, lowest = completed.plan.curve, min(wanted, ego.speed - limits.planned_deceleration * period)
    potentials = potentials_over(
        _car(ego, completed, limits), grid.accelerations, grid.steering_rates, period, room, wanted, lowest,
        curve.x, curve.y, curve.heading, curve.step, snapshot.s, snapshot.static, NO_MAP.bitmaps, snapshot.boxes,
        *snapshot.room, driver_of(snapshot.parameters),
    )  # fmt: skip
    return CommandField(grid.accelerations, grid.steering_rates, potentials)


def _choose(
    snapshot: Snapshot, curve: Curve, car: Floats, bounds: _Bounds, grid: CommandGrid, valley: ValleyMap
) -> tuple[Command, int, Potentials, VehicleState]:
    """Return the command, the verdict on it, its potentials and the state that it leads to."""
    acceleration, rate, best = choose_command(
        car, grid.accelerations, grid.steering_rates, grid.rounds, *bounds,
        curve.x, curve.y, curve.heading, curve.step, snapshot.s, snapshot.static,
        valley.bitmaps, valley.x0, valley.y0, valley.cell, snapshot.boxes, *snapshot.room, driver_of(snapshot.parameters),
    )  # fmt: skip
    (verdict, _, u1, u2, u3, x, y, heading, speed, angle), (w1, w2, w3) = best, car[-3:].tolist()
    potentials = Potentials(w1 * u1 + w2 * u2 + w3 * u3, u1, u2, u3)
    state = VehicleState(Pose(x, y, heading), speed, angle, (speed - snapshot.ego.speed) / bounds.period)
    return Command(acceleration, rate), verdict, potentials, state


def _car(ego: VehicleState, completed: CompletedPlan, limits: VehicleLimits) -> Floats:
    """Return where the car is, what it can do and what its instruction weighs, as `choose_command` takes them."""
    return car_in(car_of(completed, limits), *ego.pose, ego.speed, ego.steering_angle)


def back_up(snapshot: Snapshot, completed: CompletedPlan, limits: VehicleLimits, period: float) -> Execution:
    """Drive backwards at walking speed, wheels straight, until the front bumper is at the stop that the pilot named, or the
    rear bumper near whoever has come up behind meanwhile."""
    ego = snapshot.ego
    stop = completed.stop
    clear = clear_behind(snapshot.boxes, ego.pose, limits) - LEFT_BEHIND_M
    left = max(min(snapshot.front - stop.s, clear), 0.0) if stop is not None else 0.0
    calm = limits.max_acceleration * completed.tuning.profile.acceleration
    faster = max(-ego.speed, 0.0) + calm * period
    wanted = -min(BACK_UP_SPEED, math.sqrt(2.0 * calm * left), faster)
    steering = -ego.steering_angle / period
    rate = max(-limits.max_steering_rate, min(limits.max_steering_rate, steering))
    command = Command((wanted - ego.speed) / period, rate)
    state = advance(ego, command, limits.wheelbase, period, lowest=-BACK_UP_SPEED)
    return Execution(command, state, wanted, NO_POTENTIALS, emergency=False)
