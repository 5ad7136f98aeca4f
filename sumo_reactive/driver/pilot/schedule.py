"""The adjusted time constraints of P⁺: shifted by the delay as in the paper, or planned anew (F&L 1991, §2)."""

from __future__ import annotations

from sumo_reactive.driver.ablation import Mechanism
from sumo_reactive.driver.nouns.completed_plan import Replanning
from sumo_reactive.driver.nouns.constraint import TimeConstraint
from sumo_reactive.driver.nouns.event import Event, EventKind
from sumo_reactive.driver.nouns.plan import NominalPlan
from sumo_reactive.driver.nouns.snapshot import Snapshot
from sumo_reactive.driver.parameters import Delays
from sumo_reactive.driver.pilot.memory import PilotMemory

_LATE = (EventKind.DELAY, EventKind.CONSTRAINT_MISSED)


def adjusted(
    snapshot: Snapshot, plan: NominalPlan, memory: PilotMemory, events: tuple[Event, ...], delays: Delays
) -> tuple[tuple[TimeConstraint, ...], Replanning, PilotMemory]:
    """Return the (l, t_l) ahead, whether the planner is to be asked for new ones, and the delay that is now allowed for."""
    late = max(plan.on_schedule(snapshot.s, snapshot.time)[0], 0.0)
    if memory.premises is None or memory.premises.plan is not plan:
        memory = memory._replace(schedule=plan.time_constraints, delay=late)
    replanning = Replanning.NOTHING
    if any(event.kind in _LATE for event in events):
        memory = memory._replace(delay=late)
        if not snapshot.parameters.has(Mechanism.DELAYS):
            pass
        elif delays is Delays.SHIFT:
            shifted = tuple(TimeConstraint(c.s, c.time + memory.delay) for c in plan.time_constraints)
            memory = memory._replace(schedule=shifted)
        else:
            replanning = Replanning.TIMES
    ahead = tuple(constraint for constraint in memory.schedule if constraint.s > snapshot.front)
    return ahead, replanning, memory
