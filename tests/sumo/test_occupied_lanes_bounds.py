"""From where to where a stand-in shows the ego, to the decimetre, on a road written by hand."""

import math
from dataclasses import replace
from types import SimpleNamespace

import pytest
from occupants import ahead, cut_in_bend, elsewhere, in_change, occupied

from sumo_reactive.driver.nouns.plan import Aside, LaneChange, LaneSegment, Turnaround
from sumo_reactive.driver.nouns.snapshot import OffTracking
from sumo_reactive.driver.nouns.state import Pose, VehicleState
from sumo_reactive.driver.vehicle.limits import VehicleLimits
from sumo_reactive.sumo import stand_ins
from sumo_reactive.sumo.net_reader import read_net
from sumo_reactive.sumo.stand_ins import OFF_TRACKING_SEEN_S, Occupant, OccupiedLane

CAR = VehicleLimits(
    length=4.7, width=1.8, wheelbase=2.8, front_overhang=0.85, max_speed=50.0, max_acceleration=2.6,
    comfort_deceleration=2.5, service_deceleration=4.5, emergency_deceleration=9.0, max_steering_angle=0.65,
    max_steering_rate=1.0, max_lateral_acceleration=4.0, comfort_lateral_acceleration=3.0,
)  # fmt: skip
LANE = '<lane id="{0}" index="{1}" speed="9" length="{2}" shape="{3},{4} {5},{4}"/>'
NET = f"""<net>
  <edge id=":b_0" function="internal">{LANE.format(":b_0_0", 0, 10, 300, -4.8, 310)}
    {LANE.format(":b_0_1", 1, 10, 300, -1.6, 310)}</edge>
  <edge id="ab" from="a" to="b">{LANE.format("ab_0", 0, 300, 0, -4.8, 300)}
    {LANE.format("ab_1", 1, 300, 0, -1.6, 300)}</edge>
  <edge id="ba" from="b" to="a">{LANE.format("ba_0", 0, 300, 300, 1.6, 0)}</edge>
  <edge id="bc" from="b" to="c">{LANE.format("bc_0", 0, 90, 310, -4.8, 400)}
    {LANE.format("bc_1", 1, 90, 310, -1.6, 400)}</edge>
  <junction id="a" type="dead_end" x="0" y="0" incLanes="ba_0" intLanes="" shape="0,0 0,3"/>
  <junction id="b" type="priority" x="300" y="0" incLanes="ab_0 ab_1" intLanes=":b_0_0 :b_0_1">
    <request index="0" response="00" foes="00" cont="0"/><request index="1" response="00" foes="00" cont="0"/></junction>
  <junction id="c" type="dead_end" x="400" y="0" incLanes="bc_0 bc_1" intLanes="" shape="400,0 400,3"/>
  <connection from="ab" to="bc" fromLane="0" toLane="0" via=":b_0_0" dir="s" state="M"/>
  <connection from="ab" to="bc" fromLane="1" toLane="1" via=":b_0_1" dir="s" state="M"/>
  <connection from=":b_0" to="bc" fromLane="0" toLane="0" dir="s" state="M"/>
  <connection from=":b_0" to="bc" fromLane="1" toLane="1" dir="s" state="M"/>
</net>"""
EDGES = ("ab", "bc")


@pytest.fixture
def road(tmp_path):
    """ab_0 and ab_1 to the east, their middles at y = −4.8 and −1.6, with ba_0 beside at 1.6; bc goes on at x = 310."""
    (tmp_path / "road.net.xml").write_text(NET)
    return read_net(tmp_path / "road.net.xml").build(EDGES)


def ego_at(x, y, heading=0.0, speed=5.0):
    """A car whose bumper is at (x, y)."""
    reach = CAR.front_to_rear_axle
    return VehicleState(Pose(x - reach * math.cos(heading), y - reach * math.sin(heading), heading), speed, 0.0)


def planned(*changes, aside=None):
    """What is asked of a plan here."""
    return SimpleNamespace(lane_changes=changes, aside=aside)


def on(lane_id):
    return SimpleNamespace(lane_id=lane_id)


def shown(seen):
    return None if seen is None else (seen.lane.id, round(seen.x, 3), round(seen.y, 3))


@pytest.mark.parametrize(
    ("own", "y", "heading", "place"),
    [
        ("ab_1", 1.0, 0.5, ("ab_1", 64.7 - 4.7 * math.cos(0.5), -1.6)),
        ("ab_1", 1.0, 0.0, ("ab_1", 60.0, 1.0)),  # its middle is beside every lane too
        ("ab_0", -2.2, 0.5, ("ab_0", 60.0, -2.2)),  # SUMO maps the front to ab_1
        ("ab_1", -4.2, -0.5, ("ab_1", 60.0, -4.2)),
        ("ab_1", -7.4, -0.5, ("ab_0", 64.7 - 4.7 * math.cos(0.5), -4.8)),
        (":b_0_1", -4.2, -0.5, (":b_0_1", 60.0, -4.2)),
        (":b_0_1", 1.0, 0.5, ("ab_1", 64.7 - 4.7 * math.cos(0.5), -1.6)),
    ],
)
def test_who_has_swung_out_is_on_his_lane_or_where_sumo_sees_no_front_under_his_middle(road, own, y, heading, place):
    seen = occupied(road, planned(), on(own), ego_at(60.0, y, heading), 10.0, CAR, EDGES)
    assert shown(seen) == (place[0], round(place[1], 3), round(place[2], 3))
    assert (seen.speed, seen.edges, seen.waits) == (5.0, EDGES, False)


@pytest.mark.parametrize("x", [0.5, 2.0, 4.7, 30.0])
@pytest.mark.parametrize("heading", [0.4, 1.5, 2.5])
def test_who_is_shown_where_he_has_swung_out_has_his_rear_where_his_body_is(road, x, heading):
    seen = occupied(road, planned(), on("ab_1"), ego_at(x, 1.0, heading), 10.0, CAR, EDGES)
    nearest = min(x, x - CAR.length * math.cos(heading))
    assert seen.x - CAR.length == pytest.approx(max(nearest, -CAR.length))


CHANGE = LaneChange(from_lane="ab_0", to_lane="ab_1", side=1, opens=0.0, start=40.0, end=80.0)
BACK = LaneChange(from_lane="ab_1", to_lane="ab_0", side=-1, opens=0.0, start=40.0, end=80.0)


@pytest.mark.parametrize(
    ("change", "lane_id", "y", "s", "lane"),
    [
        (CHANGE, "ab_0", -4.8, 39.9, None),
        (CHANGE, "ab_0", -4.8, 40.0, "ab_1"),
        (CHANGE, "ab_0", -3.3, 60.0, "ab_1"),
        (CHANGE, "ab_1", -3.3, 60.0, "ab_1"),
        (CHANGE, "ab_1", -3.1, 60.0, "ab_0"),
        (CHANGE, "ab_1", -1.6, 80.0, "ab_0"),  # until its end, wherever the body is
        (CHANGE, "ab_1", -2.25, 80.1, "ab_0"),  # then until no more of the body than a decimetre is on the old lane
        (CHANGE, "ab_1", -2.15, 80.1, None),
        (CHANGE, "ab_1", -2.25, 84.7, "ab_0"),
        (CHANGE, "ab_1", -2.25, 84.8, None),
        (BACK, "ab_1", -3.1, 60.0, "ab_0"),
        (BACK, "ab_0", -3.1, 60.0, "ab_0"),
        (BACK, "ab_0", -3.3, 60.0, "ab_1"),
        (BACK, "ab_0", -4.15, 80.1, "ab_1"),
        (BACK, "ab_0", -4.25, 80.1, None),
        (CHANGE, "bc_0", -4.8, 59.9, "bc_1"),  # C is on another road: there the change has its first half and its second
        (CHANGE, "bc_1", -1.6, 60.1, "bc_0"),
        (CHANGE, "bc_1", -1.6, 59.9, None),
        (CHANGE, "bc_0", -4.8, 60.1, None),
        (CHANGE, "ba_0", 1.6, 60.0, None),
        (CHANGE, ":b_0_0", -4.8, 60.0, None),
        (CHANGE, "nowhere", -4.8, 60.0, None),
    ],
)
def test_a_change_is_seen_from_its_begin_until_the_rear_has_left_the_old_lane(road, change, lane_id, y, s, lane):
    found = in_change(road, planned(change), on(lane_id), 60.0, y, s, CAR)
    assert (found.id if found else None) == lane


def test_of_several_changes_the_one_under_way_counts(road):
    plan = planned(replace(CHANGE, start=0.0, end=10.0), BACK)
    assert in_change(road, plan, on("ab_1"), 60.0, -1.6, 60.0, CAR).id == "ab_0"
    assert in_change(road, plan, on("ab_1"), 60.0, -1.6, 30.0, CAR) is None


@pytest.mark.parametrize(
    ("lane_id", "lateral", "y", "heading", "place"),
    [
        ("ab_1", 2.0, -0.85, 0.0, None),  # it covers less than a decimetre of ba_0
        ("ab_1", 2.0, -0.75, 0.0, ("ba_0", 55.3, -0.75)),
        ("ab_1", 0.1, 1.0, 0.3, ("ba_0", 60.0 - 4.7 * math.cos(0.3), 1.0 - 4.7 * math.sin(0.3))),
        ("ab_1", -2.0, -2.35, 0.0, None),
        ("ab_1", -2.0, -2.45, 0.0, ("ab_0", 60.0, -2.45)),
        ("ab_1", -0.1, -3.3, 0.3, ("ab_1", 60.0, -3.3)),
        ("ab_0", 2.0, -3.3, 0.3, ("ab_1", 60.0, -3.3)),
        ("ab_0", 2.0, -3.1, 0.0, ("ab_0", 60.0, -3.1)),
        ("ab_0", -2.0, 1.0, 0.0, ("ba_0", 55.3, 1.0)),  # beside the outer lane there is but the oncoming one
        ("ba_0", 2.0, -1.6, math.pi, None),  # whose own oncoming lanes are not known
    ],
)
def test_beside_its_lane_the_ego_is_shown_on_the_lane_that_it_covers(road, lane_id, lateral, y, heading, place):
    plan = planned(aside=Aside(lateral, 60.0, 80.0))
    seen = occupied(road, plan, on(lane_id), ego_at(60.0, y, heading), 10.0, CAR, EDGES)
    assert shown(seen) == (None if place is None else (place[0], round(place[1], 3), round(place[2], 3)))
    if seen is not None:
        assert (seen.speed, seen.edges) == ((0.0, ("ba",)) if seen.lane.id == "ba_0" else (5.0, EDGES))
        assert not seen.waits


LEFT_CUT, INSIDE = OffTracking(50.0, 60.0, True, "ab_1"), OffTracking(50.0, 60.0, False, ":b_0_0")


@pytest.mark.parametrize(
    ("cut", "lane_id", "front", "speed", "stop", "lane"),
    [
        (LEFT_CUT, "ab_0", 39.9, 5.0, math.inf, None),
        (LEFT_CUT, "ab_0", 40.1, 5.0, math.inf, "ab_1"),  # covered within two seconds
        (LEFT_CUT, "ab_0", 40.1, 4.9, math.inf, None),
        (LEFT_CUT, "ab_0", 45.0, 5.0, 49.0, None),  # it stops before
        (LEFT_CUT, "ab_0", 45.0, 5.0, 51.0, "ab_1"),
        (LEFT_CUT, "ab_0", 50.1, 5.0, 49.0, "ab_1"),  # it is there already
        (LEFT_CUT, "ab_0", 64.6, 0.0, math.inf, "ab_1"),
        (LEFT_CUT, "ab_0", 64.8, 0.0, math.inf, None),  # its rear has left
        (LEFT_CUT._replace(left=False), "ab_1", 50.1, 5.0, math.inf, "ab_0"),
        (LEFT_CUT, "ab_1", 50.1, 5.0, math.inf, None),
        (INSIDE, ":b_0_1", 50.1, 5.0, math.inf, ":b_0_0"),
        (INSIDE, "ab_0", 50.1, 5.0, math.inf, ":b_0_0"),  # the cut is inside the junction, the front not yet
    ],
)  # fmt: skip
def test_a_cut_is_shown_from_two_seconds_before_it_until_the_rear_is_out(
    monkeypatch, road, cut, lane_id, front, speed, stop, lane
):
    assert OFF_TRACKING_SEEN_S == 2.0
    plan, s = planned(), front - CAR.front_overhang
    asked = []
    ways = (OffTracking(0.0, 1.0, False, "ab_1"), cut)
    monkeypatch.setattr(stand_ins, "off_tracking_of", lambda *of: (asked.append(of), ways)[1])
    found = cut_in_bend(road, plan, on(lane_id), s, speed, CAR, stop)
    assert (found.id if found else None) == lane
    assert asked == [(plan, road, CAR)]
    x, y = road.lanes[lane_id].spine.at(5.0)
    seen = occupied(road, plan, on(lane_id), ego_at(x, y, speed=speed), s, CAR, EDGES, stop)
    is_early = front < cut.start
    there = found and OccupiedLane(found, pytest.approx(x), pytest.approx(y), speed, EDGES, waits=True, is_early=is_early)
    assert seen == there


@pytest.mark.parametrize(("mapped", "is_shown"), [(":b_0_1", True), (":b_0_0", False), ("ab_1", False), ("", False)])
def test_an_ego_whom_sumo_has_on_another_way_through_a_junction_is_shown_where_its_middle_is(road, mapped, is_shown):
    ways = ("ab_0", 0.0, 300.0, 0), (":b_0_0", 300.0, 310.0, 0), ("bc_0", 310.0, 400.0, 1)
    plan = SimpleNamespace(segments=[
        LaneSegment(lane_id=lane, start=start, end=end, lane_offset=0.0, route_index=edge) for lane, start, end, edge in ways
    ])  # fmt: skip
    seen = elsewhere(road, plan, mapped, 301.0 - CAR.front_overhang, ego_at(301.0, -4.0), CAR, EDGES)
    assert seen == (OccupiedLane(road.lanes["ab_0"], pytest.approx(301.0), -4.0, 5.0, EDGES) if is_shown else None)


@pytest.mark.parametrize(("mapped", "is_shown"), [("ab_0", True), ("ab_1", False), ("bc_1", False)])
def test_an_ego_whom_sumo_has_on_the_lane_beside_is_shown_on_its_own(road, mapped, is_shown):
    plan = SimpleNamespace(segments=[LaneSegment(lane_id="ab_1", start=0.0, end=300.0, lane_offset=0.0, route_index=0)])
    by = Occupant(road, plan, plan.segments[0], ego_at(60.0, -3.0), CAR, mapped)
    seen = stand_ins.mapped_elsewhere(by, 60.0, EDGES)
    assert seen == (OccupiedLane(road.lanes["ab_1"], pytest.approx(60.0), -3.0, 5.0, EDGES) if is_shown else None)


@pytest.mark.parametrize(("y_before", "y", "mapped"), [(-3.5, -3.0, "ab_1"), (-4.0, -3.5, "ab_0"), (-3.0, -2.5, "ab_0")])
def test_sumo_has_an_ego_on_its_own_lane_as_soon_as_it_has_come_over(road, y_before, y, mapped):
    """The line between both lanes is at -3.2 m; a front that was nearer to its own already is mapped by another rule."""
    plan = SimpleNamespace(segments=[LaneSegment(lane_id="ab_1", start=0.0, end=300.0, lane_offset=0.0, route_index=0)])
    by = Occupant(road, plan, plan.segments[0], ego_at(60.0, y), CAR, "ab_0")
    assert stand_ins.mapped_next(by, ego_at(59.0, y_before)) == mapped
    assert (stand_ins.mapped_elsewhere(by._replace(mapped=mapped), 60.0, EDGES) is None) is (mapped == "ab_1")


TURN = Turnaround(
    start=40.0, line=41.0, end=46.0, from_lane="ab_1", from_index=0, to_lane="ba_0", route_index=1, moves=(), duration=20.0,
    into=5.0,
)  # fmt: skip


@pytest.mark.parametrize(
    ("mapped", "heading", "is_shown"),
    [("ab_1", 0.49, True), ("", 0.51, True), ("ba_0", 0.49, True), ("ba_0", 0.51, False), ("ab_1", 0.51, True),
     ("ba_0", -0.8, False)],
)
@pytest.mark.parametrize("y", [-0.1, 0.1, 1.6])
def test_ahead_of_mapping_the_stand_in_has_its_rear_where_the_body_is_farthest_back(road, y, mapped, heading, is_shown):
    """On ba_0, to the west: what is farthest back is farthest to the east. It stays until SUMO has the car there, and along
    that lane: neither that its front is nearer to it tells so, nor that the car points along it."""
    direction = heading * math.pi
    seen = ahead(road, TURN, ego_at(200.0, y, direction), CAR, ("ba",), mapped)
    east = max(200.0, 200.0 - 4.7 * math.cos(direction))
    place = pytest.approx(east - 4.7), pytest.approx(1.6)
    assert seen == (OccupiedLane(road.lanes["ba_0"], *place, 0.0, ("ba",), waits=True) if is_shown else None)
