"""One control step on one screen: perceive, decide, execute, advance."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from typing import NamedTuple, Protocol

from sumo_reactive.driver.ablation import Mechanism
from sumo_reactive.driver.field.executor import Execution, execute
from sumo_reactive.driver.field.valley_map import MAP_MARGIN_M, MAP_SIDE_M, NO_MAP, ValleyMap, valley_map
from sumo_reactive.driver.nouns.completed_plan import CompletedPlan, Replanning
from sumo_reactive.driver.nouns.constraint import TimeConstraint
from sumo_reactive.driver.nouns.decision import Behaviour
from sumo_reactive.driver.nouns.event import Event, EventKind
from sumo_reactive.driver.nouns.forecast import Outlook
from sumo_reactive.driver.nouns.plan import NominalPlan
from sumo_reactive.driver.nouns.snapshot import Snapshot
from sumo_reactive.driver.nouns.state import VehicleState
from sumo_reactive.driver.nouns.traffic import RoadUser, Traffic
from sumo_reactive.driver.parameters import Delays, Profile
from sumo_reactive.driver.path.time_constraints import retimed
from sumo_reactive.driver.pilot.events import detect
from sumo_reactive.driver.pilot.memory import PilotMemory
from sumo_reactive.driver.pilot.passages import View, view_of
from sumo_reactive.driver.pilot.pilot import Style, decide, notice
from sumo_reactive.driver.pilot.rules.scheduled_stop import still_to_serve
from sumo_reactive.driver.vehicle.bicycle import advance
from sumo_reactive.driver.vehicle.limits import VehicleLimits
from sumo_reactive.driver.view.ahead import passages_ahead
from sumo_reactive.driver.view.attention import foes_of
from sumo_reactive.driver.view.outlook import outlook
from sumo_reactive.driver.view.perceive import locate, perceive
from sumo_reactive.driver.view.static import static_within
from sumo_reactive.driver.world.road_graph import RoadGraph


class Drive(NamedTuple):
    """All that one step hands to the next: the ego, its plan and place on it, the pilot's memory, the executor's map.

    `completed` is the plan that the pilot has completed last, in force until an event; `last` is the execution whose
    command is held until simulation time `held_until` (s). `d`: how far left of C the front axle is (m; None: to be found).
    """

    ego: VehicleState
    plan: NominalPlan
    s: float
    memory: PilotMemory = PilotMemory()
    completed: CompletedPlan | None = None
    valley: ValleyMap = NO_MAP
    last: Execution | None = None
    held_until: float = -math.inf
    d: float | None = None


class Step(NamedTuple):
    """What a control step saw, decided and did, and where that leaves the ego. `runs`: of the pilot in it."""

    snapshot: Snapshot
    completed: CompletedPlan
    execution: Execution
    drive: Drive
    runs: int = 0


Pilot = Callable[[View, Outlook, tuple[Event, ...], PilotMemory, Style], tuple[CompletedPlan, PilotMemory]]
"""Completes the plan because of events, as `decide` does."""

Limiter = Callable[[Snapshot, VehicleLimits], Iterable[TimeConstraint]]
"""Limits the ego in a step by what it sees then."""


class Executor(Protocol):
    """Chooses the command for the next `period` s, as `execute` does."""

    def __call__(
        self, snapshot: Snapshot, completed: CompletedPlan, limits: VehicleLimits, period: float,
        *, nine_commands: bool = False, valley: ValleyMap = NO_MAP,
    ) -> Execution: ...  # fmt: skip


class Parts(NamedTuple):
    """What a controller is made of, each of which may be another's: the pilot, the executor, and `rules` beside the pilot's
    own, which are asked in every step."""

    pilot: Pilot = decide
    executor: Executor = execute
    rules: tuple[Limiter, ...] = ()


PARTS = Parts()
"""The paper's."""


@dataclass(frozen=True, kw_only=True)
class Controller:
    """The paper's motion controller for one car in one world (F&L 1991, figure 1)."""

    graph: RoadGraph
    limits: VehicleLimits
    profile: Profile = Profile.DEFAULT
    delays: Delays = Delays.REPLAN
    parts: Parts = PARTS

    def step(self, traffic: Traffic, drive: Drive, duration: float) -> Step:
        """Drive for `duration` s: one control step, or as many as a coarse duration needs.

        A decision that asks for another curve or route stands until the end of the duration: only then it is planned.
        """
        p, is_paper = self.limits.parameters, self.profile is Profile.PAPER
        longest = p.paper_control_period_s if is_paper else p.control_period_s
        parts = max(1, math.ceil(duration / longest - 1e-6))
        period = duration / parts
        step = self._once(traffic, drive, period)
        for part in range(1, parts):
            before = step
            decides = not before.completed.awaits_plan
            step = self._once(moved(traffic, part * period), step.drive, period, decides=decides)
            step = step._replace(
                completed=step.completed.after(before.completed), execution=step.execution.after(before.execution),
                runs=before.runs + step.runs,
            )  # fmt: skip
        return step

    def _once(self, traffic: Traffic, drive: Drive, period: float, *, decides: bool = True) -> Step:
        premises = drive.memory.premises
        looks = premises is None or (premises.asks and not premises.is_settled)
        place = locate(drive.ego, drive.plan, self.limits, drive.s) if drive.d is None else (drive.s, drive.d)
        seen = perceive(traffic, drive.ego, drive.plan, self.graph, self.limits, place)
        if looks:
            seen = self._with_foes(seen, traffic, drive.plan)
        snapshot, completed, memory, runs = self._completed(seen, traffic, drive, looks, decides=decides)
        held_plan = completed.held() if completed.events else completed
        if drive.last is not None and traffic.time < drive.held_until - 1e-6:
            ego = advance(drive.ego, drive.last.command, self.limits.wheelbase, period)
            execution = drive.last._replace(state=ego)
            s, d = self._place(ego, drive.plan, snapshot.s, completed)
            after = drive._replace(ego=ego, s=s, memory=memory, completed=held_plan, d=d)
            return Step(snapshot, completed, execution, after, runs)
        nine = self.profile is Profile.PAPER
        valley = self._valley(drive, snapshot, traffic) if nine else NO_MAP
        held = max(period, self.limits.parameters.paper_control_period_s) if nine else period
        limited = self._limited(snapshot, completed) if self.parts.rules else completed
        execution = self.parts.executor(snapshot, limited, self.limits, held, nine_commands=nine, valley=valley)
        if held > period:
            execution = execution._replace(state=advance(drive.ego, execution.command, self.limits.wheelbase, period))
        reached = execution.place if self.parts.executor is execute else None  # another may have replaced the state
        s, d = reached or self._place(execution.state, drive.plan, snapshot.s, completed)
        until = traffic.time + held
        after = Drive(execution.state, drive.plan, s, memory, held_plan, valley, execution, until, d)
        return Step(snapshot, completed, execution, after, runs)

    def _limited(self, snapshot: Snapshot, completed: CompletedPlan) -> CompletedPlan:
        """Return P⁺ with what the rules beside the pilot's ask for in this step."""
        found = [one for rule in self.parts.rules for one in rule(snapshot, self.limits)]
        return replace(completed, constraints=(*completed.constraints, *found)) if found else completed

    def _with_foes(self, snapshot: Snapshot, traffic: Traffic, plan: NominalPlan) -> Snapshot:
        """Return a snapshot that knows who can reach which region; a pilot whose decision rests on none does not ask."""
        return snapshot._replace(foes=foes_of(traffic, plan, self.graph, self.limits, snapshot.passages))

    def _place(self, ego: VehicleState, plan: NominalPlan, before: float, completed: CompletedPlan) -> tuple[float, float]:
        """Return where the front axle is on C, and how far left of it, m; in the moves of a turn it does not go back to
        where C comes from, to which it may be as near."""
        s, d = locate(ego, plan, self.limits, before)
        return (s if completed.move is None else max(s, before)), d

    def _completed(
        self, snapshot: Snapshot, traffic: Traffic, drive: Drive, has_foes: bool, *, decides: bool
    ) -> tuple[Snapshot, CompletedPlan, PilotMemory, int]:
        """Return P⁺: as it is, unless an event activates the pilot (F&L 1991, §2); then the snapshot gets its foes if it has
        none yet. Last is how often the pilot ran."""
        plan, memory = drive.plan, notice(snapshot, drive.memory)
        has = snapshot.parameters.has
        ahead = passages_ahead(self.graph, plan, self.limits, snapshot.passages)
        no_command = drive.last is not None and drive.last.emergency and not drive.last.hazard and has(Mechanism.FEEDBACK)
        events = detect(snapshot, plan, ahead, drive.completed, memory, no_command) if decides else ()
        runs_always = decides and not has(Mechanism.EVENTS)
        if not events and drive.completed is not None and not runs_always:
            return snapshot, drive.completed, memory, 0
        if not has_foes:
            snapshot = self._with_foes(snapshot, traffic, plan)
        is_stuck = memory.behaviour is Behaviour.GIVING_WAY or any(one.kind is EventKind.NO_PROGRESS for one in events)
        foreseen = outlook(traffic, snapshot, plan, self.graph, self.limits, looks_around=is_stuck)
        style = Style(self.profile is Profile.PAPER, self.delays)
        view = view_of(snapshot, plan, self.limits, ahead)
        completed, memory = self.parts.pilot(view, foreseen, events, memory, style)
        if completed.request.what is Replanning.TIMES:
            stops = still_to_serve(plan, memory, snapshot.time)
            times = retimed(plan, snapshot.s, snapshot.ego.speed, snapshot.time, self.limits, stops)
            completed, memory = completed.timed(times), memory._replace(schedule=times)
        return snapshot, completed, memory, 1

    def _valley(self, drive: Drive, snapshot: Snapshot, traffic: Traffic) -> ValleyMap:
        """The bitmaps that hold the ego, drawn anew when it leaves them or C changes."""
        pose = snapshot.ego.pose
        if len(drive.valley.bitmaps) and drive.valley.holds(pose.x, pose.y, MAP_MARGIN_M):
            return drive.valley
        plan, (x, y, _) = drive.plan, drive.plan.curve.at(snapshot.s)
        static = static_within(self.graph, plan, self.limits.vehicle_class, (x, y), MAP_SIDE_M, traffic.static)
        return valley_map(plan.curve, snapshot.s, pose.heading, self.limits.wheelbase, static, self.limits.parameters)


def moved(traffic: Traffic, duration: float) -> Traffic:
    """Foresee the others `duration` s on: gaining or losing speed as they do, along their heading."""
    users = tuple(_moved(user, duration) for user in traffic.users)
    return replace(traffic, time=traffic.time + duration, users=users, as_packed=None)


def _moved(user: RoadUser, duration: float) -> RoadUser:
    speed = max(user.speed + user.acceleration * duration, 0.0)
    way = 0.5 * (user.speed + speed) * duration
    return user._replace(
        speed=speed,
        x=user.x + way * math.cos(user.heading),
        y=user.y + way * math.sin(user.heading),
        lane_position=user.lane_position + way,
    )


def replanned(drive: Drive, plan: NominalPlan, time: float) -> Drive:
    """Return the drive on a new plan, which begins at the ego's front axle, inherits the delay and has no move under way."""
    late, memory = drive.plan.on_schedule(drive.s, time)[0], drive.memory._replace(move=None)
    return drive._replace(plan=replace(plan, times=plan.times - late), s=0.0, memory=memory, valley=NO_MAP, d=None)
