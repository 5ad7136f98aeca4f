"""The room behind an intersection: a stop so near behind it that the ego would stand in a region is made before its line."""

from dataclasses import replace

import pytest
from helpers.situations import before

from sumo_reactive.driver.nouns.constraint import stop_at
from sumo_reactive.driver.nouns.decision import Occupancy, Reason
from sumo_reactive.driver.pilot.passages import crossings
from sumo_reactive.driver.pilot.rules.post_conflict import is_clear_at, states_of, taken_by, wait_before
from sumo_reactive.driver.world.regions import ConflictKind

NORTH = ("from_south", "to_north")


def moved(away: float, speed: float, behind: float, reason: Reason) -> float | None:
    """Return how far from its line the ego stops (m) that meant to stop `behind` m behind the place where it is clear."""
    ego = before("four_way_priority", NORTH, away, speed)
    situation = ego.considered()
    way = situation.ways[0]
    stop = stop_at(is_clear_at(way, situation.limits) + behind, reason)
    found = wait_before(way, (stop,), situation.snapshot, situation.memory, situation.limits)
    return None if found is None else found.s - ego.line


@pytest.mark.parametrize("reason", [Reason.NO_GAP, Reason.RED_LIGHT, Reason.YIELD_TO])
def test_whoever_would_stand_in_the_junction_waits_before_its_line(reason):
    assert moved(20.0, 5.0, -1.0, reason) == pytest.approx(0.0)


def test_who_stands_clear_of_every_region_waits_there():
    assert moved(20.0, 5.0, 0.5, Reason.NO_GAP) is None


def test_a_stop_of_the_route_is_made_where_the_route_says():
    assert moved(20.0, 5.0, -1.0, Reason.SCHEDULED_STOP) is None


def test_a_full_stop_is_made_at_its_own_line_however_near_behind_the_junction():
    assert moved(20.0, 5.0, -1.0, Reason.STOP_SIGN) is None


def test_who_can_no_longer_stop_before_the_line_goes_on():
    assert moved(3.0, 8.0, -1.0, Reason.NO_GAP) is None


def test_of_several_stops_inside_the_nearest_is_the_one_that_is_moved_before_the_line():
    ego = before("four_way_priority", NORTH, 20.0, 5.0)
    situation = ego.considered()
    way = situation.ways[0]
    stops = [stop_at(ego.line + m, Reason.NO_GAP, cause=f"{m:g} m") for m in (9.0, 4.0, 6.0)]
    found = wait_before(way, stops, situation.snapshot, situation.memory, situation.limits)
    assert found == stop_at(ego.line, Reason.NO_GAP, cause="4 m")


@pytest.mark.parametrize(("along", "takes_it"), [(0.0, True), (2.0, True), (-8.0, False)])
def test_who_comes_towards_the_ego_out_of_the_room_behind_does_not_take_it(along, takes_it):
    """He turns off through the corridor; who stands there or crawls on stays."""
    ego = before("four_way_priority", NORTH, 20.0, 5.0)
    x = ego.other("x", "to_north_0", 6.0, abs(along), ("to_north",))
    situation = ego.considered(x)
    way = situation.ways[0]
    (there,) = (obstacle._replace(along=along, across=0.0) for obstacle in situation.snapshot.on_path)
    snapshot = situation.snapshot._replace(on_path=(there,))
    assert taken_by(way, snapshot, situation.memory, situation.limits) == ("x" if takes_it else "")


@pytest.mark.parametrize(
    ("blocked", "before_it", "past", "expected"),
    [
        (None, None, -1.0, (Occupancy.FREE, "", False)),
        (None, None, 1.0, (Occupancy.OWN, "", False)),
        ("x", None, -1.0, (Occupancy.OCCUPIED, "x", True)),
        (None, "red", -1.0, (Occupancy.FREE, "red", True)),
    ],
)
def test_the_room_behind_is_free_taken_waited_for_or_the_egos(blocked, before_it, past, expected):
    ego = before("four_way_priority", NORTH, 20.0, 5.0)
    situation = ego.considered()
    way, limits = situation.ways[0], situation.limits
    waits = [name and stop_at(way.line, Reason.EXIT_BLOCKED, cause=name) for name in (blocked, before_it)]
    (state,) = states_of(way, *waits, way.passage.start + past, limits)
    assert (state.occupancy, state.cause, state.waits) == expected
    assert (state.start, state.end) == (way.post, is_clear_at(way, limits) + limits.standstill_gap)


@pytest.mark.parametrize(("behind", "place"), [(-0.5, 0.0), (0.5, None)])
def test_who_is_longer_than_the_way_to_the_next_line_waits_before_the_junction(behind, place):
    ego = before("four_way_priority", NORTH, 20.0, 5.0)
    situation = ego.considered()
    index, connection, conflicts = situation.ahead[0]
    merging = tuple(c._replace(must_yield=False) for c in conflicts if c.region.kind is ConflictKind.MERGING)
    assert merging
    (way,) = crossings(situation.snapshot, situation.plan, ((index, connection, merging),))
    long = replace(situation.limits, length=16.0)
    stop = stop_at(way.passage.start + long.length + behind, Reason.YIELD_TO)
    found = wait_before(way, (stop,), situation.snapshot, situation.memory, long)
    assert (None if found is None else found.s - ego.line) == place


@pytest.mark.parametrize(
    ("nodes", "before_it"),
    [
        ((), 0.0),
        (((-1.8, -0.9),), 1.8),
        (((-2.2, -1.1),), 0.0),  # the front finds room between them
        (((-3.8, -0.9),), 3.8),
        (((-4.0, -0.9),), 0.0),  # a junction of its own
        (((-3.0, -2.2), (-1.6, -0.4)), 3.0),
    ],
)
def test_where_the_map_divides_the_road_just_before_a_junction_the_ego_stops_before_the_node(nodes, before_it):
    """Each of the `nodes` from and to so far behind the stop line, m."""
    ego = before("four_way_priority", NORTH, 20.0, 5.0)
    situation = ego.considered()
    index, connection, conflicts = situation.ahead[0]
    passage = situation.plan.passages[index]
    divided = [replace(passage, start=passage.start + start, end=passage.start + end) for start, end in nodes]
    plan = replace(situation.plan, passages=(*divided, *situation.plan.passages[index:]))
    (way,) = crossings(situation.snapshot, plan, ((len(divided), connection, conflicts),))
    assert passage.start - way.line == pytest.approx(before_it)
