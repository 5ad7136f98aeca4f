"""The room behind a junction, whom the ego waits for there and how long, and a yellow that a stop behind makes too late."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import pytest
from helpers.cars import CAR
from helpers.situations import Situation, before
from helpers.turning_points import turns_at

from sumo_reactive.driver.nouns.constraint import TimeConstraint, stay_behind, stop_at
from sumo_reactive.driver.nouns.decision import Occupancy, Reason
from sumo_reactive.driver.nouns.plan import PlannedStop
from sumo_reactive.driver.nouns.snapshot import Snapshot
from sumo_reactive.driver.parameters import USUAL
from sumo_reactive.driver.pilot.memory import PilotMemory
from sumo_reactive.driver.pilot.passages import view_of
from sumo_reactive.driver.pilot.rules.highway_code import HIGHWAY_CODE, Rules, ask
from sumo_reactive.driver.pilot.rules.post_conflict import LACKING_M_S
from sumo_reactive.driver.pilot.rules.scheduled_stop import still_to_serve
from sumo_reactive.driver.vehicle.safe_speed import HARD_STOP_MARGIN_M
from sumo_reactive.driver.view.ahead import passages_ahead
from sumo_reactive.driver.world.route import ScheduledStop

SOUTH_NORTH, WEST_EAST = ("from_south", "to_north"), ("from_west", "to_east")
STANDING = before("four_way_priority", SOUTH_NORTH, 1.0, 0.0)
QUEUE = STANDING.other("queue", "to_north_0", 3.5, 0.0, ("to_north",), 20.0)
YELLOW = {"centre": "y" * 12}

ego_at = cache(before)


def asked(ego: Situation, snapshot: Snapshot, change: TimeConstraint | None = None, **connection) -> Rules:
    """What the highway code asks for, the connection of the passage changed."""
    seen = passages_ahead(ego.graph, ego.plan, ego.limits, snapshot.passages)
    ahead = tuple((i, replace(one, **connection), conflicts) for i, one, conflicts in seen)
    return ask(view_of(snapshot, ego.plan, CAR, ahead), HIGHWAY_CODE, change, ego.memory)[0]


def waited(seconds: float) -> Situation:
    """The ego that has stood first before the junction for so long though it may go."""
    since = STANDING.time - seconds
    return STANDING.remembering(standing_since=since, got_on=since, released=(STANDING.connection.id, since))


def stays(ego: Situation, *users, **connection) -> bool:
    """Whether the ego waits for room behind the junction."""
    rules = asked(ego, ego.seen(*users), **connection)
    return any(stop.reason is Reason.EXIT_BLOCKED for stop, _ in rules.stops)


COMING = STANDING.other("comes", "from_west_0", -60.0, 8.0, WEST_EAST)


@pytest.mark.parametrize(("users", "patience"), [((QUEUE,), USUAL.foe_patience_s), ((QUEUE, COMING), USUAL.missed_turn_s)])
def test_a_junction_that_need_not_be_kept_clear_is_kept_clear_for_a_while(users, patience):
    assert turns_at(lambda s: stays(waited(s), *users, keep_clear=False), 0.5, 60.0) == pytest.approx(patience, abs=0.01)
    assert stays(waited(USUAL.queue_patience_s), *users, keep_clear=True)


def test_waiting_counts_only_where_the_light_let_the_ego_go_and_while_it_did_not_get_on():
    since, own = STANDING.time - 50.0, STANDING.connection.id
    another = STANDING.remembering(got_on=since, released=("another", since))
    just_came = STANDING.remembering(got_on=STANDING.time - 1.0, released=(own, since))
    just_green = STANDING.remembering(got_on=since, released=(own, STANDING.time - 1.0))
    for ego in (another, just_came, just_green):
        assert stays(ego, QUEUE, keep_clear=False)


def content_after(place: float) -> float:
    """Return after how long the ego goes although somebody stands `place` m behind the junction, s."""
    jam = STANDING.other("queue", "to_north_0", place, 0.0, ("to_north",), 20.0)
    return turns_at(lambda s: stays(waited(s), jam), 50.0, 400.0)


def test_who_has_waited_in_vain_for_a_lights_cycle_is_content_with_ever_less_room():
    full, lacking = content_after(8.0), content_after(7.0)
    assert full > USUAL.queue_patience_s
    assert lacking - full == pytest.approx(1.0 / LACKING_M_S, abs=0.05)


def test_the_reds_count_as_well_for_who_has_stood_through_a_whole_green():
    jam = STANDING.other("queue", "to_north_0", 8.0, 0.0, ("to_north",), 20.0)
    just_green, own = STANDING.time - 1.0, STANDING.connection.id
    ego = STANDING.remembering(got_on=STANDING.time - content_after(8.0) - 1.0, released=(own, just_green))
    assert stays(ego, jam)
    assert not stays(ego.remembering(lost=own), jam)


NOSE = STANDING.other("nose", "from_west_0", -1.0, 0.0, WEST_EAST, 5.0)


def with_nose(ego: Situation, behind: float = 4.0, **body) -> Snapshot:
    """Somebody who waits at his line, his body in the ego's way this far behind its own line."""
    (obstacle, *_) = ego.seen(ego.ahead("nose", 8.0, 0.0)).on_path
    user, start = NOSE._replace(**{"is_halted": False, **body}), ego.line + behind
    return ego.seen(NOSE)._replace(on_path=(obstacle._replace(user=user, start=start, end=start + 2.0),))


def blocked_by_nose(ego: Situation, snapshot: Snapshot) -> bool:
    return any((s.reason, s.cause) == (Reason.EXIT_BLOCKED, "nose") for s, _ in asked(ego, snapshot, keep_clear=False).stops)


def test_who_waits_with_its_nose_in_the_way_is_waited_for_but_not_for_ever():
    holds = lambda s: blocked_by_nose(waited(s), with_nose(waited(s)))  # noqa: E731
    assert turns_at(holds, 30.0, 200.0) == pytest.approx(USUAL.queue_patience_s, abs=0.01)
    ego = waited(30.0)
    for body in ({"is_halted": True}, {"speed": 5.0}, {"lane_id": ":centre_1_0"}):
        assert not blocked_by_nose(ego, with_nose(ego, **body))


def test_so_is_who_waits_beside_the_road_behind_where_the_ego_turns_out_of_the_junction():
    passage, ego = STANDING.plan.passages[0], waited(30.0)
    behind = passage.end - passage.start + CAR.length
    assert blocked_by_nose(ego, with_nose(ego, behind - 0.1))
    assert not blocked_by_nose(ego, with_nose(ego, behind + 0.1))


def second_line(speed: float, away: float, behind: float, since: float = 100.0) -> bool:
    """Whether the ego stops at a yellow, since it means to stop `behind` m behind the line, or goes on."""
    ego = ego_at("signalised_left_turns", SOUTH_NORTH, away, speed)
    ego = ego.remembering(yellows=((ego.connection.id, since),))
    end = ego.plan.passages[0].end
    leader = stay_behind("queue", end + behind + CAR.standstill_gap, 0.0, 9.0)
    rules = asked(ego, ego.seen(lights=YELLOW)._replace(leaders=(leader,)))
    return any(stop.reason is Reason.YELLOW_LIGHT for stop, _ in rules.stops)


ROWS: dict[str, tuple[Callable[[float], bool], float, float, float]] = {
    "m behind at which a stop makes it late": (lambda m: second_line(13.0, 25.0, m, 99.435), 0.1, 40.0, 8.577),
    "s at which the yellow began": (lambda t: second_line(10.0, 15.0, 5.0, t), 90.0, 100.0, 99.0),
    "m before the line with a stop behind": (lambda m: second_line(10.0, m, 1.0, 98.2), 5.0, 16.0, 11.261),
    "m/s with a stop behind": (lambda v: second_line(v, 8.0, 1.0, 98.1), 7.2, 15.0, 8.404),
    "m before the line when it would pass at red": (lambda m: second_line(10.0, m, 1.0, 97.4), 4.0, 16.0, 5.706),
    "m/s when it would pass at red": (lambda v: second_line(v, 8.0, 1.0, 97.1), 7.2, 15.0, 11.887),
}


@pytest.mark.parametrize("name", ROWS)
def test_a_yellow_that_comes_too_late_for_who_stops_behind_turns_over_at(name):
    holds, low, high, figure = ROWS[name]
    assert turns_at(holds, low, high) == pytest.approx(figure, abs=0.005)


def test_a_queue_behind_that_moves_makes_no_yellow_late():
    ego = ego_at("signalised_left_turns", SOUTH_NORTH, 15.0, 10.0)
    leader = stay_behind("queue", ego.plan.passages[0].end + 3.0, 2.0, 9.0)
    rules = asked(ego, ego.seen(lights=YELLOW)._replace(leaders=(leader,)))
    assert [decision.reason for decision in rules.passes] == [Reason.YELLOW_TOO_CLOSE]


@pytest.mark.parametrize("place", ["before", "inside", "behind"])
def test_the_ego_holds_the_regions_that_its_body_is_in(place):
    ego = before("four_way_priority", SOUTH_NORTH, 12.0, 6.0)
    snapshot, passage = ego.seen(), ego.plan.passages[0]
    scale = (passage.end - passage.start) / ego.connection.path.length
    regions = ego.graph.regions_on(ego.connection)
    front = {"before": snapshot.front, "inside": passage.start + 8.0, "behind": passage.end + CAR.length + 0.5}[place]
    moved = snapshot._replace(front=front, s=front - CAR.front_overhang)
    held = {one.region for one in asked(ego, moved).regions if one.occupancy is Occupancy.OWN}
    inside = {
        region.id
        for region in regions
        if passage.start + region.own.start * scale < front and front - CAR.length < passage.start + region.own.end * scale
    }
    assert held == inside & {one.region for one in asked(ego, moved).regions}
    assert bool(held) is (place == "inside")


STOPS = tuple(PlannedStop(s, ScheduledStop("a_0", s, 20.0, 130.0)) for s in (30.0, 60.0))


def test_of_a_stop_that_is_being_served_what_is_left_of_it_is_still_to_serve():
    plan = replace(STANDING.plan, stops=STOPS)
    served = (STOPS[0].stop,)
    assert still_to_serve(plan, PilotMemory(), 100.0) == STOPS
    assert still_to_serve(plan, PilotMemory(served=served), 100.0) == STOPS[1:]
    assert still_to_serve(plan, PilotMemory(served=tuple(one.stop for one in STOPS), serving_until=7.0), 100.0) == ()
    for now, left in ((100.0, 7.5), (107.3, 0.2), (110.0, 0.0)):
        first, second = still_to_serve(plan, PilotMemory(serving_until=107.5), now)
        assert (first.s, first.stop.lane_id, first.stop.position, first.stop.until) == (30.0, "a_0", 30.0, None)
        assert first.stop.duration == pytest.approx(left)
        assert second == STOPS[1]


def moved_stop(away: float, speed: float, behind_line: float) -> float | None:
    """Return how far behind its line the ego is made to stop that wants to stop there for want of a gap."""
    ego = ego_at("four_way_priority", SOUTH_NORTH, away, speed)
    stop = stop_at(ego.line + behind_line, Reason.NO_GAP, "lane", "x")
    rules = asked(ego, ego.seen(), stop)
    first = min((one for one, _ in rules.stops), key=lambda one: one.s)
    assert (first.reason, first.region, first.cause) == (Reason.NO_GAP, "lane", "x")
    assert len(rules.stops) == (2 if first.s < stop.s else 1)
    return round(first.s - ego.line, 6)


def test_a_stop_inside_a_junction_is_made_before_its_line_where_planned_braking_can():
    clear = turns_at(lambda m: moved_stop(20.0, 5.0, m) == 0.0, 1.0, 40.0)
    ego = ego_at("four_way_priority", SOUTH_NORTH, 20.0, 5.0)
    assert clear == pytest.approx(max(r.own.end for r in ego.graph.regions_on(ego.connection)) + CAR.length, abs=3.0)
    holds = lambda m: moved_stop(m, 6.0, 10.0) == 0.0  # noqa: E731
    assert turns_at(holds, 1.0, 20.0) == pytest.approx(36.0 / 6.0 + HARD_STOP_MARGIN_M, abs=0.01)
