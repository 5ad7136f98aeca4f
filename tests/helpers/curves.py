"""Curves with plans along them, and a car that drives them with the executor alone."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence

import numpy as np

from helpers.cars import CAR
from sumo_reactive.driver.field.executor import Execution, execute
from sumo_reactive.driver.geometry.curve import Curve
from sumo_reactive.driver.nouns.completed_plan import CompletedPlan, Intent, Tuning, Weights
from sumo_reactive.driver.nouns.constraint import TimeConstraint
from sumo_reactive.driver.nouns.decision import Behaviour, Instruction
from sumo_reactive.driver.nouns.plan import NominalPlan
from sumo_reactive.driver.nouns.snapshot import Snapshot
from sumo_reactive.driver.nouns.state import Pose, VehicleState
from sumo_reactive.driver.nouns.traffic import RoadUser
from sumo_reactive.driver.path.time_constraints import speed_envelope
from sumo_reactive.driver.view.perceive import locate

STEP = 0.5
WEIGHTS = Weights(valley=10.0, shadow=100.0, velocity=1.0)
NOTHING = np.empty((0, 2))


def turning(lengths: Sequence[float], curvatures: Sequence[float]) -> Curve:
    """Return a curve from the origin eastwards: stretches of constant curvature (1/m), integrated finely."""
    fine = 0.005
    kappa = np.concatenate([np.full(round(n / fine), k) for n, k in zip(lengths, curvatures, strict=True)])
    heading = np.concatenate(([0.0], np.cumsum(kappa * fine)))
    middle = 0.5 * (heading[1:] + heading[:-1])
    x, y = (np.concatenate(([0.0], np.cumsum(f(middle) * fine))) for f in (np.cos, np.sin))
    pick = slice(None, None, round(STEP / fine))
    return Curve(x=x[pick], y=y[pick], heading=heading[pick], curvature=np.append(kappa, kappa[-1])[pick], step=STEP)


def straight(length: float = 400.0) -> Curve:
    """Return a straight curve along the x axis."""
    return turning([length], [0.0])


def plan_along(curve: Curve, speed_limit: float = 13.9) -> NominalPlan:
    """Return a plan on `curve` alone: no junction, no stop, no time that presses."""
    envelope = speed_envelope(curve, np.full(len(curve.x), speed_limit), CAR)
    times = np.concatenate(([0.0], np.cumsum(curve.step / envelope[1:])))
    return NominalPlan(
        curve=curve, segments=(), passages=(), lane_changes=(), stops=(), speed_limits=envelope,
        time_constraints=(TimeConstraint(curve.length, 0.0),), goal=None, times=times,
    )  # fmt: skip


def on_curve(curve: Curve, front: float, speed: float) -> VehicleState:
    """Return a car that stands along C with its front bumper at arc length `front`, wheels straight."""
    x, y, heading = curve.at(front - CAR.front_overhang)
    pose = Pose(x - CAR.wheelbase * math.cos(heading), y - CAR.wheelbase * math.sin(heading), heading)
    return VehicleState(pose, speed, 0.0)


def seen(
    state: VehicleState,
    plan: NominalPlan,
    s: float,
    users: Sequence[RoadUser] = (),
    static=NOTHING,
    time=0.0,
    leaders: tuple[TimeConstraint, ...] = (),
    room: tuple[float, float] = (0.0, 0.0),
) -> Snapshot:
    """Return what the executor needs to know of a car near arc length `s` of C and of the `users` around it."""
    at, d = locate(state, plan, CAR, s)
    boxes = [(u.x, u.y, u.heading, u.speed, u.body.length, u.body.width, 0.0, math.inf) for u in users]
    boxes = np.array(boxes).reshape(-1, 8)
    return Snapshot(time, state, at, d, at + CAR.front_overhang, boxes, static, (), leaders, (), (), {}, room=room)


def asked(plan: NominalPlan, stop: TimeConstraint | None = None, weights=WEIGHTS) -> CompletedPlan:
    """Return the plan with a stop, in normal driving."""
    instruction = Instruction.FOLLOW_CURVE if stop is None else Instruction.STOP
    constraints = plan.time_constraints if stop is None else (*plan.time_constraints, stop)
    return CompletedPlan(
        plan=plan, behaviour=Behaviour.NORMAL, instruction=instruction, tuning=Tuning(weights), constraints=constraints,
        intent=Intent.DRIVE, decisions=(),
    )  # fmt: skip


def driven(
    plan: NominalPlan,
    state: VehicleState,
    completed: Callable[[float], CompletedPlan],
    seconds: float,
    period: float = 0.1,
    **options,
) -> Iterator[tuple[Snapshot, Execution]]:
    """Yield each snapshot and the execution that follows it; `completed` is asked for the plan at each time, and so is
    `leaders`, where it is given, for those ahead, and `users` for those around."""
    static, leaders = options.pop("static", NOTHING), options.pop("leaders", lambda _: ())
    users, room = options.pop("users", lambda _: ()), options.pop("room", (0.0, 0.0))
    s, _ = locate(state, plan, CAR, 0.0)
    for k in range(round(seconds / period)):
        time = k * period
        snapshot = seen(state, plan, s, users(time), static=static, time=time, leaders=leaders(time), room=room)
        execution = execute(snapshot, completed(time), CAR, period, **options)
        yield snapshot, execution
        state, s = execution.state, snapshot.s
