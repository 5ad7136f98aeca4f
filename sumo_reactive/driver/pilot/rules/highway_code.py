"""What the highway code asks of the ego now: places to stop at, and where it may go on (F&L 1991, §2)."""

from __future__ import annotations

import math
from enum import Enum
from typing import NamedTuple

from sumo_reactive.driver.nouns.assessment import Encounter
from sumo_reactive.driver.nouns.constraint import TimeConstraint, stop_at
from sumo_reactive.driver.nouns.decision import Behaviour, Decision, Occupancy, PostConflictState, Reason, RegionState
from sumo_reactive.driver.nouns.snapshot import Conflict, Foe, Snapshot
from sumo_reactive.driver.nouns.state import STANDING_SPEED
from sumo_reactive.driver.pilot.memory import PilotMemory
from sumo_reactive.driver.pilot.passages import Crossing, Exit, View
from sumo_reactive.driver.pilot.rules import post_conflict, region, scheduled_stop, stop_line
from sumo_reactive.driver.pilot.rules.gaps import Judgement
from sumo_reactive.driver.vehicle.limits import VehicleLimits

_RECORDED_S = 10.0
"""A foe whom the ego goes before or after is recorded when it comes within this time."""

Wait = tuple[TimeConstraint, Decision]
"""A place to stop at, and why."""


class Rule(Enum):
    """What the highway code knows; a behaviour names what it asks."""

    STOP_LINE = "light and sign before the line"
    REGION = "who goes first through a conflict region"
    POST_CONFLICT = "the room behind a conflict region"
    SCHEDULED_STOP = "the stops of the route"
    LANE_GAP = "the gap on the lane beside"


NO_RULE: frozenset[Rule] = frozenset()
HIGHWAY_CODE: frozenset[Rule] = frozenset(Rule)


class Rules(NamedTuple):
    """Every place to stop at, the decisions to go on although somebody comes, the regions of the next passage; `judged`:
    the foes who matter at any passage; `exits`: what is behind each; `arrivals`: when the ego may be where it goes after
    somebody; `met`: whom it would meet first in a region if it went on; `rooms`: the state of the room behind each."""

    stops: tuple[Wait, ...]
    passes: tuple[Decision, ...]
    regions: tuple[RegionState, ...]
    judged: tuple[Judgement, ...]
    exits: tuple[Exit, ...] = ()
    arrivals: tuple[TimeConstraint, ...] = ()
    met: Encounter | None = None
    rooms: tuple[PostConflictState, ...] = ()


def ask(
    view: View, asked: frozenset[Rule], change: TimeConstraint | None, memory: PilotMemory
) -> tuple[Rules, PilotMemory]:
    """Ask for what the rules `asked` say, and for each passage: its line, its regions, the room behind them.

    `change`: where to stop for a gap on the lane beside. The farthest passage is asked first: who means to stop behind a
    region, there or behind a queue, leaves it later, and who would stop so near behind that it stands in one waits before.
    """
    snapshot, limits, met = view.snapshot, view.limits, view.met
    scheduled = None
    if Rule.SCHEDULED_STOP in asked:
        scheduled, memory = scheduled_stop.serve(snapshot, view.plan, memory)
    change = post_conflict.clear_of(change, view.ways, view.plan, snapshot.front, limits) if Rule.LANE_GAP in asked else None
    stops = [(stop, decision_of(stop)) for stop in (scheduled, change) if stop is not None]
    queue = [leader.s - limits.standstill_gap for leader in snapshot.leaders if leader.speed < STANDING_SPEED]
    foes = region.without_queues(snapshot.foes)
    found: list[Rules] = []
    shown = next((way.number for way, conflicts in met if conflicts), None)
    for way, conflicts in reversed(met):
        places = [*queue, *(stop.s for stop, _ in stops)]
        behind = min((place for place in places if place > way.passage.end), default=math.inf)
        way = way._replace(stop=behind)
        rules, memory = _passage(view, asked, way, conflicts, foes, memory)
        if way.number != shown:
            rules = rules._replace(regions=())
        before, later = None, tuple(stop for stop, _ in stops)
        if Rule.POST_CONFLICT in asked:
            before = post_conflict.wait_before(way, later, snapshot, memory, limits)
            rules = _with_room_behind(rules, way, later, before, view)
        stops.extend([] if before is None else [(before, decision_of(before))])
        stops.extend(wait for wait in rules.stops if wait[0].s >= snapshot.front - limits.front_overhang)
        found.insert(0, rules)
    passes = tuple(decision for rules in found for decision in rules.passes)
    regions = tuple(state for rules in found for state in rules.regions)
    judged = tuple(one for rules in found for one in rules.judged)
    exits = tuple(one for rules in found for one in rules.exits)
    arrivals = tuple(one for rules in found for one in rules.arrivals)
    first = next((rules.met for rules in found if rules.met is not None), None)
    rooms = tuple(one for rules in found for one in rules.rooms)
    return Rules(tuple(stops), passes, regions, judged, exits, arrivals, first, rooms), memory


def _passage(
    view: View,
    asked: frozenset[Rule],
    way: Crossing,
    conflicts: tuple[Conflict, ...],
    foes: tuple[Foe, ...],
    memory: PilotMemory,
) -> tuple[Rules, PilotMemory]:
    """Return what one passage asks for, with the states of its regions."""
    snapshot, limits, at_line, late = view.snapshot, view.limits, None, None
    if Rule.STOP_LINE in asked:
        at_line, late, memory = stop_line.stop_at_line(way, snapshot, memory, limits)
    stops = [] if at_line is None else [(at_line, decision_of(at_line))]
    found = list(region.judgements(way, foes, view, memory)) if Rule.REGION in asked else []
    waits = [(place, judgement) for judgement, place in found if place is not None]
    met = None
    if waits:
        place, first = min(waits, key=lambda wait: wait[0])
        until = math.inf  # beside the lane that it merges into, the ego keeps up its speed for a gap there
        if view.plan.merging(snapshot.front) is None:
            until = snapshot.time + region.opens_at((judgement for judgement, _ in found), place, way, view)
        stops.append((stop_at(place, first.reason, first.region, first.foe.user.id, until), first.decision))
        met = region.encounter_of(min((one for _, one in waits), key=lambda one: one.own.arrival), way, view)
    blocker = post_conflict.taken_by(way, snapshot, memory, limits) if Rule.POST_CONFLICT in asked else ""
    if blocker:
        stop = stop_at(way.line, Reason.EXIT_BLOCKED, region=way.connection.id, cause=blocker)
        stops.append((stop, decision_of(stop)))
    passes = tuple(judgement.decision for judgement, _ in found if judgement.passes and _is_worth_a_word(judgement))
    states = _states(way, conflicts, snapshot, limits, [judgement for judgement, _ in found])
    judged = tuple(judgement for judgement, _ in found)
    arrivals = () if waits else tuple(region.arrivals_of((judgement for judgement, _ in found), way, snapshot))
    return Rules(tuple(stops), passes if late is None else (late, *passes), states, judged, (), arrivals, met), memory


def _with_room_behind(
    rules: Rules, way: Crossing, later: tuple[TimeConstraint, ...], before: TimeConstraint | None, view: View
) -> Rules:
    """Return what a passage asks for with what was found behind it, where the stops `later` are and which of them is made
    `before`."""
    blocked = next((stop for stop, _ in rules.stops if stop.reason is Reason.EXIT_BLOCKED), None)
    rooms = post_conflict.states_of(way, blocked, before, view.snapshot.front, view.limits)
    return rules._replace(exits=(Exit(way, later, blocked is not None, before is not None),), rooms=rooms)


def _is_worth_a_word(judgement: Judgement) -> bool:
    return judgement.foe.conflict.must_yield and judgement.other.arrival < _RECORDED_S


def _states(
    way: Crossing,
    conflicts: tuple[Conflict, ...],
    snapshot: Snapshot,
    limits: VehicleLimits,
    judgements: list[Judgement],
) -> tuple[RegionState, ...]:
    """Return the state of every region of a passage: one vehicle at a time."""
    taken: dict[str, RegionState] = {}
    for judgement in judgements:
        inside = judgement.foe.to_region <= 0.0
        if inside or (not judgement.passes and judgement.region not in taken):
            state = Occupancy.OCCUPIED if inside else Occupancy.CLAIMED
            taken[judgement.region] = RegionState(judgement.region, state, judgement.foe.user.id)
    return tuple(taken.get(c.region.id) or _own_state(way, c, snapshot, limits) for c in conflicts)


def _own_state(way: Crossing, conflict: Conflict, snapshot: Snapshot, limits: VehicleLimits) -> RegionState:
    own, front = conflict.region.own, snapshot.front
    held = way.at(own.start) < front and front - limits.length < way.at(own.end)
    return RegionState(conflict.region.id, Occupancy.OWN if held else Occupancy.FREE)


def unconditional_stop(view: View, memory: PilotMemory) -> TimeConstraint | None:
    """Return the first stop that nobody else's doing can put off: at a line, or where the route says (None: none)."""
    snapshot, limits = view.snapshot, view.limits
    lines = (stop_line.stop_at_line(way, snapshot, memory, limits)[0] for way in view.ways)
    stops = (*lines, scheduled_stop.serve(snapshot, view.plan, memory)[0])
    return min((stop for stop in stops if stop is not None), key=lambda stop: stop.s, default=None)


def nearest_stop(waits: tuple[Wait, ...]) -> TimeConstraint | None:
    """Return the first place to stop at."""
    return min((stop for stop, _ in waits), key=lambda stop: stop.s, default=None)


_STOPS_OF = {
    Reason.SCHEDULED_STOP: Behaviour.STOPPING,
    Reason.BLOCKED: Behaviour.STOPPING,
    Reason.NO_GAP: Behaviour.CHANGING_LANES,
    Reason.QUEUE_CHANGE: Behaviour.CHANGING_QUEUES,
    Reason.NARROW_TURN: Behaviour.TURNING_ROUND,
    Reason.COMES_OVER: Behaviour.TURNING_ROUND,
    Reason.STAYS_THERE: Behaviour.TURNING_ROUND,
    Reason.MUTUAL_WAIT: Behaviour.GIVING_WAY,
}
"""The behaviours that ask for stops; all others are made on the approach to an intersection."""


def decision_of(stop: TimeConstraint) -> Decision:
    """Return the decision that a stop stands for."""
    return Decision(
        behaviour=_STOPS_OF.get(stop.reason, Behaviour.CAUTIOUS), reason=stop.reason, region=stop.region, cause=stop.cause
    )
