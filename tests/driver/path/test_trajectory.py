"""The curve C: smooth, drivable, near the lanes' centres."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from planner_roads import CAR, corner, graph, road, start_on

from sumo_reactive.driver.geometry.polyline import Polyline, joined
from sumo_reactive.driver.nouns.plan import NominalPlan
from sumo_reactive.driver.path.aside import centred
from sumo_reactive.driver.path.planner import plan
from sumo_reactive.driver.path.trajectory import DEVIATION_SHARE
from sumo_reactive.driver.vehicle.limits import VehicleLimits
from sumo_reactive.driver.world.road_graph import RoadGraph
from sumo_reactive.driver.world.route import Route

AB = Route(("a", "b"))
BUS = replace(CAR, length=12.0, width=2.5, wheelbase=7.2, front_overhang=2.16, max_steering_angle=0.8)
TRAILER = replace(BUS, length=18.0, wheelbase=10.8, front_overhang=3.24)


def deviation(world: RoadGraph, found: NominalPlan, lanes: list[str]) -> float:
    line = Polyline(joined([world.lanes[lane].spine.points for lane in lanes]))
    inside = range(20, len(found.curve.x) - 30)
    return max(abs(line.project(found.curve.x[i], found.curve.y[i])[1]) for i in inside)


def steering(found: NominalPlan, limits: VehicleLimits = CAR) -> float:
    """Largest steering angle, rad, with which the front axle follows C, the body drawn along by a wheelbase."""
    curve, heading, most = found.curve, float(found.curve.heading[0]), 0.0
    for k in range(1, len(curve.x)):
        middle = 0.5 * (curve.heading[k - 1] + curve.heading[k])
        heading += math.sin(middle - heading) * curve.step / limits.wheelbase
        most = max(most, abs(curve.heading[k] - heading))
    return most


@pytest.mark.parametrize("points", [3, 4, 8])
def test_a_tight_corner_can_be_steered_and_stays_in_its_lane(points: int) -> None:
    world = corner(4.4, points)
    found = plan(world, AB, CAR, start_on(world.lanes["a_0"], 10.0))
    assert steering(found) <= CAR.max_steering_angle
    assert deviation(world, found, ["a_0", ":J0_0", "b_0"]) < DEVIATION_SHARE * 0.5 * (3.2 - CAR.width)


@pytest.mark.parametrize("lane_width", [2.8, 3.2, 3.6])
def test_a_kink_of_the_road_is_rounded_within_the_lane_and_is_no_bend_to_brake_for(lane_width: float) -> None:
    kink = 60.0 + 40.0 * math.cos(0.35), 40.0 * math.sin(0.35)
    lanes = tuple(replace(lane, width=lane_width) for lane in road("a", [(0.0, 0.0), (60.0, 0.0), kink]))
    world = graph([lanes], [])
    found = plan(world, Route(("a",)), CAR, start_on(world.lanes["a_0"], 10.0))
    away = deviation(world, found, ["a_0"])
    assert away <= 1.1 * DEVIATION_SHARE * 0.5 * (lane_width - CAR.width)
    assert 0.5 * CAR.width + away < 0.5 * lane_width
    assert float(found.speed_limits.min()) > 8.0


def test_a_normal_turn_keeps_to_the_centre_line() -> None:
    world = corner(9.0, 12)
    found = plan(world, AB, CAR, start_on(world.lanes["a_0"], 10.0))
    assert np.abs(found.curve.curvature).max() < 0.17
    assert deviation(world, found, ["a_0", ":J0_0", "b_0"]) < 0.35


def test_a_u_turn_of_three_metres_swings_out_until_the_car_can_steer_it() -> None:
    a, b = road("a", [(0, 0), (60, 0)]), road("b", [(60, 6), (0, 6)])
    bend = [(60 + 3 * math.sin(t), 3 - 3 * math.cos(t)) for t in np.linspace(0, math.pi, 7)[1:-1]]
    world = graph([a, b], [("a_0", "b_0")], {"a_0": bend})
    found = plan(world, AB, CAR, start_on(world.lanes["a_0"], 10.0))
    assert steering(found) <= CAR.max_steering_angle
    assert deviation(world, found, ["a_0", ":J0_0", "b_0"]) < 3.0


@pytest.mark.parametrize(("radius", "room"), [(3.0, 1.2), (6.0, 0.5), (9.0, 0.4)])
def test_a_bus_of_twelve_metres_can_steer_a_corner_and_stays_near_its_lane(radius: float, room: float) -> None:
    world = corner(radius, 6)
    found = plan(world, AB, BUS, start_on(world.lanes["a_0"], 20.0))
    assert steering(found, BUS) <= BUS.max_steering_angle
    assert deviation(world, found, ["a_0", ":J0_0", "b_0"]) < room


def bumper(found: NominalPlan, limits: VehicleLimits) -> Polyline:
    """Way of the middle of the front bumper while the front axle follows C."""
    curve, heading, way = found.curve, float(found.curve.heading[0]), []
    for k in range(len(curve.x)):
        heading += math.sin(curve.heading[k] - heading) * curve.step / limits.wheelbase
        ahead = limits.front_overhang
        way.append((curve.x[k] + ahead * math.cos(heading), curve.y[k] + ahead * math.sin(heading)))
    return Polyline(np.array(way))


@pytest.mark.parametrize("radius", [4.0, 5.0])
def test_a_bus_keeps_its_front_out_of_the_oncoming_lane_in_a_right_turn(radius: float) -> None:
    a, b = road("a", [(0, 0), (60, 0)]), road("b", [(60 + radius, -radius), (60 + radius, -60 - radius)])
    bend = [(60 + radius * math.sin(t), radius * (math.cos(t) - 1)) for t in np.linspace(0, math.pi / 2, 7)[1:-1]]
    world = graph([a, b], [("a_0", "b_0")], {"a_0": bend})
    found = plan(world, AB, BUS, start_on(world.lanes["a_0"], 20.0))
    assert steering(found, BUS) <= BUS.max_steering_angle
    behind = [x for x, y in bumper(found, BUS).points if -40.0 < y < -radius]
    assert max(behind) - 60.0 - radius < 1.2


@pytest.mark.parametrize("left_hand", [False, True])
@pytest.mark.parametrize("side", [1, -1])
def test_a_long_body_stays_in_its_lane_in_a_wide_bend(side: int, left_hand: bool) -> None:
    angles = np.linspace(0.0, 1.5, 180)
    line = np.column_stack([60.0 * np.sin(angles), side * 60.0 * (1.0 - np.cos(angles))])
    moved = centred(line, np.full(len(line), 1.6), TRAILER, left_hand)
    away = np.hypot(moved[60:120, 0], side * moved[60:120, 1] - 60.0) - 60.0
    keeps_out_of_oncoming = (side > 0) == left_hand
    assert away.min() > (-1e-6 if keeps_out_of_oncoming else 0.1)
    assert away.max() < 0.5  # its rear is 1 m inside
    assert np.array_equal(centred(line, np.full(len(line), 1.6), CAR, left_hand), line)


@pytest.mark.parametrize(("length", "apart"), [(7.0, 11.0), (12.0, 3.2), (12.0, 14.0)])
def test_a_u_turn_that_takes_no_moves_can_be_steered(length: float, apart: float) -> None:
    a, b = road("a", [(0, 0), (100, 0)]), road("b", [(100, apart), (0, apart)])
    world = graph([a, b], [("a_0", "b_0")], {"a_0": [(101.2, 0.6), (101.2, apart - 0.6)]})
    van = replace(BUS, length=length, wheelbase=0.6 * length, front_overhang=0.18 * length)
    found = plan(world, AB, van, start_on(world.lanes["a_0"], 20.0))
    assert steering(found, van) <= van.max_steering_angle + 0.02


def test_the_curve_is_sampled_at_even_arc_length() -> None:
    world = corner(6.0, 5)
    curve = plan(world, AB, CAR, start_on(world.lanes["a_0"], 10.0)).curve
    steps = np.hypot(np.diff(curve.x), np.diff(curve.y))
    assert np.allclose(steps, curve.step, rtol=0.01)
    assert np.allclose(np.diff(curve.heading), 0.5 * (curve.curvature[1:] + curve.curvature[:-1]) * curve.step, atol=0.01)


@settings(max_examples=25, deadline=None)
@given(st.floats(-1.6, 1.6), st.floats(0.0, 15.0), st.floats(5.0, 50.0))
def test_the_curve_begins_at_the_front_axle_in_its_direction(offset: float, speed: float, position: float) -> None:
    world = graph([road("a", [(0, 0), (200, 0)])], [])
    start = start_on(world.lanes["a_0"], position, speed, offset)
    curve = plan(world, Route(("a",)), CAR, start).curve
    assert (curve.x[0], curve.y[0]) == pytest.approx((position - 0.9, offset), abs=0.02)
    assert curve.heading[0] == pytest.approx(0.0, abs=0.03)
    assert np.abs(curve.curvature).max() * min(speed, 8.0) ** 2 < 4.0 + 8.0 * (speed < 4.0)
    assert curve.at(150.0)[1] == pytest.approx(0.0, abs=0.02)


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("speed", [0.0, 8.0, 15.0])
def test_a_change_now_is_comfortable_at_the_present_speed(side: int, speed: float) -> None:
    world = graph([road("a", [(0, 0), (300, 0)], 3)], [])
    found = plan(world, Route(("a",)), CAR, start_on(world.lanes["a_1"], 60.0, speed), change_now=side)
    assert np.abs(found.curve.curvature).max() <= min(CAR.max_curvature, 3.0 / max(speed, 1.0) ** 2)
    (change,) = found.lane_changes
    assert (change.start, change.side) == (0.0, side)
    assert [s.lane_id for s in found.segments] == ["a_1", f"a_{1 + side}"]
    assert found.curve.at(change.end + 5.0)[1] == pytest.approx(3.2 * (1 + side), abs=0.15)


def test_a_late_change_is_smooth_at_the_envelope_speed() -> None:
    world = graph([road("a", [(0, 0), (300, 0)], 2), road("b", [(301, 0), (400, 0)])], [("a_0", "b_0")])
    found = plan(world, AB, CAR, start_on(world.lanes["a_1"], 10.0))
    lateral = np.abs(found.curve.curvature) * found.speed_limits**2
    assert lateral.max() < 1.1 * CAR.comfort_lateral_acceleration


def test_a_point_of_a_lane_lies_where_its_segment_says() -> None:
    world = corner(7.0, 6)
    found = plan(world, AB, CAR, start_on(world.lanes["a_0"], 10.0))
    for segment in found.segments:
        spine = world.lanes[segment.lane_id].spine
        for p in np.linspace(max(segment.lane_offset, 0.0), spine.length, 8):
            x, y, _ = found.curve.at(segment.start + (p - segment.lane_offset) * segment.stretch)
            assert math.hypot(x - spine.at(p)[0], y - spine.at(p)[1]) < 0.4


def test_segments_follow_one_another_without_gaps() -> None:
    world = corner(7.0, 6)
    found = plan(world, AB, CAR, start_on(world.lanes["a_0"], 10.0))
    assert found.segments[0].start == 0.0
    assert all(a.end == b.start for a, b in zip(found.segments, found.segments[1:], strict=False))
    assert found.curve.length >= found.goal + 9.0 if found.goal is not None else False


def test_a_plan_can_begin_inside_a_junction() -> None:
    world = corner(9.0, 8)
    found = plan(world, AB, CAR, start_on(world.lanes[":J0_0"], 6.0))
    assert [s.lane_id for s in found.segments] == [":J0_0", "b_0"]
    assert found.passages[0].start < 0.0
    assert steering(found) <= CAR.max_steering_angle


def test_the_plan_ends_at_the_horizon_without_a_goal() -> None:
    world = graph([road("a", [(0, 0), (5000, 0)])], [])
    found = plan(world, Route(("a",)), CAR, start_on(world.lanes["a_0"], 10.0))
    assert found.goal is None
    assert found.curve.length == pytest.approx(2000.0, abs=1.0)


def test_lanes_shorter_than_a_metre_are_driven_over() -> None:
    roads = [road("a", [(0, 0), (50, 0)]), road("b", [(50.1, 0), (50.3, 0)]), road("c", [(50.4, 0), (100, 0)])]
    world = graph(roads, [("a_0", "b_0"), ("b_0", "c_0")])
    found = plan(world, Route(("a", "b", "c")), CAR, start_on(world.lanes["b_0"], 0.1, route_index=1))
    assert [s.lane_id for s in found.segments] == ["b_0", ":J1_0", "c_0"]
    assert np.abs(found.curve.curvature).max() < 0.01


def led_out(speed: float, offset: float, error: float) -> tuple[float, float]:
    """Return how far out (m) C leads and its largest curvature (1/m) where a car is `offset` m beside the lane's centre
    and heads `error` rad farther out."""
    world = graph([road("a", [(0, 0), (400, 0)], speed=25.0)], [])
    start = start_on(world.lanes["a_0"], 60.0, speed, offset)
    pose = start.pose._replace(heading=error, y=offset - CAR.wheelbase * math.sin(error))
    found = plan(world, Route(("a",)), CAR, replace(start, pose=pose)).curve
    return float(np.abs(found.y).max()), float(np.abs(found.curvature).max())


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("speed", [5.0, 15.0, 22.0])
def test_a_car_that_heads_out_of_its_lane_is_led_back_as_soon_as_it_can_turn(speed: float, side: int) -> None:
    """At 22 m/s, 0.09 rad take 0.5 m at 4 m/s² sideways; a transition in comfort led 1.5 m out."""
    farthest, curvature = led_out(speed, side * 1.5, side * 0.09)
    assert farthest < 1.5 + 0.7
    assert curvature * speed**2 < 1.3 * CAR.max_lateral_acceleration


def test_a_car_that_heads_a_little_out_in_its_lane_is_led_back_in_comfort() -> None:
    farthest, curvature = led_out(22.0, 0.1, 0.02)
    assert farthest < 0.7
    assert curvature * 22.0**2 < CAR.comfort_lateral_acceleration


@pytest.mark.parametrize(("degrees", "radius"), [(90.0, 3.0), (90.0, 6.0), (120.0, 10.0)])
def test_a_long_body_keeps_its_front_on_the_road_in_a_left_turn(degrees: float, radius: float) -> None:
    """Half of a lane of 3.2 m and half of a width of 2.5 m beside its lane it would be off it."""
    angle = math.radians(degrees)
    end = 60.0 + radius * math.sin(angle), radius * (1.0 - math.cos(angle))
    behind = end[0] + 60.0 * math.cos(angle), end[1] + 60.0 * math.sin(angle)
    bend = [(60.0 + radius * math.sin(t), radius * (1.0 - math.cos(t))) for t in np.linspace(0.0, angle, 7)[1:-1]]
    world = graph([road("a", [(0, 0), (60, 0)]), road("b", [end, behind])], [("a_0", "b_0")], {"a_0": bend})
    found = plan(world, AB, TRAILER, start_on(world.lanes["a_0"], 20.0))
    line = Polyline(joined([world.lanes[lane].spine.points for lane in ("a_0", ":J0_0", "b_0")]))
    assert min(line.project(x, y)[1] for x, y in bumper(found, TRAILER).points[20:-40]) > -2.85
