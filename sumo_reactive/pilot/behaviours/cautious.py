"""Cautious driving: the approach to an intersection, its light and its line (F&L 1991, §2)."""

from __future__ import annotations

from sumo_reactive.messages.completed_plan import Weights
from sumo_reactive.messages.decision import Reason, StopAt
from sumo_reactive.messages.plan import Passage
from sumo_reactive.messages.snapshot import Snapshot
from sumo_reactive.parameters import STANDING_SPEED, STOP_REACHED_M
from sumo_reactive.pilot.lights import Signal, signal
from sumo_reactive.pilot.memory import PilotMemory
from sumo_reactive.vehicle.limits import VehicleLimits
from sumo_reactive.world.junction import Connection, Control

WEIGHTS = Weights(valley=10.0, shadow=0.3, velocity=1.0)

_FULL_STOP = (Control.STOP, Control.ALL_WAY_STOP)
_REASONS = {Signal.STOP: Reason.RED_LIGHT, Signal.STOP_ON_YELLOW: Reason.YELLOW_LIGHT}


def letter_of(connection: Connection, snapshot: Snapshot) -> str:
    """Return the light's letter for a connection, empty when no light speaks."""
    link = connection.light
    if link is None:
        return ""
    letters = snapshot.lights.get(link.light_id, "")
    return letters[link.index] if link.index < len(letters) else ""


def stop_at_line(
    passage: Passage, connection: Connection, snapshot: Snapshot, memory: PilotMemory, limits: VehicleLimits
) -> tuple[StopAt | None, PilotMemory]:
    """Return the stop that light or sign ask for before the line, and the memory of a full stop once it is made."""
    to_line = passage.start - snapshot.front
    if to_line < 0.0:
        return None, memory
    letter = letter_of(connection, snapshot)
    asked = signal(letter, to_line, snapshot.ego.speed, limits.emergency_deceleration) if letter else Signal.GO
    if asked in _REASONS:
        cause = connection.light.light_id if connection.light else ""
        return StopAt(passage.start, _REASONS[asked], cause=cause), memory
    due = asked is Signal.STOP_THEN_GO or (not letter and connection.control in _FULL_STOP)
    if not due or memory.stopped_at == connection.id:
        return None, memory
    if snapshot.ego.speed < STANDING_SPEED and to_line < STOP_REACHED_M:
        return None, memory._replace(stopped_at=connection.id, stopped_since=snapshot.time)
    return StopAt(passage.start, Reason.STOP_SIGN), memory
