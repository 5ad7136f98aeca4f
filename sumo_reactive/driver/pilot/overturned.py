"""What the pilot found at the conflict regions ahead, and behind them, and no longer holds."""

from __future__ import annotations

from collections.abc import Iterator

from sumo_reactive.driver.nouns.event import Event, EventKind
from sumo_reactive.driver.nouns.snapshot import Foe, Snapshot
from sumo_reactive.driver.nouns.state import STANDING_SPEED
from sumo_reactive.driver.pilot.memory import PilotMemory, Premises
from sumo_reactive.driver.pilot.passages import Crossing
from sumo_reactive.driver.pilot.rules.gaps import Judgement, follows_at
from sumo_reactive.driver.pilot.rules.post_conflict import taken_by, wait_before
from sumo_reactive.driver.pilot.rules.region import carried_on, counted, judge, without_queues


def overturned(snapshot: Snapshot, memory: PilotMemory, premises: Premises) -> list[Event]:
    """Return an event for everything found at a region or behind it that is otherwise now, each once."""
    found = [*_at_regions(snapshot, memory, premises), *_behind(snapshot, memory, premises)]
    return list(dict.fromkeys(found))


def _at_regions(snapshot: Snapshot, memory: PilotMemory, premises: Premises) -> Iterator[Event]:
    ways = {way.number: way for way in premises.view.ways}
    waited_for = {key for key, judgement in premises.judged.items() if not judgement.passes}
    for foe in without_queues(snapshot.foes):
        crossing, key = ways.get(foe.passage), (foe.user.id, foe.conflict.region.id)
        waited_for.discard(key)
        if crossing is not None:
            kind = _changed(foe, crossing, premises.judged.get(key), snapshot, memory, premises)
            if kind is not None:
                yield Event(kind, foe.user.id)
    for user_id, _ in sorted(waited_for):
        yield Event(EventKind.CAUSE_VANISHED, user_id)


def _changed(
    foe: Foe,
    crossing: Crossing,
    known: Judgement | None,
    snapshot: Snapshot,
    memory: PilotMemory,
    premises: Premises,
) -> EventKind | None:
    """Return what has become of somebody at a region, of whom the pilot has `known` so much (None: that he does not matter
    there, or nothing)."""
    limits = premises.view.limits
    one = counted(foe, crossing, snapshot, memory, limits)
    if known is None:
        is_new = foe.user.id not in premises.speeds
        return None if one is None else EventKind.NEW_OBSTACLE if is_new else EventKind.OTHER_BEHAVIOUR
    if one is None:
        return None if known.passes else EventKind.CAUSE_VANISHED
    before = premises.view.snapshot
    own = carried_on(known, (before.front, before.ego.speed), crossing, snapshot, limits)
    judgement = judge(one, own, crossing, snapshot, memory, limits)
    if judgement.passes != known.passes:
        return EventKind.GAP_OPENED if judgement.passes else EventKind.GAP_CLOSED
    return EventKind.OTHER_BEHAVIOUR if _clears_otherwise(judgement, known, snapshot, premises) else None


def _clears_otherwise(judgement: Judgement, known: Judgement, snapshot: Snapshot, premises: Premises) -> bool:
    """Whether somebody behind whom the ego means to roll into a region clears it at another time than foreseen."""
    p, moves = snapshot.parameters, snapshot.ego.speed >= STANDING_SPEED
    foreseen = follows_at(known.own, known.foe, known.other, p)
    if not moves or foreseen > p.rolling_s:
        return False
    now = follows_at(judgement.own, judgement.foe, judgement.other, p)
    return abs(snapshot.time + now - premises.time - foreseen) > p.foreseen_tolerance_s


def _behind(snapshot: Snapshot, memory: PilotMemory, premises: Premises) -> Iterator[Event]:
    """Yield the passages behind which there is room now, or no longer, or where a stop behind need not be waited for."""
    limits = premises.view.limits
    for way, stops, was_taken, waited in premises.exits:
        is_taken = bool(taken_by(way, snapshot, memory, limits))
        waits = wait_before(way, stops, snapshot, memory, limits) is not None
        if (is_taken, waits) != (was_taken, waited):
            yield Event(EventKind.ROOM_BEHIND, way.passage.junction_id)
