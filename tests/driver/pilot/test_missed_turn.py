"""When an ego that waits for a gap to change lanes looks for another way."""

from __future__ import annotations

import pytest
from helpers.situations import before

from sumo_reactive.driver.nouns.constraint import TimeConstraint, stop_at
from sumo_reactive.driver.nouns.decision import Reason
from sumo_reactive.driver.nouns.snapshot import Neighbour
from sumo_reactive.driver.nouns.state import CREEPING_SPEED
from sumo_reactive.driver.parameters import USUAL
from sumo_reactive.driver.pilot.behaviours.taking_another_way import AT_LANE_END_M, is_missed, waiting_since
from sumo_reactive.driver.pilot.memory import PilotMemory
from sumo_reactive.driver.view.ahead import passages_ahead

EGO = before("blocked_lane", ("eastbound", "eastbound_out"), 60.0, 0.5)
SNAPSHOT = EGO.seen()


def stop(away: float = 2.0, reason: Reason = Reason.NO_GAP) -> TimeConstraint:
    """A place to stop at, `away` m ahead."""
    return stop_at(SNAPSHOT.front + away, reason)


def waits(place, since: float | None = 7.0, seen=SNAPSHOT) -> float | None:
    """Since when the ego waits for a gap, if it waited since 7 s."""
    return waiting_since(seen, EGO.plan, (), place, PilotMemory(waiting_since=since))


def test_who_creeps_or_stands_for_want_of_a_gap_waits_from_now_on():
    assert waits(stop(), None) == SNAPSHOT.time
    assert waits(stop()) == 7.0


@pytest.mark.parametrize(("letter", "since"), [("r", 50.0), ("u", 50.0), ("y", 50.0), ("G", 7.0), ("g", 7.0), ("o", 7.0)])
def test_a_red_light_before_those_beside_does_not_count_as_waiting_for_a_gap(letter, since):
    ego = before("signalised_left_turns", ("from_south", "to_west"), 20.0, 0.5)
    link = ego.connection.light
    seen = ego.seen(lights={link.light_id: letter * (link.index + 1)})._replace(time=50.0)
    ahead = passages_ahead(ego.graph, ego.plan, ego.limits, seen.passages)
    place, memory = stop_at(seen.front + 2.0, Reason.NO_GAP), PilotMemory(waiting_since=7.0)
    assert waiting_since(seen, ego.plan, ahead, place, memory) == since
    assert waiting_since(seen, ego.plan, (), place, memory) == 7.0


@pytest.mark.parametrize("place", [None, stop(reason=Reason.RED_LIGHT)])
def test_who_stops_for_something_else_does_not_wait_for_a_gap(place):
    assert waits(place) is None


@pytest.mark.parametrize(("speed", "still"), [(CREEPING_SPEED, True), (CREEPING_SPEED + 0.1, False)])
def test_who_drives_does_not_wait(speed, still):
    assert (waits(stop(), seen=EGO.at_speed(speed).seen()) is not None) is still


def missed(waited: float, away: float = 2.0, passing: float | None = 8.0) -> bool:
    """Whether the turn is missed after so long, so far before the lane's end, somebody beside driving with that speed."""
    beside = () if passing is None else (Neighbour(EGO.other("x", "eastbound_0", 10.0, passing, ()), -10.0),)
    memory = PilotMemory(waiting_since=SNAPSHOT.time - waited)
    return is_missed(SNAPSHOT._replace(neighbours=beside), stop(away), memory)


@pytest.mark.parametrize(("waited", "is_over"), [(USUAL.missed_turn_s - 1.0, False), (USUAL.missed_turn_s + 1.0, True)])
def test_at_the_end_of_its_lane_an_ego_that_others_pass_gives_up_soon(waited, is_over):
    assert missed(waited) is is_over


@pytest.mark.parametrize(("away", "passing"), [(2.0, None), (2.0, 0.5), (AT_LANE_END_M + 1.0, 8.0)])
def test_a_queue_may_yet_move_and_so_may_the_ego_on_its_lane(away, passing):
    assert not missed(USUAL.missed_turn_s + 1.0, away, passing)
    assert not missed(USUAL.queue_patience_s - 1.0, away, passing)
    assert missed(USUAL.queue_patience_s + 1.0, away, passing)


def test_who_does_not_wait_misses_nothing():
    assert not is_missed(SNAPSHOT, None, PilotMemory(waiting_since=0.0))
    assert not is_missed(SNAPSHOT, stop(), PilotMemory())
