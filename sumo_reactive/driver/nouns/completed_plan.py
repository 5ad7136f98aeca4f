"""The completed plan P⁺ = P with adjusted time constraints and a symbolic instruction (F&L 1991, §1.3)."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from enum import Enum
from functools import cached_property

from sumo_reactive.driver.nouns.assessment import NOT_ASSESSED, Assessment
from sumo_reactive.driver.nouns.constraint import TimeConstraint
from sumo_reactive.driver.nouns.decision import Behaviour, Decision, Instruction, PostConflictState, Reason, RegionState
from sumo_reactive.driver.nouns.event import Event
from sumo_reactive.driver.nouns.plan import Aside, Move, NominalPlan


class Intent(Enum):
    """What a standing or creeping ego tells the others: it drives, it yields, or it goes next."""

    DRIVE = "drive"
    YIELD = "yield"
    GO_NEXT = "go next"


@dataclass(frozen=True, slots=True)
class Weights:
    """Weights w₁, w₂, w₃ of U = w₁U₁ + w₂U₂ + w₃U₃ (per m, dimensionless, per m/s)."""

    valley: float
    shadow: float
    velocity: float


@dataclass(frozen=True, slots=True)
class VelocityProfile:
    """Accelerate–cruise–decelerate over d₂ (F&L 1991, §3.3.3), as shares of the vehicle's comfortable values.

    `headway`: share of the driver's time headway that is kept to leaders.
    """

    acceleration: float = 1.0
    deceleration: float = 1.0
    headway: float = 1.0


@dataclass(frozen=True, slots=True)
class Tuning:
    """What an instruction changes in the executor: the weights of U and the way v_d is set (F&L 1991, §3.2)."""

    weights: Weights
    profile: VelocityProfile = VelocityProfile()
    wide_grid: bool = False


class Replanning(Enum):
    """What the pilot asks of the planner."""

    NOTHING = "nothing"
    CURVE = "a curve from where the ego is"
    ROUTE = "another way to the goal, for a turn is missed"
    TIMES = "time constraints that recover the delay"


@dataclass(frozen=True, slots=True, kw_only=True)
class Request:
    """What the pilot asks of the planner, once. A new curve begins a lane change (`change_lane` +1 left, −1 right, 0 none)
    or leads `aside`, its places in m of the present C, or begins on lane `onto` that the car has turned into, its edge at
    `route_index`. On a lane that it `stays` on, the car does not come back on this edge."""

    what: Replanning = Replanning.NOTHING
    change_lane: int = 0
    aside: Aside | None = None
    onto: str = ""
    route_index: int = 0
    stays: bool = False


@dataclass(frozen=True, kw_only=True)
class CompletedPlan:
    """P⁺: what the executor tracks until the pilot says otherwise.

    `constraints` is all that limits the ego beside the road and the bodies ahead: the adjusted (l, t_l) of P, places to
    stop at, the vehicle to fall in behind. `sight` (m) asks perception to look so far ahead along the oncoming lane.
    `events` activated the pilot, `assessment` is what it foresaw, `regions` the conflict regions on the way: all as of its
    last activation. `move`: the arc to drive instead of C, in a turn in several moves. `let_go`: whom a standing ego lets go
    although they would wait for it.
    """

    plan: NominalPlan
    behaviour: Behaviour
    instruction: Instruction
    tuning: Tuning
    constraints: tuple[TimeConstraint, ...]
    intent: Intent
    decisions: tuple[Decision, ...]
    request: Request = Request()
    sight: float = 0.0
    assessment: Assessment = NOT_ASSESSED
    events: tuple[Event, ...] = ()
    regions: tuple[RegionState, ...] = ()
    rooms: tuple[PostConflictState, ...] = ()
    move: Move | None = None
    let_go: tuple[str, ...] = ()

    @cached_property
    def hard(self) -> tuple[TimeConstraint, ...]:
        """The places to stop at, in the order of `constraints`; so are the others below, each sorted out once for all steps
        in which the plan is in force."""
        return tuple(one for one in self.constraints if one.is_hard)

    @cached_property
    def timed_ones(self) -> tuple[TimeConstraint, ...]:
        """The (l, t_l) that set no more than the desired speed."""
        return tuple(one for one in self.constraints if not one.is_hard and one.time < math.inf)

    @cached_property
    def speeds(self) -> tuple[TimeConstraint, ...]:
        """What the ego is to be no faster at."""
        return tuple(one for one in self.constraints if one.speed < math.inf)

    @cached_property
    def slots(self) -> tuple[TimeConstraint, ...]:
        """Whom the ego falls in behind."""
        return tuple(one for one in self.constraints if one.behind)

    @cached_property
    def schedule(self) -> tuple[TimeConstraint, ...]:
        """The (l, t_l) of P."""
        return tuple(one for one in self.constraints if one.reason is Reason.ON_SCHEDULE)

    @cached_property
    def stop(self) -> TimeConstraint | None:
        """The nearest place to stop at (None: there is none)."""
        return min(self.hard, key=lambda one: one.s, default=None)

    def held(self) -> CompletedPlan:
        """Return the plan as it stays in force until the next event: what it asked for once is not asked again."""
        return replace(self, request=Request(), events=())

    def timed(self, schedule: tuple[TimeConstraint, ...]) -> CompletedPlan:
        """Return the plan with another schedule: the (l, t_l) of P."""
        rest = tuple(one for one in self.constraints if one.reason is not Reason.ON_SCHEDULE)
        return replace(self, constraints=(*schedule, *rest))

    @property
    def awaits_plan(self) -> bool:
        """Whether it asks for another curve or route, which the trip plans when the simulation step is over."""
        return self.request.what in (Replanning.CURVE, Replanning.ROUTE)

    def after(self, before: CompletedPlan) -> CompletedPlan:
        """Return the plan with the events and the request for a curve or route of the one `before` it in the same step."""
        request = before.request if before.awaits_plan else self.request
        return replace(self, request=request, events=(*before.events, *self.events))
