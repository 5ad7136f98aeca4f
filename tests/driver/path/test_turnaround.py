"""Turning round in several moves: where it takes them, and that they stay on the road and end in the lane."""

import math
from dataclasses import replace

import pytest
from planner_roads import CAR, graph, road, start_on

from sumo_reactive.driver.path.planner import plan
from sumo_reactive.driver.path.turnaround import ATTEMPTS, OFF_ROAD_SPARE_M, turn_in_moves
from sumo_reactive.driver.vehicle.bicycle import advance_pose
from sumo_reactive.driver.vehicle.limits import VehicleLimits
from sumo_reactive.driver.world.road_graph import RoadGraph
from sumo_reactive.driver.world.route import Route

WIDTH = 3.2
WAY = ("a_0->b_0",)


def sized(length: float, width: float = 1.8, most: float = 0.65) -> VehicleLimits:
    """A vehicle with the proportions of a car."""
    sizes = {"length": length, "width": width, "wheelbase": 0.6 * length, "front_overhang": 0.18 * length}
    return replace(CAR, **sizes, max_steering_angle=most)


def dead_end(apart: float = WIDTH, left_hand: bool = False) -> RoadGraph:
    """A road to x = 100 m and back, its two lanes `apart` m."""
    y = -apart if left_hand else apart
    roads = [road("a", [(0, 0), (100, 0)]), road("b", [(100, y), (0, y)])]
    world = graph(roads, [("a_0", "b_0")], {"a_0": [(101.2, 0.2 * y), (101.2, 0.8 * y)]})
    return replace(world, left_hand=left_hand)


def driven(turn, limits: VehicleLimits):
    """Yield the poses of the rear axle along a turn's moves, 0.1 m apart."""
    pose = 100.0 - turn.before - 0.7 - limits.front_to_rear_axle, 0.0, 0.0
    for move in turn.moves:
        while move.left(pose[2]) > 0.0:
            pose = advance_pose(*pose, 0.1 * move.gear, move.steering_angle, limits.wheelbase, 1.0)
            yield pose


@pytest.mark.parametrize("left_hand", [False, True])
@pytest.mark.parametrize(("length", "most"), [(4.3, 3), (5.0, 3), (7.0, 7)])
def test_a_car_turns_round_on_a_narrow_road_and_its_bumpers_hardly_leave_it(length, most, left_hand):
    limits = sized(length)
    turn = turn_in_moves(dead_end(left_hand=left_hand), WAY, limits)
    assert len(turn.moves) <= most
    assert [move.gear for move in turn.moves] == [1, -1] * (len(turn.moves) // 2) + [1]
    assert [move.is_last for move in turn.moves] == [False] * (len(turn.moves) - 1) + [True]
    poses = list(driven(turn, limits))
    side = -1.0 if left_hand else 1.0
    for ahead, more in ((limits.front_to_rear_axle, 0.0), (-limits.rear_overhang, max(a[2] for a in ATTEMPTS))):
        beyond = 0.5 * limits.width - OFF_ROAD_SPARE_M + more + 0.1
        across = [side * (y + ahead * math.sin(h)) for x, y, h in poses]
        assert min(across) > -0.5 * WIDTH - beyond
        assert max(across) < 1.5 * WIDTH + beyond
        assert max(x + ahead * math.cos(h) for x, y, h in poses) < 101.2 + 0.5 * WIDTH + beyond
    _, y, heading = poses[-1]
    assert math.cos(heading) == pytest.approx(-1.0, abs=0.01)
    assert side * (y + limits.wheelbase * math.sin(heading)) == pytest.approx(WIDTH, abs=0.45)
    assert 100.0 - (poses[-1][0] + limits.front_to_rear_axle * math.cos(heading)) == pytest.approx(turn.into, abs=0.3)


@pytest.mark.parametrize("width", [2.0, 1.75, 1.6])
def test_where_the_road_is_hardly_wider_than_the_car_its_rear_may_leave_it_but_not_its_front(width):
    roads = [road("a", [(0, 0), (100, 0)]), road("b", [(100, width), (0, width)])]
    narrow = [tuple(replace(lane, width=width) for lane in lanes) for lanes in roads]
    limits = sized(5.0)
    turn = turn_in_moves(graph(narrow, [("a_0", "b_0")], {"a_0": [(101.2, 0.5 * width)]}), WAY, limits)
    assert 3 <= len(turn.moves) <= 9
    fronts = [y + limits.front_to_rear_axle * math.sin(heading) for _, y, heading in driven(turn, limits)]
    beyond = 0.5 * (width + limits.width)
    assert -beyond < min(fronts)
    assert max(fronts) < width + beyond


def test_where_one_sweep_stays_on_the_road_it_takes_no_moves():
    assert turn_in_moves(dead_end(), WAY, sized(2.2, 0.8)) is None
    assert turn_in_moves(dead_end(11.0), WAY, CAR) is None


def test_a_bend_takes_no_moves():
    roads = [road("a", [(0, 0), (60, 0)]), road("b", [(62, 2), (62, 60)])]
    assert turn_in_moves(graph(roads, [("a_0", "b_0")]), WAY, sized(12.0)) is None


def test_who_finds_no_moves_turns_in_one_sweep():
    bus = sized(12.0, 2.5, 0.8)
    assert turn_in_moves(dead_end(), WAY, bus) is None
    found = plan(dead_end(), Route(("a", "b"), None, None, ()), bus, start_on(dead_end().lanes["a_0"], 20.0))
    assert found.turnarounds == ()


def test_the_plan_stops_before_the_moves_and_schedules_their_time():
    world = dead_end()
    found = plan(world, Route(("a", "b"), None, None, ()), CAR, start_on(world.lanes["a_0"], 20.0))
    (turn,) = found.turnarounds
    passage = found.passages[0]
    assert turn.start <= turn.line == passage.start < turn.end == passage.end
    assert (turn.from_lane, turn.to_lane, turn.route_index) == ("a_0", "b_0", 1)
    took = found.times[int(turn.end / found.curve.step)] - found.times[int(turn.line / found.curve.step)]
    assert took == pytest.approx(turn.duration, rel=0.25)


def test_a_car_past_the_beginning_of_the_moves_begins_where_it_can_stop_unless_it_stands_askew():
    world = dead_end()
    start = start_on(world.lanes["a_0"], 98.8, speed=1.5)
    found = plan(world, Route(("a", "b"), None, None, ()), CAR, start)
    (turn,) = found.turnarounds
    assert turn.start == pytest.approx(CAR.front_overhang + 1.5**2 / 9.0 + CAR.parameters.stop_line_margin_m, abs=0.15)
    askew = replace(start, pose=start.pose._replace(heading=0.3))
    assert plan(world, Route(("a", "b"), None, None, ()), CAR, askew).turnarounds == ()


def test_who_follows_a_lane_that_bends_ahead_of_him_does_not_stand_askew():
    roads = [road("a", [(0, 0), (99, 0), (100, 0.2)]), road("b", [(100, WIDTH), (0, WIDTH)])]
    world = graph(roads, [("a_0", "b_0")], {"a_0": [(101.2, 0.9), (101.2, 2.6)]})
    start = start_on(world.lanes["a_0"], 98.8, speed=1.5)
    assert len(plan(world, Route(("a", "b"), None, None, ()), CAR, start).turnarounds) == 1


def test_a_car_inside_the_turn_is_planned_without_its_moves():
    world = dead_end()
    inside = world.connections["a_0->b_0"].parts[0]
    found = plan(world, Route(("a", "b"), None, None, ()), CAR, start_on(world.lanes[inside], 2.0))
    assert found.turnarounds == ()
