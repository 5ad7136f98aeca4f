"""Where the others will be if each keeps its behaviour: along its lane, as its route says (F&L 1991, §2)."""

import math

import numpy as np
import pytest
from helpers.cars import BODY
from helpers.situations import before

from sumo_reactive.driver.nouns.forecast import PATH_STEP_M
from sumo_reactive.driver.view.foresee import foresee, paths_ahead, places_after, turn_rate, way_left

SECONDS = 40.0
"""Long enough for every car here to come to the end of its path."""
LANE = "from_east_0"


@pytest.fixture(scope="module")
def ego():
    return before("four_way_priority", ("from_south", "to_north"), 30.0, 8.0)


def ends(forecast) -> list[tuple[float, float]]:
    """Where each path ends."""
    return [tuple(forecast.points[a + n - 1, :2]) for a, n in zip(forecast.first, forecast.counts, strict=True)]


def test_without_others_there_is_nothing_to_foresee(ego):
    forecast = foresee(ego.graph, (), SECONDS)
    assert (forecast.user_ids, len(forecast.points), len(forecast.bodies)) == ((), 0, 0)


def test_who_tells_his_route_has_one_path_that_follows_it(ego):
    for target in ("to_west", "to_north", "to_south"):
        forecast = foresee(ego.graph, (ego.other("x", LANE, -20.0, 8.0, ("from_east", target)),), SECONDS)
        assert forecast.user_ids == ("x",)
        last = ego.graph.lanes[f"{target}_0"].spine.points[-1]
        assert math.dist(ends(forecast)[0], last) < PATH_STEP_M


def test_an_unknown_route_has_a_path_for_each_way_out(ego):
    forecast = foresee(ego.graph, (ego.other("x", LANE, -20.0, 8.0, ()),), SECONDS)
    targets = {way.to_lane for way in ego.graph.ways_from(LANE) if way.to_lane in ego.graph.lanes and not way.is_crossing}
    assert len(targets) >= 3
    assert set(forecast.user_ids) == {"x"}
    reached = {min(targets, key=lambda t: math.dist(ego.graph.lanes[t].spine.points[-1], end)) for end in ends(forecast)}
    assert reached == targets


def test_who_is_inside_a_junction_follows_his_connection_to_its_end(ego):
    part = ego.graph.connections["from_west_0->to_east_0"].parts[0]
    forecast = foresee(ego.graph, (ego.other("x", part, 5.0, 8.0, ()),), SECONDS)
    assert len(forecast.user_ids) == 1
    assert math.dist(ends(forecast)[0], ego.graph.lanes["to_east_0"].spine.points[-1]) < PATH_STEP_M


def test_who_overtakes_on_the_oncoming_lane_goes_on_against_it(ego):
    along = ego.other("x", LANE, -20.0, 8.0, ())
    forecast = foresee(ego.graph, (along._replace(heading=along.heading + math.pi),), SECONDS)
    assert math.dist(ends(forecast)[0], ego.graph.lanes[LANE].spine.points[0]) < PATH_STEP_M
    start = forecast.points[forecast.first[0], :2]
    assert math.dist(start, (along.x, along.y)) == pytest.approx(forecast.bodies[0, 0], abs=0.01)


def test_who_is_on_an_unknown_lane_has_no_path(ego):
    lost = ego.other("x", LANE, -20.0, 8.0, ())._replace(lane_id="nowhere_0")
    assert foresee(ego.graph, (lost,), SECONDS).user_ids == ()
    assert paths_ahead(ego.graph, "nowhere_0", ()) == ()


@pytest.mark.parametrize("beside", [-0.8, 0.0, 1.2])
def test_a_path_begins_where_the_front_bumper_is(ego, beside):
    x = ego.other("x", LANE, -21.3, 8.0, ("from_east", "to_west"))
    x = x._replace(x=x.x - beside * math.sin(x.heading), y=x.y + beside * math.cos(x.heading))
    forecast = foresee(ego.graph, (x,), SECONDS)
    (body,) = forecast.bodies
    px, py, heading = forecast.points[0]
    c, w = math.cos(heading), math.sin(heading)
    assert (px + body[0] * c - body[1] * w, py + body[0] * w + body[1] * c) == pytest.approx((x.x, x.y), abs=0.02)
    assert 0.0 <= body[0] <= PATH_STEP_M
    assert body[1] == pytest.approx(beside, abs=0.02)


def test_a_path_carries_speed_size_and_speed_limit(ego):
    forecast = foresee(ego.graph, (ego.other("x", LANE, -20.0, 8.0, ("from_east", "to_west")),), SECONDS)
    limit = ego.graph.lanes[LANE].speed_limit
    assert forecast.bodies[0, 2:] == pytest.approx([8.0, BODY.length, BODY.width, limit])


def test_the_points_of_a_path_are_evenly_spaced_and_head_along_it(ego):
    (path,) = paths_ahead(ego.graph, LANE, ("from_east", "to_south"))
    steps = np.diff(path[:-1, :2], axis=0)
    assert np.hypot(*steps.T).max() <= PATH_STEP_M + 1e-9
    assert np.hypot(*steps.T).min() > 0.9 * PATH_STEP_M
    along = np.unwrap(np.arctan2(steps[:, 1], steps[:, 0]))
    assert np.abs(np.diff(path[:, 2])).max() < 0.5
    assert np.abs(np.cos(along - path[:-2, 2])).min() > 0.9


def test_several_users_keep_their_paths_apart(ego):
    users = (ego.other("a", LANE, -20.0, 8.0, ()), ego.other("b", "from_west_0", -20.0, 9.0, ("from_west", "to_east")))
    forecast = foresee(ego.graph, users, SECONDS)
    assert set(forecast.user_ids) == {"a", "b"}
    assert int(forecast.counts.sum()) == len(forecast.points)
    for user in users:
        k = forecast.user_ids.index(user.id)
        assert math.dist(forecast.points[forecast.first[k], :2], (user.x, user.y)) <= PATH_STEP_M


def test_a_car_on_a_straight_lane_does_not_turn(ego):
    straight_on = ego.other("x", LANE, -60.0, 8.0, ("from_east", "to_south"))
    assert turn_rate(ego.graph, straight_on, 0.7) == pytest.approx(0.0, abs=1e-3)


def test_a_car_that_is_about_to_turn_left_turns_left_as_its_way_does(ego):
    turning = ego.other("x", LANE, -1.0, 8.0, ("from_east", "to_south"))
    assert turn_rate(ego.graph, turning, 0.7) > 0.1
    right = ego.other("x", LANE, -1.0, 8.0, ("from_east", "to_north"))
    assert turn_rate(ego.graph, right, 0.7) < -0.1


def test_where_the_ways_part_to_both_sides_nobody_is_taken_to_turn(ego):
    assert turn_rate(ego.graph, ego.other("x", LANE, -1.0, 8.0, ()), 0.7) == 0.0


@pytest.mark.parametrize("askew", [0.6, -0.6])
def test_a_car_whose_ways_part_farther_on_turns_as_all_of_them_do(ego, askew):
    coming_out = ego.other("x", LANE, 1.0, 8.0, ())
    assert len(paths_ahead(ego.graph, LANE, ())) > 1
    turned = 0.7 * turn_rate(ego.graph, coming_out._replace(heading=coming_out.heading + askew), 0.7)
    assert turned == pytest.approx(-askew, abs=0.05)


@pytest.mark.parametrize("askew", [0.6, -0.6])
def test_a_car_whose_rear_is_still_in_the_bend_turns_until_it_lies_along_its_lane(ego, askew):
    """Its front has just come onto a straight lane; in 0.7 s it will be 6.6 m along it, all of its body on the lane."""
    coming_out = ego.other("x", "to_west_0", 1.0, 8.0, ("to_west",))
    turned = 0.7 * turn_rate(ego.graph, coming_out._replace(heading=coming_out.heading + askew), 0.7)
    assert turned == pytest.approx(-askew, abs=0.05)


def test_a_slow_car_comes_out_of_its_bend_as_far_as_it_drives(ego):
    coming_out = ego.other("x", "to_west_0", 1.0, 1.5, ("to_west",))
    turned = 0.7 * turn_rate(ego.graph, coming_out._replace(heading=coming_out.heading + 0.6), 0.7)
    assert -0.3 < turned < -0.05


def test_a_route_ends_with_its_last_lane(ego):
    lane = ego.graph.lanes["from_west_0"]
    assert way_left(ego.graph, ego.other("x", lane.id, -12.0, 8.0, ("from_west",))) == pytest.approx(12.0)
    for route in ((), ("from_west", "to_east")):
        assert way_left(ego.graph, ego.other("x", lane.id, -12.0, 8.0, route)) == math.inf


def test_a_car_may_be_on_any_way_that_its_route_leaves_it_and_straight_on(ego):
    turning = ego.other("x", LANE, -2.0, 8.0, ("from_east", "to_south"))
    straight, turned = places_after(ego.graph, turning, 1.0)
    assert straight[:2] == pytest.approx((turning.x - 8.0, turning.y), abs=0.1)
    assert math.dist(turned[:2], straight[:2]) > 1.0
    assert len(places_after(ego.graph, turning._replace(route=()), 1.0)) >= 4
