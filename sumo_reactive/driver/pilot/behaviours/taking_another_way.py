"""A missed turn: the ego waits for a gap to change lanes, and nobody lets it onto the lane that the turn is made from."""

from __future__ import annotations

from sumo_reactive.driver.nouns.constraint import TimeConstraint
from sumo_reactive.driver.nouns.decision import Reason
from sumo_reactive.driver.nouns.snapshot import Snapshot
from sumo_reactive.driver.parameters import AT_LANE_END_M, CREEPING_SPEED, MISSED_TURN_S, QUEUE_PATIENCE_S
from sumo_reactive.driver.pilot.memory import PilotMemory


def waiting_since(snapshot: Snapshot, stop: TimeConstraint | None, memory: PilotMemory) -> float | None:
    """Return since when (s) the ego waits for a gap to change lanes; None: it does not. Who creeps still waits.

    `stop` is the nearest place to stop at.
    """
    if stop is None or stop.reason is not Reason.NO_GAP or snapshot.ego.speed > CREEPING_SPEED:
        return None
    return snapshot.time if memory.waiting_since is None else memory.waiting_since


def is_missed(snapshot: Snapshot, stop: TimeConstraint | None, memory: PilotMemory) -> bool:
    """Whether the ego has waited so long that another way to its goal deserves a look.

    That comes sooner where traffic keeps passing an ego that can go no farther on its lane; a queue may yet move.
    """
    if stop is None or memory.waiting_since is None:
        return False
    is_at_end = stop.s - snapshot.front < AT_LANE_END_M
    are_passing = any(neighbour.user.speed > CREEPING_SPEED for neighbour in snapshot.neighbours)
    patience = MISSED_TURN_S if is_at_end and are_passing else QUEUE_PATIENCE_S
    return snapshot.time - memory.waiting_since > patience
