"""Where a long body covers the lane beside its own in a bend."""

import math
from dataclasses import replace
from types import SimpleNamespace

import pytest
from net_recipes import converted
from occupants import ahead, behind, cut_in_bend, in_change, occupied, rear, unseen

from sumo_reactive.driver.nouns.plan import Aside, LaneSegment, Turnaround
from sumo_reactive.driver.nouns.state import Pose, VehicleState
from sumo_reactive.driver.parameters import USUAL
from sumo_reactive.driver.path.planner import PlanStart, plan
from sumo_reactive.driver.vehicle.limits import VehicleLimits
from sumo_reactive.driver.world.route import Route
from sumo_reactive.sumo.net_reader import read_net

CAR = VehicleLimits(
    length=4.7, width=1.8, wheelbase=2.8, front_overhang=0.85, max_speed=50.0, max_acceleration=2.6,
    comfort_deceleration=2.5, service_deceleration=4.5, emergency_deceleration=9.0, max_steering_angle=0.65,
    max_steering_rate=1.0, max_lateral_acceleration=4.0, comfort_lateral_acceleration=3.0,
)  # fmt: skip
BUS = VehicleLimits(
    length=12.0, width=2.5, wheelbase=7.2, front_overhang=2.16, max_speed=25.0, max_acceleration=1.2,
    comfort_deceleration=2.5, service_deceleration=4.5, emergency_deceleration=7.0, max_steering_angle=0.8,
    max_steering_rate=1.0, max_lateral_acceleration=4.0, comfort_lateral_acceleration=3.0,
)  # fmt: skip
NODES = '<nodes><node id="a" x="0" y="0"/><node id="b" x="100" y="0"/><node id="c" x="100" y="100"/></nodes>'
EDGES = '<edges><edge id="ab" from="a" to="b" numLanes="2"/><edge id="bc" from="b" to="c" numLanes="2"/></edges>'


@pytest.mark.parametrize(("limits", "shown"), [(CAR, {None}), (BUS, {None, "ab_1", ":b_0_1", "bc_1"})])
def test_a_bus_is_shown_on_the_inner_lane_of_a_turn_that_it_takes_on_the_outer(tmp_path, limits, shown):
    graph = read_net(converted(tmp_path, NODES, EDGES, "--no-turnarounds")).build(("ab", "bc"))
    lane = graph.lanes["ab_0"]
    x, y = lane.spine.at(20.0)
    pose = Pose(x - limits.front_to_rear_axle, y, 0.0)
    start, bus = PlanStart(pose, 8.0, 0.0, 0.0, "ab_0", 20.0, 0), replace(limits, vehicle_class="bus")
    found = plan(graph, Route(("ab", "bc")), bus, start)
    seen = {}
    for s in range(int(found.curve.length) - 10):
        here = next(g for g in found.segments if s < g.end)
        lane = cut_in_bend(graph, found, here, float(s), 5.0, limits)
        seen[lane.id if lane else None] = s
    assert set(seen) == shown
    assert limits is CAR or math.isclose(seen[None], int(found.curve.length) - 11)


@pytest.mark.parametrize(("aside", "shown"), [(-3.2, "ab_1"), (-6.5, "ab_0")])
def test_an_ego_whose_front_has_swung_out_is_shown_where_sumo_does_not_map_it(tmp_path, aside, shown):
    """SUMO maps it to the lane beside, or, farther out, to none: then to be seen on the lane under its middle."""
    graph = read_net(converted(tmp_path, NODES, EDGES, "--no-turnarounds")).build(("ab", "bc"))
    x, y = graph.lanes["ab_1"].spine.at(50.0)
    start = PlanStart(Pose(x - BUS.front_to_rear_axle, y, 0.0), 5.0, 0.0, 0.0, "ab_1", 50.0, 0)
    found = plan(graph, Route(("ab", "bc")), replace(BUS, vehicle_class="bus"), start)
    heading, reach = -0.5, BUS.front_to_rear_axle
    pose = Pose(x - reach * math.cos(heading), y + aside - reach * math.sin(heading), heading)
    here = next(g for g in found.segments if g.lane_id == "ab_1")
    seen = occupied(graph, found, here, VehicleState(pose, 2.0, 0.0), 0.0, BUS, ("ab", "bc"))
    assert seen is not None
    assert (seen.lane.id, seen.speed, seen.edges) == (shown, 2.0, ("ab", "bc"))


ROAD_NODES = '<nodes><node id="a" x="0" y="0"/><node id="b" x="300" y="0"/></nodes>'
ROAD = '<edge id="ab" from="a" to="b" numLanes="2"/>'
BACK = '<edge id="ba" from="b" to="a" numLanes="1"/>'
WIDTH = 3.2


@pytest.fixture(scope="module")
def road(tmp_path_factory):
    """A road of two lanes, its left one (ab_1) beside the oncoming lane ba_0; their centres at −4.8, −1.6 and 1.6 m."""
    net = converted(tmp_path_factory.mktemp("road"), ROAD_NODES, f"<edges>{ROAD}{BACK}</edges>")
    return read_net(net).build(("ab",))


def car_with_front_at(x, y, heading=0.0, speed=5.0):
    """A car whose bumper is at (x, y)."""
    reach = CAR.front_to_rear_axle
    return VehicleState(Pose(x - reach * math.cos(heading), y - reach * math.sin(heading), heading), speed, 0.0)


def planned(graph, lane_id, x, **how):
    """A plan from `x` m of a lane of the road, and the segment of C there."""
    y = graph.lanes[lane_id].spine.at(x)[1]
    start = PlanStart(car_with_front_at(x, y).pose, 5.0, 0.0, 0.0, lane_id, x, 0)
    found = plan(graph, Route(("ab",)), CAR, start, **how)
    return found, found.segments[0]


def change_to_the_left(graph):
    """A plan with a lane change from ab_0 to ab_1 that has just begun at 50 m, and the change."""
    found, _ = planned(graph, "ab_0", 50.0, change_now=1)
    return found, found.lane_changes[0]


@pytest.mark.parametrize(("y", "shown"), [(-4.4, "ab_1"), (-3.4, "ab_1"), (-3.0, "ab_0"), (-2.0, "ab_0")])
def test_an_ego_that_changes_lanes_is_shown_on_the_lane_that_sumo_does_not_map_it_to(road, y, shown):
    found, change = change_to_the_left(road)
    middle = 0.5 * (change.start + change.end)
    for lane_id in ("ab_0", "ab_1"):  # whichever of both C is said to follow there
        lane = in_change(road, found, SimpleNamespace(lane_id=lane_id), 60.0, y, middle, CAR)
        assert lane is not None and lane.id == shown


def test_before_a_change_and_long_after_it_the_ego_is_shown_nowhere_else(road):
    found, change = change_to_the_left(road)
    assert in_change(road, found, SimpleNamespace(lane_id="ab_0"), 60.0, -4.8, change.start - 0.1, CAR) is None
    assert in_change(road, found, SimpleNamespace(lane_id="ab_1"), 60.0, -1.6, change.end + CAR.length + 0.1, CAR) is None


@pytest.mark.parametrize(("y", "shown"), [(-2.7, "ab_0"), (-1.6, None)])
def test_after_a_change_the_old_lane_sees_the_ego_until_its_body_has_left_it(road, y, shown):
    found, change = change_to_the_left(road)
    lane = in_change(road, found, SimpleNamespace(lane_id="ab_1"), 60.0, y, change.end + 1.0, CAR)
    assert (lane.id if lane else None) == shown


def test_while_it_changes_lanes_the_ego_is_shown_at_its_speed(road):
    found, change = change_to_the_left(road)
    ego = car_with_front_at(60.0, -3.4)
    here = next(g for g in found.segments if g.lane_id == "ab_0")
    seen = occupied(road, found, here, ego, 0.5 * (change.start + change.end), CAR, ("ab",))
    assert seen is not None
    assert (seen.lane.id, seen.x, seen.y, seen.speed, seen.edges, seen.waits) == (
        "ab_1", pytest.approx(60.0), pytest.approx(-3.4), 5.0, ("ab",), False,
    )  # fmt: skip


def test_an_ego_in_the_middle_of_its_lane_is_shown_nowhere_else(road):
    found, here = planned(road, "ab_1", 50.0)
    assert occupied(road, found, here, car_with_front_at(60.0, -1.6), 10.0, CAR, ("ab",)) is None


def passing(graph, lane_id, lateral):
    """A plan that leads `lateral` m beside its lane, and its segment."""
    found, here = planned(graph, lane_id, 50.0)
    return replace(found, aside=Aside(lateral, 60.0, 80.0)), here


@pytest.mark.parametrize(("y", "shown"), [(-1.6, None), (0.2, "ba_0"), (1.5, "ba_0")])
def test_over_the_oncoming_lane_the_ego_is_shown_as_one_that_stands_where_its_rear_is(road, y, shown):
    found, here = passing(road, "ab_1", 3.0)
    seen = occupied(road, found, here, car_with_front_at(60.0, y), 10.0, CAR, ("ab",))
    if shown is None:
        assert seen is None
        return
    assert seen is not None
    assert (seen.lane.id, seen.speed, seen.edges) == (shown, 0.0, ("ba",))
    assert (seen.x, seen.y) == pytest.approx((60.0 - CAR.length, y))


@pytest.mark.parametrize(("y", "shown"), [(-4.2, "ab_1"), (-2.6, "ab_0")])
def test_over_a_lane_of_its_own_road_the_ego_is_shown_driving_on_the_one_that_sumo_does_not_map_it_to(road, y, shown):
    found, here = passing(road, "ab_0", 2.0)
    seen = occupied(road, found, here, car_with_front_at(60.0, y), 10.0, CAR, ("ab",))
    if y < -4.0:
        assert seen is None  # it does not yet cover the lane beside
        seen = occupied(road, found, here, car_with_front_at(60.0, y + 0.8), 10.0, CAR, ("ab",))
    assert seen is not None
    assert (seen.lane.id, seen.x, seen.speed, seen.edges) == (shown, pytest.approx(60.0), 5.0, ("ab",))


def turning_round(graph):
    """A turn in several moves from ab_1 at 290 m into ba_0."""
    return Turnaround(
        start=40.0, line=41.0, end=46.0, from_lane="ab_1", from_index=0, to_lane="ba_0", route_index=1, moves=(),
        duration=20.0, into=5.0,
    )  # fmt: skip


@pytest.mark.parametrize(("y", "heading"), [(-1.6, 0.0), (-1.6, 0.5), (-1.0, 0.0)])
def test_an_ego_that_has_begun_to_turn_round_is_shown_where_it_began(road, y, heading):
    found, _ = planned(road, "ab_1", 250.0)
    turn = turning_round(road)
    seen = behind(road, found, turn, car_with_front_at(290.0, y, heading), CAR, ("ab", "ba"))
    place = found.curve.at(turn.start - USUAL.stop_line_margin_m)
    assert (seen.lane.id, seen.x, seen.y, seen.speed, seen.edges) == ("ab_1", *place[:2], 0.0, ("ab", "ba"))


@pytest.mark.parametrize("y", [-1.0, -0.1, 0.1, 1.6])
def test_an_ego_that_turns_round_is_shown_on_the_lane_it_turns_into_while_sumo_has_it_elsewhere(road, y):
    seen = ahead(road, turning_round(road), car_with_front_at(280.0, y, 0.5 * math.pi), CAR, ("ba",))
    assert (seen.lane.id, seen.speed, seen.edges) == ("ba_0", 0.0, ("ba",))
    assert (seen.x, seen.y) == pytest.approx((280.0 - CAR.length, 1.6), abs=1e-6)


def test_who_turns_round_is_shown_ahead_of_whatever_of_its_body_is_farthest_back(road):
    """Turned half round its bumper is ahead, by the oncoming lane, of its rear, which lies towards b."""
    ego = car_with_front_at(280.0, -0.5, 0.75 * math.pi)
    seen = ahead(road, turning_round(road), ego, CAR, ("ba",))
    rear = 280.0 + CAR.length * math.cos(0.25 * math.pi)
    assert seen is not None and seen.x == pytest.approx(rear - CAR.length, abs=1e-6)


@pytest.mark.parametrize(("askew", "shown", "mapped"), [(0.0, None, ""), (0.3, "ab_0", ""), (0.3, "ab_0", "ab_0")])
def test_a_bus_is_seen_on_the_lane_that_its_rear_is_over_when_its_front_is_in_the_junction(tmp_path, askew, shown, mapped):
    """It waits for who is there, but not for itself, whom SUMO still has there."""
    graph = read_net(converted(tmp_path, NODES, EDGES, "--no-turnarounds")).build(("ab", "bc"))
    lane, beside = graph.lanes["ab_1"], graph.lanes["ab_0"]
    start = PlanStart(Pose(40.0, lane.spine.at(0.0)[1], 0.0), 5.0, 0.0, 0.0, "ab_1", 50.0, 0)
    found = plan(graph, Route(("ab", "bc")), replace(BUS, vehicle_class="bus"), start)
    here = next(g for g in found.segments if graph.lanes[g.lane_id].is_internal)
    x, y = lane.spine.at(lane.spine.length)
    reach = BUS.front_to_rear_axle
    pose = Pose(x + 2.0 - reach * math.cos(askew), y - reach * math.sin(askew), askew)
    s = here.start + 2.0 - BUS.front_overhang
    seen = rear(graph, found, here, VehicleState(pose, 2.0, 0.0), s, BUS, ("ab", "bc"), mapped)
    assert (seen.lane.id if seen else None) == shown
    if seen is not None:
        assert (seen.x, seen.y) == pytest.approx(beside.spine.at(beside.spine.length))
        assert (seen.length, seen.edges) == (pytest.approx(BUS.length * math.cos(askew) - 2.0, abs=0.05), ("ab", "bc"))
        assert seen.waits == (mapped != "ab_0")


def test_an_ego_whose_rear_is_on_the_road_behind_the_junction_is_shown_nowhere_besides(tmp_path):
    graph = read_net(converted(tmp_path, NODES, EDGES, "--no-turnarounds")).build(("ab", "bc"))
    lane = graph.lanes["bc_1"]
    start = PlanStart(Pose(40.0, graph.lanes["ab_1"].spine.at(0.0)[1], 0.0), 5.0, 0.0, 0.0, "ab_1", 50.0, 0)
    found = plan(graph, Route(("ab", "bc")), replace(BUS, vehicle_class="bus"), start)
    here = next(g for g in found.segments if g.lane_id == "bc_1")
    x, y = lane.spine.at(13.0)
    ego = VehicleState(Pose(x, y - BUS.front_to_rear_axle, math.pi / 2), 2.0, 0.0)
    assert rear(graph, found, here, ego, here.start + 13.0 - BUS.front_overhang, BUS, ("ab", "bc")) is None


@pytest.mark.parametrize(
    ("declared", "speed", "at", "shown"),
    [(1.25, 0.0, 50.0, True), (1.25, 1.1, 50.0, False), (1.0, 0.0, 50.0, False), (1.25, 0.0, 10.0, False)],
)
def test_the_rear_of_a_slow_ego_is_shown_where_the_lane_is_declared_longer_than_drawn(tmp_path, declared, speed, at, shown):
    """Of 12 m over ground SUMO sees 12 of the lane's own metres: 9.6 over ground."""
    graph = read_net(converted(tmp_path, NODES, EDGES, "--no-turnarounds")).build(("ab", "bc"))
    lane = replace(graph.lanes["ab_1"], length=declared * graph.lanes["ab_1"].spine.length)
    graph = replace(graph, lanes={**graph.lanes, lane.id: lane})
    here = LaneSegment(lane_id=lane.id, start=0.0, end=lane.spine.length, lane_offset=0.0, route_index=0)
    x, y = lane.spine.at(at)
    ego = VehicleState(Pose(x - BUS.front_to_rear_axle, y, 0.0), speed, 0.0)
    seen = unseen(graph, None, here, ego, BUS, ("ab", "bc"))
    assert (seen is not None) is shown
    if seen is not None:
        assert lane.spine.project(seen.x, seen.y)[0] == pytest.approx(at - 9.7)
        assert (seen.length, seen.waits) == (pytest.approx(2.3 * declared), True)
