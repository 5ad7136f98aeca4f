"""The lanes beside C on which somebody can be passed."""

import pytest
from helpers.situations import before

from sumo_reactive.driver.view.beside import lanes_beside

THREE_LANES = ("road_before_exit", "road_after_exit")


def lanes(ego):
    return tuple(lanes_beside(ego.graph, ego.plan, ego.seen().front, 300.0))


def beside(network, route, away=300.0, lane=0):
    return lanes(before(network, route, away, 10.0, lane=lane))


def test_on_a_road_of_two_lanes_the_oncoming_one_is_beside():
    found, *_ = beside("blocked_lane", ("eastbound", "eastbound_out"), 200.0)
    assert (found.lane_id, found.is_oncoming) == ("westbound_0", True)
    assert (found.lateral, found.width, found.speed_limit) == pytest.approx((3.2, 3.2, 13.89), abs=0.01)


def test_it_runs_beside_as_far_as_the_edge_does():
    ego = before("blocked_lane", ("eastbound", "eastbound_out"), 200.0, 10.0)
    (found,) = [lane for lane in lanes(ego) if lane.lane_id == "westbound_0"]
    assert found.end == pytest.approx(ego.plan.passages[0].start, abs=0.1)
    assert found.start <= ego.seen().front


@pytest.mark.parametrize("lane", [0, 1])
def test_on_a_road_of_several_lanes_the_next_one_to_the_left_is_beside(lane):
    found = beside("multi_lane_road", THREE_LANES, lane=lane)[0]
    assert (found.lane_id, found.is_oncoming) == (f"road_before_exit_{lane + 1}", False)
    assert found.lateral == pytest.approx(3.2, abs=0.05)


def test_nothing_is_beside_the_leftmost_lane_of_a_one_way_road():
    assert beside("multi_lane_road", THREE_LANES, lane=2) == ()


def test_inside_a_junction_no_lane_is_beside():
    ego = before("four_way_priority", ("from_south", "to_north"), 20.0, 8.0)
    passage = ego.plan.passages[0]
    assert all(lane.end <= passage.start + 1.0 or lane.start >= passage.end - 1.0 for lane in lanes(ego))


def test_the_outlook_knows_the_width_of_the_egos_own_lane_and_how_far_it_has_looked():
    ego = before("blocked_lane", ("eastbound", "eastbound_out"), 200.0, 10.0)
    assert ego.outlook().lane_width == pytest.approx(3.2)
    assert (ego.outlook().sight, ego.outlook(sight=600.0).sight) == (60.0, 600.0)


def test_with_far_sight_all_are_foreseen_and_else_only_who_is_on_the_way():
    ego = before("two_way_road", ("eastbound", "eastbound_out"), 620.0, 8.5)
    far = ego.other("far", "westbound_0", 150.0, 20.0, ("westbound", "westbound_out"))
    near = ego.other("near", "westbound_0", -150.0, 20.0, ("westbound", "westbound_out"))
    assert ego.outlook(far, near, sight=600.0).forecast.user_ids == ("far", "near")
    assert ego.outlook(far, near).forecast.user_ids == ()


def test_lanes_are_looked_for_beside_somebody_who_is_in_the_way():
    ego = before("blocked_lane", ("eastbound", "eastbound_out"), 200.0, 10.0)
    x = ego.other("x", "eastbound_0", -160.0, 0.0, ("eastbound", "eastbound_out"))
    assert ego.outlook().beside == ()
    assert ego.outlook(x).beside[0].lane_id == "westbound_0"
