"""What the pilot looks at when an event has activated it, and the form in which a behaviour states itself."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from sumo_reactive.driver.nouns.assessment import Assessment
from sumo_reactive.driver.nouns.constraint import TimeConstraint
from sumo_reactive.driver.nouns.decision import Behaviour, Decision, Instruction
from sumo_reactive.driver.nouns.event import Event
from sumo_reactive.driver.nouns.forecast import Outlook
from sumo_reactive.driver.nouns.plan import Aside, NominalPlan
from sumo_reactive.driver.nouns.snapshot import PathObstacle, Snapshot
from sumo_reactive.driver.pilot.memory import PilotMemory
from sumo_reactive.driver.pilot.passages import Ahead, Crossing, View
from sumo_reactive.driver.pilot.rules.highway_code import HIGHWAY_CODE, Rule
from sumo_reactive.driver.vehicle.limits import VehicleLimits


class Proof(NamedTuple):
    """The manoeuvre that meets nobody, or who or what forbids it (a user's id, or words), and for how long it lasts, s.

    `only_margin`: it would meet that user only if he came earlier than foreseen. `passes`: who is passed, the last first.
    """

    aside: Aside | None
    obstacle: str = ""
    duration: float = 0.0
    only_margin: bool = False
    passes: tuple[str, ...] = ()


class LaneChanging(NamedTuple):
    """What to do about the next lane change.

    Begin it now to `side` (0: not now), stop at the latest by `stop`, and meanwhile stay behind `slot`, the vehicle on
    the other lane that the ego will follow. `why`: the reason for a change that the route does not need, or for calling off
    one that has begun (`calls_off`), or who is asked to let the ego in. `wishes`: there is no gap yet for one that the ego
    would rather make.
    """

    side: int = 0
    stop: TimeConstraint | None = None
    slot: str = ""
    why: Decision | None = None
    calls_off: bool = False
    wishes: bool = False


class Situation(NamedTuple):
    """The snapshot and what follows from it.

    `ways`: the passages in sight, in the order of `ahead`; `ahead_of_ego`: X, whom it would follow; `stop`: the nearest
    place to stop at; `assessment`: how the plan would end; `outlook`: the others' forecast and the room beside C; `proof`
    that X can be passed, or why not (None: there is no reason to pass); `changing`: what the lane beside asks for.
    """

    snapshot: Snapshot
    plan: NominalPlan
    limits: VehicleLimits
    memory: PilotMemory
    events: tuple[Event, ...]
    ahead: Ahead
    ways: tuple[Crossing, ...]
    ahead_of_ego: PathObstacle | None
    stop: TimeConstraint | None
    assessment: Assessment
    outlook: Outlook
    proof: Proof | None = None
    changing: LaneChanging = LaneChanging()

    @property
    def view(self) -> View:
        """The part of it that the highway code looks at."""
        return View(self.snapshot, self.plan, self.limits, self.ahead, self.ways)


def next_on_way(snapshot: Snapshot) -> PathObstacle | None:
    """Return X: the nearest body in the corridor that drives along C or stands."""
    along = (obstacle for obstacle in snapshot.on_path if abs(obstacle.across) <= max(obstacle.along, 0.5))
    return min(along, key=lambda obstacle: obstacle.start, default=None)


Condition = Callable[[Situation], bool]


class BehaviourRule(NamedTuple):
    """A behaviour in the paper's form (F&L 1991, §2): it may begin when all preconditions hold, gives the instruction, asks
    these rules of the highway code, and ends when all postconditions hold."""

    behaviour: Behaviour
    preconditions: tuple[Condition, ...]
    instruction: Callable[[Situation], Instruction]
    postconditions: tuple[Condition, ...]
    asks: frozenset[Rule] = HIGHWAY_CODE

    def may_begin(self, situation: Situation) -> bool:
        """Whether every precondition holds."""
        return all(holds(situation) for holds in self.preconditions)

    def has_ended(self, situation: Situation) -> bool:
        """Whether every postcondition holds."""
        return all(holds(situation) for holds in self.postconditions)
