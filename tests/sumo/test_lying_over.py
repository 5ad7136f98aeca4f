"""The lane that a body lies over although SUMO does not have the ego there."""

import math
from dataclasses import replace
from types import SimpleNamespace

import pytest

from sumo_reactive.driver.nouns.plan import LaneSegment
from sumo_reactive.driver.nouns.state import Pose, VehicleState
from sumo_reactive.driver.vehicle.limits import VehicleLimits
from sumo_reactive.sumo.lying_over import lane_lain_over
from sumo_reactive.sumo.net_reader import read_net
from sumo_reactive.sumo.stand_ins import Occupant, OccupiedLane

CAR = VehicleLimits(
    length=4.7, width=1.8, wheelbase=2.8, front_overhang=0.85, max_speed=50.0, max_acceleration=2.6,
    comfort_deceleration=2.5, service_deceleration=4.5, emergency_deceleration=9.0, max_steering_angle=0.65,
    max_steering_rate=1.0, max_lateral_acceleration=4.0, comfort_lateral_acceleration=3.0,
)  # fmt: skip
LONG = replace(CAR, length=12.0, width=2.5)
LANE = '<lane id="{0}" index="{1}" speed="9" length="{2}" shape="{3},{4} {5},{4}"/>'
NET = f"""<net>
  <edge id=":b_0" function="internal">{LANE.format(":b_0_0", 0, 10, 300, -1.6, 310)}</edge>
  <edge id="ab" from="a" to="b">{LANE.format("ab_0", 0, 300, 0, -4.8, 300)}
    {LANE.format("ab_1", 1, 300, 0, -1.6, 300)}</edge>
  <edge id="ba" from="b" to="a">{LANE.format("ba_0", 0, 300, 300, 1.6, 0)}</edge>
  <edge id="bc" from="b" to="c">{LANE.format("bc_0", 0, 90, 310, -1.6, 400)}</edge>
  <edge id="cb" from="c" to="b">{LANE.format("cb_0", 0, 90, 400, 1.6, 310)}</edge>
  <junction id="a" type="dead_end" x="0" y="0" incLanes="ba_0" intLanes="" shape="0,0 0,3"/>
  <junction id="b" type="priority" x="300" y="0" incLanes="ab_0 ab_1 cb_0" intLanes=":b_0_0">
    <request index="0" response="0" foes="0" cont="0"/></junction>
  <junction id="c" type="dead_end" x="400" y="0" incLanes="bc_0" intLanes="" shape="400,0 400,3"/>
  <connection from="ab" to="bc" fromLane="1" toLane="0" via=":b_0_0" dir="s" state="M"/>
  <connection from=":b_0" to="bc" fromLane="0" toLane="0" dir="s" state="M"/>
</net>"""
EDGES = ("ab", "bc")
WAYS = ("ab_1", 0.0, 300.0, 0), (":b_0_0", 300.0, 310.0, 0), ("bc_0", 310.0, 400.0, 1)


@pytest.fixture
def road(tmp_path):
    """ab_0 and ab_1 to the east, their middles at y = −4.8 and −1.6, with ba_0 beside at 1.6; bc goes on at x = 310."""
    (tmp_path / "road.net.xml").write_text(NET)
    return read_net(tmp_path / "road.net.xml").build(EDGES)


def seen(road, x, y, heading, *, mapped="ab_1", shown="", speed=5.0, limits=LONG):
    """Where an ego with its front at (x, y) is shown that drives along ab_1 and bc_0."""
    plan = SimpleNamespace(
        segments=[LaneSegment(lane_id=n, start=a, end=b, lane_offset=0.0, route_index=k) for n, a, b, k in WAYS],
        passages=[], turnarounds=[], aside=None,
    )  # fmt: skip
    here = next(segment for segment in plan.segments if x < segment.end)
    reach = limits.front_to_rear_axle
    ego = VehicleState(Pose(x - reach * math.cos(heading), y - reach * math.sin(heading), heading), speed, 0.0)
    return lane_lain_over(Occupant(road, plan, here, ego, limits, mapped), x - limits.front_overhang, EDGES, shown)


@pytest.mark.parametrize(("heading", "is_shown"), [(0.0, False), (0.02, False), (0.12, True), (0.3, True)])
def test_an_ego_whose_rear_is_over_the_lane_beside_is_shown_there_as_it_drives(road, heading, is_shown):
    there = OccupiedLane(road.lanes["ab_0"], pytest.approx(60.0), pytest.approx(-1.6), 5.0, EDGES)
    assert seen(road, 60.0, -1.6, heading) == (there if is_shown else None)


def test_it_is_not_shown_twice_on_a_lane(road):
    assert seen(road, 60.0, -1.6, 0.3, shown="ab_0") is None


def test_an_ego_whom_sumo_has_elsewhere_is_shown_on_its_own_lane_where_it_lies_across(road):
    assert seen(road, 60.0, -1.6, 0.3, mapped="ab_0").lane.id == "ab_1"


def test_what_comes_towards_it_sees_something_stand_where_its_body_is(road):
    there = seen(road, 60.0, 0.2, 0.1)
    assert (there.lane.id, there.speed, there.edges, there.waits) == ("ba_0", 0.0, ("ba",), True)
    assert (there.x, there.y) == (pytest.approx(52.8, abs=3.0), pytest.approx(1.6))
    assert 0.0 < there.length < 12.0
    x_behind = there.x + there.length  # the lane leads west
    assert x_behind == pytest.approx(60.0, abs=0.5)


@pytest.mark.parametrize(("y", "is_shown"), [(-0.9, False), (-0.7, True)])
def test_who_reaches_over_it_by_less_than_wide_ones_there_leave_is_not_shown(road, y, is_shown):
    assert (seen(road, 60.0, y, 0.0) is not None) == is_shown


def test_who_stands_on_a_road_keeps_nobody_waiting_who_would_wait_for_it_in_turn(road):
    assert seen(road, 60.0, 0.2, 0.1, speed=0.0) is None


def test_who_stands_half_in_a_junction_is_seen_by_those_who_come(road):
    assert seen(road, 314.0, 0.2, 0.1, mapped="bc_0", speed=0.0).lane.id == "cb_0"
