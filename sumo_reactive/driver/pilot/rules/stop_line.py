"""The stop line: what light and sign ask for before it (F&L 1991, §2)."""

from __future__ import annotations

import math

from sumo_reactive.driver.nouns.constraint import TimeConstraint, stop_at
from sumo_reactive.driver.nouns.decision import Behaviour, Decision, Reason
from sumo_reactive.driver.nouns.snapshot import Snapshot
from sumo_reactive.driver.nouns.state import STANDING_SPEED
from sumo_reactive.driver.pilot.memory import PilotMemory
from sumo_reactive.driver.pilot.passages import Crossing
from sumo_reactive.driver.pilot.rules.lights import Signal, green_at, has_passed, letter_of, signal
from sumo_reactive.driver.pilot.rules.scheduled_stop import STOP_REACHED_M
from sumo_reactive.driver.vehicle.limits import VehicleLimits
from sumo_reactive.driver.vehicle.safe_speed import HARD_STOP_MARGIN_M
from sumo_reactive.driver.world.junction import Control

_FULL_STOP = (Control.STOP, Control.ALL_WAY_STOP)
_REASONS = {Signal.STOP: Reason.RED_LIGHT, Signal.STOP_ON_YELLOW: Reason.YELLOW_LIGHT}


def stop_at_line(
    way: Crossing, snapshot: Snapshot, memory: PilotMemory, limits: VehicleLimits
) -> tuple[TimeConstraint | None, Decision | None, PilotMemory]:
    """Return the stop that light or sign ask for before the line, the decision to pass a light that changed too late,
    and the memory of a full stop once it is made."""
    connection, place = way.connection, _place(way, snapshot)
    to_line = way.passage.start - snapshot.front
    if has_passed(way.passage.start, snapshot.front):
        return None, None, memory
    letter, light = letter_of(connection, snapshot), connection.light.light_id if connection.light else ""
    to_stop = to_line - HARD_STOP_MARGIN_M if letter in "yY" else to_line
    p, speed = snapshot.parameters, snapshot.ego.speed
    asked = Signal.GO
    if letter:
        asked = signal(letter, to_stop, speed, limits.emergency_deceleration, p.yellow_deceleration)
    memory, since = _yellow_since(connection.id, letter, snapshot.time, memory)
    red = snapshot.yellow_until.get(light, math.inf if since is None else since + p.yellow_s)
    if asked is Signal.GO_ON_YELLOW and _comes_too_late(way, snapshot, limits, red):
        asked = Signal.STOP_ON_YELLOW
    if asked in _REASONS:
        return stop_at(place, _REASONS[asked], cause=light, until=green_at(connection, snapshot)), None, memory
    if asked is Signal.GO_ON_YELLOW:
        needed = snapshot.ego.speed**2 / (2.0 * max(to_line, 0.1))
        figures = (("to_line_m", to_line), ("braking_needed_m_s2", needed))
        why = Decision(
            behaviour=Behaviour.CROSSING, reason=Reason.YELLOW_TOO_CLOSE, cause=light, passes=True, figures=figures
        )
        return None, why, memory
    due = asked is Signal.STOP_THEN_GO or (not letter and connection.control in _FULL_STOP)
    if not due or memory.stopped_at == connection.id:
        return None, None, memory
    if snapshot.ego.speed < STANDING_SPEED and place - snapshot.front < STOP_REACHED_M:
        return None, None, memory._replace(stopped_at=connection.id, stopped_since=snapshot.time)
    return stop_at(place, Reason.STOP_SIGN), None, memory


def _yellow_since(name: str, letter: str, time: float, memory: PilotMemory) -> tuple[PilotMemory, float | None]:
    """Return since when a connection's light is yellow, s (None: it is not), and the memory of it."""
    others = tuple(one for one in memory.yellows if one[0] != name)
    if letter not in ("y", "Y"):
        return (memory._replace(yellows=others) if len(others) < len(memory.yellows) else memory), None
    since = dict(memory.yellows).get(name, time)
    return memory._replace(yellows=(*others, (name, since))), since


def _comes_too_late(way: Crossing, snapshot: Snapshot, limits: VehicleLimits, red: float) -> bool:
    """Whether the ego passes the line hardly before `red` (s) or later, at its speed or since it means to stop behind it (at
    a second line, or a queue) or to turn there, and can still stop by braking harder than for a fresh yellow: as hard as for
    a red without yellow, where it would pass at red in any case."""
    speed, to_line = snapshot.ego.speed, way.passage.start - snapshot.front
    is_red = snapshot.time + to_line / speed > red
    hardest = limits.emergency_deceleration if is_red else limits.service_deceleration
    if speed * speed > 2.0 * hardest * max(to_line - HARD_STOP_MARGIN_M, 0.0):
        return False
    to_turn = to_line + 0.5 * (way.passage.end - way.passage.start)
    places = (max(way.stop - snapshot.front, to_line), 0.0), (to_turn, way.pace)
    latest = max(_time_to_line(to_line, speed, place, slow, limits) for place, slow in places)
    return snapshot.time + latest > red - snapshot.parameters.red_margin_s


def _time_to_line(to_line: float, speed: float, to_place: float, slow: float, limits: VehicleLimits) -> float:
    """Return when an ego that brakes comfortably to be as `slow` (m/s) at a place behind the line passes that, s; at its
    speed, if it need not brake for that."""
    if to_place == math.inf or slow >= speed:
        return to_line / speed
    gone = speed * speed - slow * slow
    braking_way = min(gone / (2.0 * limits.comfort_deceleration), to_place)
    before, rate = to_place - braking_way, gone / (2.0 * braking_way)
    lost = math.sqrt(max(speed * speed - 2.0 * rate * max(to_line - before, 0.0), 0.0))
    return min(to_line, before) / speed + (speed - lost) / rate


def _place(way: Crossing, snapshot: Snapshot) -> float:
    """Where to stop before a junction, m of C: where nobody's way reaches over, or the line once that is passed or takes
    braking harder than planned."""
    line = way.passage.start
    if way.line <= snapshot.front:
        return line
    stops = snapshot.front + HARD_STOP_MARGIN_M + snapshot.ego.speed**2 / (2.0 * snapshot.parameters.planned_deceleration)
    return min(max(way.line, stops), line)
