"""Judges: each figure against a case computed by hand."""

import math
import tracemalloc
from dataclasses import replace

import numpy as np
import pytest
from scenes import drive, record, user

from sumo_reactive.driver.geometry.polyline import Polyline
from sumo_reactive.driver.nouns.event import Event, EventKind
from sumo_reactive.driver.nouns.record import Scene
from sumo_reactive.driver.world.junction import Connection, Control, Junction, Turn
from sumo_reactive.driver.world.lane import VEHICLE_CLASSES, Lane
from sumo_reactive.driver.world.regions import ConflictKind, ConflictRegion, Interval, PostConflictRegion
from sumo_reactive.driver.world.right_of_way import RightOfWay
from sumo_reactive.driver.world.road_graph import RoadGraph, arcs_of
from sumo_reactive.lab.fault import HARD_BRAKING
from sumo_reactive.lab.metrics.jury import Jury


@pytest.fixture
def jury():
    return Jury(5.0, 1.8, 3.0)


def violations_of(jury):
    return [fault for fault in jury.faults if fault.kind != HARD_BRAKING]


def test_a_drive_alone_has_no_conflicts(jury):
    drive(jury, lambda t: record(t, x=10.0 * t, speed=10.0), lambda t: [], 50)
    figures = jury.figures()
    assert figures["collisions"] == figures["red_lights_run"] == figures["hard_braking_caused"] == 0
    assert figures["min_time_to_collision_s"] is None
    assert figures["min_post_encroachment_s"] is None


def test_one_contact_is_one_collision_however_long_it_lasts(jury):
    drive(jury, lambda t: record(t, x=10.0 * t, speed=10.0), lambda t: [user(x=15.0, speed=0.0)], 40)
    assert [(c.user_id, c.lane_id) for c in jury.faults] == [("other", "road_0")]
    assert jury.faults[0].time == pytest.approx(1.1)


def test_whom_the_ego_touches_is_a_collision_whether_its_driver_looks_at_him_or_not(jury):
    beside = (user("overlooked", x=2.0), user("reactive.ghost.0", x=1.0), user("near", x=2.0, y=5.0))
    for k in range(3):
        jury.see(Scene(record(0.1 * k), (user("seen", x=1.0),), beside=(*beside, user("seen", x=1.0))))
    assert [one.user_id for one in jury.faults] == ["overlooked", "seen"]
    assert jury.figures()["min_time_to_collision_s"] is None


@pytest.mark.parametrize(
    ("heading", "lane", "touches"), [(1.5, "under_0", False), (1.5, "joined_0", True), (0.4, "under_0", True)]
)
def test_who_crosses_on_a_bridge_is_not_touched(jury, heading, lane, touches):
    """On a lane that no junction joins, across the ego's way; along it he is on the same road, over short edges."""
    other = user("other", x=-1.0, heading=heading)._replace(lane_id=lane)
    seen = ((other,), ()), ((), (other,))
    for k, (users, beside) in enumerate(seen):
        jury.see(Scene(record(0.1 * k), users, beside=beside, apart=lambda _, lane_id: lane_id == "under_0"))
    assert bool(jury.faults) is touches


def test_a_graze_thinner_than_the_shrink_is_no_collision(jury):
    drive(jury, lambda t: record(t, x=10.0 * t, speed=10.0), lambda t: [user(x=15.0, y=1.71)], 40)
    assert not jury.faults


def test_a_ghost_is_nobody(jury):
    drive(jury, lambda t: record(t), lambda t: [user("reactive.ghost.0", x=1.0)], 3)
    assert not jury.faults


def test_time_to_collision_is_gap_over_closing_speed(jury):
    jury.see(Scene(record(speed=10.0), (user(x=35.0, speed=4.0),)))
    assert jury.figures()["min_time_to_collision_s"] == pytest.approx(30.0 / 6.0, abs=1e-3)


def test_a_car_that_passes_beside_is_on_no_collision_course(jury):
    jury.see(Scene(record(speed=10.0), (user(x=35.0, y=3.2, heading=math.pi, speed=10.0),)))
    assert jury.figures()["min_time_to_collision_s"] is None


def test_post_encroachment_is_the_time_between_leaving_and_entering(jury):
    # The other crosses x ∈ [19.1, 20.9] from south to north and leaves the ego's strip |y| < 0.9 at t = 1.09 s: its rear
    # is at y = −10 + 10 t − 5 = 0.9 at t = 1.59 s. The ego's front (x = 5 t) reaches 19.1 m at 3.82 s.
    others = lambda t: [user(x=20.0, y=-10.0 + 10.0 * t, heading=math.pi / 2, speed=10.0)]  # noqa: E731
    drive(jury, lambda t: record(t, x=5.0 * t, speed=5.0), others, 80)
    assert jury.figures()["min_post_encroachment_s"] == pytest.approx(3.82 - 1.59, abs=0.2)


@pytest.mark.parametrize(("late", "near"), [(0.0, 0), (1.0, 1)])
def test_who_leaves_a_place_less_than_one_and_a_half_seconds_before_is_a_near_miss(jury, late, near):
    others = lambda t: [user(x=20.0, y=-10.0 + 10.0 * (t - late), heading=math.pi / 2, speed=10.0)]  # noqa: E731
    drive(jury, lambda t: record(t, x=5.0 * t, speed=5.0), others, 80)
    assert jury.figures()["near_misses_by_pet"] == near


def test_each_user_is_a_near_miss_once_however_often_it_comes_near(jury):
    def others(t):
        gap = 12.0 if 1.0 < t < 2.0 else 30.0
        return [user("a", x=10.0 * t + gap + 5.0, speed=0.0), user("b", x=10.0 * t + 60.0, speed=0.0)]

    drive(jury, lambda t: record(t, x=10.0 * t, speed=10.0), others, 30)
    drive(jury, lambda t: record(4.0 + t, x=10.0 * t, speed=10.0), others, 30)
    assert jury.figures()["near_misses_by_ttc"] == 1


@pytest.mark.parametrize(("heading", "near"), [(0.0, 1), (math.pi, 0)])
def test_who_is_oncoming_is_no_near_miss(jury, heading, near):
    drive(jury, lambda t: record(t, speed=10.0), lambda t: [user(x=15.0, heading=heading, speed=0.0)], 3)
    assert jury.figures()["near_misses_by_ttc"] == near


def test_who_turns_past_a_waiting_ego_is_no_near_miss(jury):
    drive(jury, lambda t: record(t, speed=0.0), lambda t: [user(x=3.4, y=3.7, heading=math.radians(-127.0), speed=6.4)], 3)
    figures = jury.figures()
    assert figures["min_time_to_collision_s"] < 1.5 and figures["near_misses_by_ttc"] == 0


def test_following_in_a_lane_is_no_encroachment(jury):
    others = lambda t: [user(x=15.0 + 10.0 * t, speed=10.0)]  # noqa: E731
    drive(jury, lambda t: record(t, x=10.0 * t, speed=10.0), others, 50)
    assert jury.figures()["min_post_encroachment_s"] is None


@pytest.mark.parametrize(
    ("letters", "runs"),
    [("rr", 1), ("RR", 1), ("uu", 1), ("ur", 1), ("ss", 0), ("gg", 0), ("yy", 0), ("yr", 0), ("rg", 0), ("ug", 0), ("", 0)],
)
def test_a_stop_line_crossed_on_red_before_the_step_and_in_it_is_a_red_light_run(jury, letters, runs):
    jury.see(Scene(record(), (), letters))
    assert len(violations_of(jury)) == jury.figures()["red_lights_run"] == runs


@pytest.mark.parametrize(("then", "runs"), [("before", 0), ("behind", 1)])
def test_a_line_before_which_the_ego_is_again_was_not_crossed(jury, then, runs):
    for t, (lane, letters) in enumerate((("before", ""), ("inside", "rr"), ("inside", ""), (then, ""), ("before", ""))):
        jury.see(Scene(record(0.1 * t, lane_id=lane), (), letters))
    assert jury.figures()["red_lights_run"] == runs


def _brakes_behind(x, y=0.0):
    return lambda t: [user(x=x, y=y, speed=15.0 if t < 0.15 else 14.0)]


def test_a_follower_that_brakes_hard_is_caused_by_the_ego_once(jury):
    drive(jury, lambda t: record(t, speed=5.0), _brakes_behind(-30.0), 5)
    assert jury.figures()["hard_braking_caused"] == 1


@pytest.mark.parametrize(("braking", "caused"), [(0.3, 0), (4.7, 1)])
def test_who_comes_onto_a_lane_where_sumo_counts_other_metres_need_not_brake_for_it(jury, braking, caused):
    """A lane drawn a tenth longer than declared is left at 16.5 m/s over ground, for the next one at 15."""

    def others(t):
        is_on_next = t >= 0.2
        behind = user(x=-30.0, speed=15.0 if is_on_next else 16.5, lane="next_0" if is_on_next else "longer_0")
        return [behind._replace(acceleration=-braking if is_on_next else 0.0)]

    drive(jury, lambda t: record(t, speed=5.0), others, 4)
    assert jury.figures()["hard_braking_caused"] == caused


@pytest.mark.parametrize(("braking", "caused"), [(4.5, 0), (4.7, 1)])
def test_braking_is_hard_if_it_is_harder_than_sumos_cars_brake_in_comfort(jury, braking, caused):
    others = lambda t: [user(x=-30.0, speed=15.0 - braking * max(t - 0.1, 0.0))]  # noqa: E731
    drive(jury, lambda t: record(t, speed=5.0), others, 6)
    assert jury.figures()["hard_braking_caused"] == caused


def test_a_car_on_another_lane_is_not_the_egos_follower(jury):
    drive(jury, lambda t: record(t, speed=5.0), _brakes_behind(-30.0, y=3.2), 5)
    assert jury.figures()["hard_braking_caused"] == 0


def test_the_nearest_body_ahead_is_the_leader(jury):
    drive(
        jury, lambda t: record(t, speed=5.0), lambda t: [*_brakes_behind(-30.0)(t), user("between", x=-12.0, speed=15.0)], 5
    )
    assert jury.figures()["hard_braking_caused"] == 0


def test_comfort_figures_follow_from_speed_and_steering(jury):
    speeds = [0.0, 0.0, 0.2, 0.4, 0.1]
    for k, speed in enumerate(speeds):
        jury.see(Scene(record(0.1 * k, speed=speed, steering_angle=0.5, lane_id="" if k == 4 else "a_0"), ()))
    figures = jury.figures()
    assert figures["max_acceleration_m_s2"] == pytest.approx(2.0)
    assert figures["max_braking_m_s2"] == pytest.approx(3.0)
    assert figures["max_lateral_acceleration_m_s2"] == pytest.approx(0.16 * math.sin(0.5) / 3.0, abs=1e-3)
    assert figures["rms_jerk_m_s3"] == pytest.approx(math.sqrt((20.0**2 + 0.0 + 50.0**2) / 3.0), abs=1e-2)
    assert figures["standstill_s"] == pytest.approx(0.1)
    assert figures["off_road_s"] == pytest.approx(0.1)


def test_the_runs_of_the_pilot_the_steps_without_it_and_the_events_are_counted(jury):
    both = Event(EventKind.LIGHT_CHANGE, "tl"), Event(EventKind.NEW_OBSTACLE, "veh_12")
    for k in range(4):
        jury.see(Scene(record(0.1 * k, pilot=(0, 2, 1, 0)[k], events=both if k == 1 else ()), ()))
    figures = jury.figures()
    assert (figures["pilot_activations"], figures["pilot_free_share"]) == (3, 0.5)
    assert [figures[f"events_{kind}"] for kind in ("light_change", "new_obstacle", "delay")] == [1, 1, 0]


def test_wall_clock_figures_are_kept_apart(jury):
    drive(jury, lambda t: record(t, control_us=50.0 + 1000.0 * t), lambda t: [], 11)
    assert jury.timing()["control_step_max_us"] == pytest.approx(1050.0)
    assert not set(jury.timing()) & set(jury.figures())


def _crossing(mutual: bool = False) -> RoadGraph:
    """West–east (the ego's) yields to south–north; both roads are 40 m, the crossing 20 m wide."""
    lines = {"we": [(-10.0, 0.0), (10.0, 0.0)], "sn": [(0.0, -10.0), (0.0, 10.0)]}
    connections = {
        name: Connection(
            id=name,
            junction_id="j",
            index=k,
            from_lane=f"{name}in_0",
            to_lane=f"{name}out_0",
            parts=(f":j_{k}_0",),
            path=Polyline(np.array(line)),
            turn=Turn.STRAIGHT,
            control=Control.MINOR,
        )
        for k, (name, line) in enumerate(lines.items())
    }
    square = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])
    middle = Interval(9.0, 11.0)
    region = ConflictRegion(
        id="r", kind=ConflictKind.CROSSING, own_id="we", other_id="sn", own=middle, other=middle, polygon=square,
        post=PostConflictRegion("we", 11.0),
    )  # fmt: skip
    spines = {"snin_0": [(0.0, -50.0), (0.0, -10.0)], "snout_0": [(0.0, 10.0), (0.0, 50.0)]}
    lanes = {
        name: Lane(
            id=name, edge_id=name[:-2], index=0, spine=Polyline(np.array(spine)), length=40.0, width=3.2, speed_limit=13.9,
            allowed=VEHICLE_CLASSES,
        )
        for name, spine in spines.items()
    }  # fmt: skip
    rule = RightOfWay(np.array([[False, True], [mutual, False]]), np.array([[False, True], [True, False]]))
    ways = tuple(connections.values())
    return RoadGraph(
        lanes=lanes,
        edge_lanes={},
        junctions={"j": Junction(id="j", kind="priority", outline=square, connections=ways, right_of_way=rule)},
        connections=connections,
        regions={"r": region},
        arcs=arcs_of(connections, [region]),
        opposite={},
        left_hand=False,
    )


def _one_brakes(t, braking, route=("snin", "snout")):
    speed = 10.0 - braking * max(t - 0.1, 0.0)
    return [user(x=0.0, y=-25.0, heading=math.pi / 2, speed=speed, lane="snin_0", position=25.0, route=route)]


@pytest.mark.parametrize(
    ("x", "braking", "mutual", "route", "violations"),
    [
        (2.0, 4.0, False, ("snin", "snout"), 1),
        (2.0, 2.0, False, ("snin", "snout"), 0),  # comfortable
        (-5.0, 4.0, False, ("snin", "snout"), 0),  # the ego waits before the region
        (2.0, 4.0, True, ("snin", "snout"), 0),  # neither goes first
        (2.0, 4.0, False, ("snin", "left"), 0),  # it turns off
    ],
)
def test_who_has_priority_and_must_brake_hard_is_obstructed(jury, x, braking, mutual, route, violations):
    ego, world = (lambda t: record(t, x=x, speed=1.0, lane_id=":j_0_0")), _crossing(mutual)
    drive(jury, ego, lambda t: _one_brakes(t, braking, route), 8, world=world)
    assert len(violations_of(jury)) == violations
    assert [v.user_id for v in violations_of(jury)] == ["other"] * violations


@pytest.mark.parametrize(
    ("gone_to", "speed_then", "braking_then", "violations"),
    [
        ((40.0, 0.0), 6.8, 0.0, 1),  # he stops braking when the ego is gone
        ((40.0, 0.0), 6.8, 4.0, 0),  # he brakes on
        ((40.0, 0.0), 0.4, 0.0, 1),  # he stands by then
        ((5.0, -17.0), 6.8, 4.0, 1),  # he brakes on behind the ego
    ],
)
def test_who_brakes_on_when_the_ego_is_gone_has_another_reason(jury, gone_to, speed_then, braking_then, violations):
    def ego(t):
        x, y = (2.0, 0.0) if t < 0.95 else gone_to
        return record(t, x=x, y=y, speed=1.0, lane_id=":j_0_0")

    def one(t):
        (other,) = _one_brakes(t, 4.0)
        return [other if t < 0.95 else other._replace(speed=max(speed_then - braking_then * (t - 0.9), 0.0))]

    drive(jury, ego, one, 25, world=_crossing())
    assert len(violations_of(jury)) == violations


@pytest.mark.parametrize(("position", "speed", "violations"), [(2.0, 13.9, 0), (2.0, 10.0, 1), (25.0, 13.9, 1)])
def test_who_comes_onto_a_slower_road_brakes_for_that(jury, position, speed, violations):
    world = _crossing()
    one = user(x=0.0, y=-25.0, heading=math.pi / 2, lane="snin_0", position=position, route=("snin", "snout"))
    for k in range(20):
        now = speed + 0.4 * max(10 - k, 0)  # −4 m/s² for a second
        jury.see(Scene(record(0.1 * k, x=2.0, speed=1.0, lane_id=":j_0_0"), (one._replace(speed=now),), world=world))
    assert len(violations_of(jury)) == violations


@pytest.mark.parametrize(("dip", "violations"), [(0.45, 0), (2.0, 1)])
def test_a_dip_of_the_speed_within_one_step_is_no_obstruction(jury, dip, violations):
    world = _crossing()
    one = user(x=0.0, y=-25.0, heading=math.pi / 2, lane="snin_0", position=25.0, route=("snin", "snout"))
    for k in range(20):
        speed = 14.0 - dip * (k == 12)
        jury.see(Scene(record(0.1 * k, x=2.0, speed=1.0, lane_id=":j_0_0"), (one._replace(speed=speed),), world=world))
    assert len(violations_of(jury)) == violations


def test_on_a_new_route_the_junction_that_it_does_not_pass_is_forgotten(jury):
    before, after = _crossing(), replace(_crossing(), connections={}, junctions={}, regions={}, arcs=())
    for k in range(20):
        (one,) = _one_brakes(0.1 * k, 4.0)
        world = before if k < 5 else after
        jury.see(Scene(record(0.1 * k, x=2.0, speed=1.0, lane_id=":j_0_0" if k < 5 else "new_0"), (one,), world=world))
    assert violations_of(jury) == []


def test_long_bodies_are_laid_on_the_grid_a_few_at_a_time(jury):
    """A train of 200 m crosses the ego's way behind it; all its places at once take 275 MB, a longer one's gigabytes."""

    def train(t):
        return user(x=20.0, y=10.0 * t - 65.0, heading=math.pi / 2.0, speed=10.0, size=(200.0, 3.0))

    drive(jury, lambda t: record(t, x=10.0 * t, speed=10.0), lambda t: [train(t)] if t > 2.95 else [], 100)
    tracemalloc.start()
    try:
        assert jury.figures()["min_post_encroachment_s"] == pytest.approx(3.9)
        assert tracemalloc.get_traced_memory()[1] < 1e8
    finally:
        tracemalloc.stop()
