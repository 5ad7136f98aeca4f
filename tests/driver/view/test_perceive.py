"""Who can come to which region, and how far away it is: on the project's own networks."""

import math
from dataclasses import replace

import numpy as np
import pytest
from helpers.cars import BODY, CAR
from helpers.situations import before

from sumo_reactive.driver.geometry.polyline import moved_aside
from sumo_reactive.driver.nouns.plan import Aside
from sumo_reactive.driver.nouns.snapshot import Foe, OffTracking, Snapshot
from sumo_reactive.driver.path.planner import PlanStart, plan
from sumo_reactive.driver.view import perceive as room
from sumo_reactive.driver.view.corridor import off_tracking_of
from sumo_reactive.driver.world.route import Route

FROM_SOUTH = ("from_south", "to_west")
PRIORITY = "four_way_priority"


def foe(snapshot: Snapshot, name: str) -> Foe:
    """The one conflict in which a user is a foe."""
    (found,) = [f for f in snapshot.foes if f.user.id == name]
    return found


@pytest.fixture(scope="module")
def ego():
    return before(PRIORITY, FROM_SOUTH, 12.0, 5.0)


def test_the_ego_knows_where_it_is_on_its_curve(ego):
    seen = ego.seen()
    assert (seen.s, seen.d) == pytest.approx((0.0, 0.0), abs=0.02)
    assert seen.front == pytest.approx(CAR.front_overhang, abs=0.02)
    assert ego.line - seen.front == pytest.approx(12.0, abs=0.4)


@pytest.mark.parametrize("to", ["to_north", "to_west", "to_east"])
@pytest.mark.parametrize("away", [12.0, 60.0])
def test_the_stop_line_lies_on_the_curve_where_the_lane_ends(to, away):
    ego = before(PRIORITY, ("from_south", to), away, 5.0)
    assert ego.line - ego.seen().front == pytest.approx(away, abs=0.05)


@pytest.mark.parametrize("away", [5.0, 30.0, 100.0])
def test_a_car_on_an_approach_is_as_far_from_its_region_as_the_road_is_long(ego, away):
    found = foe(ego.seen(ego.other("west", "from_west_0", -away, 13.0, ("from_west", "to_east"))), "west")
    region = found.conflict.region
    assert found.conflict.other.from_lane == "from_west_0"
    assert found.to_stop_line == pytest.approx(away)
    assert found.to_region == pytest.approx(away + region.other.start)
    assert found.to_clear == pytest.approx(away + region.other.end + BODY.length)
    assert found.conflict.must_yield
    assert not found.conflict.is_yielded_to


def test_a_car_inside_the_junction_has_its_line_behind_it(ego):
    inside = ego.graph.connections["from_west_0->to_east_0"].parts[0]
    found = foe(ego.seen(ego.other("west", inside, 4.0, 8.0, ("to_east",))), "west")
    assert found.to_stop_line == pytest.approx(-4.0)
    assert found.to_clear == pytest.approx(found.conflict.region.other.end + BODY.length - 4.0)


def test_a_car_whose_rear_has_left_the_region_is_no_foe(ego):
    seen = ego.seen(ego.other("west", "to_east_0", 30.0, 8.0, ("to_east",)))
    assert not seen.foes


@pytest.mark.parametrize(
    ("lane", "route"),
    [("from_west_0", ("from_west", "to_south")), ("from_east_0", ("from_east", "to_north"))],
    ids=["right into the ego's road", "right before the ego's exit"],
)
def test_a_car_whose_route_turns_elsewhere_is_no_foe(ego, lane, route):
    assert not ego.seen(ego.other("x", lane, -20.0, 8.0, route)).foes


def test_the_route_decides_in_which_region_a_car_is_a_foe(ego):
    cars = (ego.other("east", "from_east_0", -20.0, 8.0, ("from_east", to)) for to in ("to_west", "to_south"))
    straight, left = (foe(ego.seen(car), "east") for car in cars)
    assert (straight.conflict.other.to_lane, left.conflict.other.to_lane) == ("to_west_0", "to_south_0")


def test_a_car_that_yields_to_the_ego_is_marked_so():
    ego = before(PRIORITY, ("from_west", "to_east"), 20.0, 10.0)
    found = foe(ego.seen(ego.other("south", "from_south_0", -10.0, 5.0, ("from_south", "to_north"))), "south")
    assert found.conflict.is_yielded_to
    assert not found.conflict.must_yield


def test_a_car_ahead_on_the_same_lane_is_on_the_path(ego):
    seen = ego.seen(ego.other("ahead", "from_south_0", -3.0, 2.0, ("from_south", "to_north")))
    (obstacle,) = seen.on_path
    assert obstacle.start == pytest.approx(ego.seen().front + 12.0 - 3.0 - BODY.length, abs=0.05)
    assert (obstacle.along, obstacle.across) == pytest.approx((2.0, 0.0), abs=0.15)


def test_a_car_on_the_other_side_of_the_road_is_not_on_the_path(ego):
    assert not ego.seen(ego.other("back", "to_south_0", 10.0, 10.0, ("to_south",))).on_path


def test_without_others_there_is_nothing_to_see(ego):
    seen = ego.seen()
    assert (seen.on_path, seen.foes, seen.neighbours, len(seen.boxes)) == ((), (), (), 0)


def test_the_boxes_of_those_near_tell_place_motion_size_and_turning(ego):
    user = ego.other("ahead", "from_south_0", -3.0, 2.0, ())
    (box,) = ego.seen(user).boxes.tolist()
    assert box == pytest.approx([user.x, user.y, user.heading, 2.0, BODY.length, BODY.width, 0.0, math.inf])


def test_a_car_on_the_lane_that_the_route_needs_is_a_neighbour():
    ego = before("multi_lane_road", ("road_before_exit", "exit"), 150.0, 15.0, lane=2)
    places = {"a": -130.0, "b": -190.0}
    beside = [ego.other(name, "road_before_exit_1", at, 14.0, ("road_before_exit",)) for name, at in places.items()]
    found = {n.user.id: n.ahead for n in ego.seen(*beside).neighbours}
    assert found == pytest.approx({"a": 20.0, "b": -40.0}, abs=0.5)


@pytest.mark.parametrize(("behind", "is_first"), [(-1.0, True), (1.0, False)])
def test_a_cut_into_the_lane_beside_is_looked_at_if_it_comes_before_the_change_that_the_route_needs(
    monkeypatch, behind, is_first
):
    ego = before("multi_lane_road", ("road_before_exit", "exit"), 200.0, 15.0, lane=1)
    left = ego.other("left", "road_before_exit_2", -200.0, 15.0, ())
    right = ego.other("right", "road_before_exit_0", -200.0, 15.0, ())
    change = ego.plan.next_change(0.0)
    cut = OffTracking(change.start + behind, change.start + 9.0, True, "road_before_exit_2")
    monkeypatch.setattr(room, "off_tracking_of", lambda *of: (cut,))
    monkeypatch.setattr(room, "next_off_tracking", lambda *of: cut)
    seen = ego.seen(left, right)
    assert seen.off_tracking == (cut if is_first else None)
    assert [neighbour.user.id for neighbour in seen.neighbours] == (["left"] if is_first else ["right"])


def test_an_unknown_place_is_seen_but_means_nothing(ego):
    user = ego.other("lost", "from_west_0", -10.0, 10.0, ("from_west", "to_east"))._replace(lane_id="nowhere_0")
    seen = ego.seen(user)
    assert not seen.foes
    assert len(seen.boxes) == 1
    assert math.isfinite(seen.s)


@pytest.mark.parametrize(("away", "at", "is_led"), [(2.0, 8.5, False), (0.5, 8.5, True), (0.5, 10.0, False)])
def test_who_comes_across_the_bend_of_c_is_stayed_behind_unless_he_will_have_left_it(away, at, is_led):
    """The ego is to turn left with 9 m/s; the other drives straight on with 10 m/s and nears it while he leaves its way."""
    ego = before(PRIORITY, FROM_SOUTH, away, 9.0)
    oncoming = ego.other("north", ego.graph.connections["from_north_0->to_south_0"].parts[0], at, 10.0, ("to_south",))
    seen = ego.seen(oncoming)
    (obstacle,) = seen.on_path
    assert obstacle.along <= -abs(obstacle.across)
    assert [leader.behind for leader in seen.leaders] == ["north"] * is_led


def test_who_comes_along_the_ego_s_own_way_never_leaves_it():
    ego = before("multi_lane_road", ("road_before_exit", "road_after_exit"), 300.0, 10.0)
    oncoming = ego.ahead("wrong way", 40.0, 8.0)
    seen = ego.seen(oncoming._replace(heading=oncoming.heading + math.pi))
    assert [leader.behind for leader in seen.leaders] == ["wrong way"]


@pytest.mark.parametrize(("at", "is_led"), [(13.0, False), (10.0, True)])
def test_who_crosses_is_stayed_behind_unless_the_rest_of_him_will_have_crossed(at, is_led):
    """The ego, with 9 m/s, would be there in 0.74 s. The other drives 3.1 m until 0.5 s before that."""
    ego = before(PRIORITY, ("from_south", "to_north"), 2.0, 9.0)
    crossing = ego.other("west", ego.graph.connections["from_west_0->to_east_0"].parts[0], at, 13.0, ("to_east",))
    seen = ego.seen(crossing)
    assert len(seen.on_path) == 1
    assert [leader.behind for leader in seen.leaders] == ["west"] * is_led


@pytest.mark.parametrize(("along", "returns"), [(6.0, True), (9.0, True), (6.0, False)])
def test_who_is_before_the_ego_on_its_own_way_and_comes_over_c_again_is_a_leader(along, returns):
    """C keeps 6 m off the map's way; behind the junction both are one again, or never."""
    ego = before(PRIORITY, ("from_south", "to_north"), 2.0, 3.0)
    curve, passage = ego.plan.curve, ego.plan.passages[0]
    inside = (curve.step * np.arange(len(curve.x)) - passage.start) / (passage.end - passage.start)
    off = 6.0 * (np.clip(3.0 * (1.2 - inside), 0.0, 1.0) if returns else np.ones(len(inside)))
    x, y = np.ascontiguousarray(moved_aside(np.column_stack((curve.x, curve.y)), off).T)
    there = replace(ego, plan=replace(ego.plan, curve=replace(curve, x=x, y=y)))
    seen = there.seen(ego.other("x", ego.connection.parts[0], along, 2.0, ("to_north",)))
    assert not seen.on_path
    assert [one.behind for one in seen.leaders] == (["x"] if returns else [])


@pytest.mark.parametrize(
    ("ahead", "gap", "speed", "leads"),
    [(-0.5, 0.1, 0.0, False), (0.5, 0.1, 0.0, True), (-0.5, -0.1, 0.0, True), (-0.5, 0.1, 1.0, True)],
)
def test_who_stands_beside_the_egos_front_and_not_before_it_is_no_leader(ahead, gap, speed, leads):
    """He has come from the right; `gap` m are between its side and him, `ahead` (m) his middle is before its bumper."""
    ego = before(PRIORITY, ("from_south", "to_north"), 12.0, 0.0)
    x, y = ego.ego.pose.ahead(CAR.front_to_rear_axle)
    other = ego.other("x", ego.connection.from_lane, 0.0, speed, ("from_south",))._replace(
        x=x + 0.5 * CAR.width + gap, y=y + ahead, heading=math.pi, lane_id=""
    )
    seen = ego.seen(other)
    assert [one.user.id for one in seen.on_path] == ["x"]
    assert [one.behind for one in seen.leaders] == (["x"] if leads else [])


def test_a_body_that_leads_aside_past_somebody_cuts_into_no_lane_beside():
    """Who drives there has been proven to leave room: nobody is waited for before the ego pulls out."""
    route = Route(("road_before_exit", "road_after_exit"))
    ego = before("multi_lane_road", route.edges, 380.0, 10.0, lane=1)
    here = ego.graph.lanes["road_before_exit_1"].spine
    pose = ego.ego.pose
    start = PlanStart(pose, 10.0, 0.0, ego.time, "road_before_exit_1", here.project(*ego.ego.pose.ahead(0.0))[0], 0)
    passing = plan(ego.graph, route, CAR, start, aside=Aside(3.2, 60.0, 80.0))
    assert max(abs(here.offsets(np.column_stack((passing.curve.x, passing.curve.y))))) > 3.0
    assert off_tracking_of(passing, ego.graph, CAR) == ()
