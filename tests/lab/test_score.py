"""The driving score: each part against a case computed by hand, and how the parts weigh."""

import math
from dataclasses import replace

import numpy as np
import pytest
from helpers.results import result
from scenes import drive, record, user
from scipy.signal import savgol_filter

from sumo_reactive.driver.geometry.polyline import Polyline
from sumo_reactive.driver.world.junction import Connection, Control, Turn
from sumo_reactive.driver.world.lane import VEHICLE_CLASSES, Lane
from sumo_reactive.driver.world.road_graph import RoadGraph
from sumo_reactive.lab.driving_score import driving_score
from sumo_reactive.lab.fault import COLLISION, Fault
from sumo_reactive.lab.metrics.jury import Jury
from sumo_reactive.lab.metrics.score import COMFORT_BOUNDS, SMOOTHED_STEPS, slopes, speed_limit

PARTS = {"ttc_score": 1, "progress_score": 0.8, "speed_limit_score": 0.5, "comfort_score": 0}


def judged(ego, others=lambda t: (), steps=60, world=None):
    """Return the figures of a drive."""
    jury = Jury(5.0, 1.8, 3.0)
    drive(jury, ego, others, steps, world=world)
    return jury.figures()


def limited(limit):
    """Return a world of one lane with a limit (m/s)."""
    spine = Polyline(np.array([[0.0, 0.0], [100.0, 0.0]]))
    lane = Lane(
        id="road_0", edge_id="road", index=0, spine=spine, length=100.0, width=3.2, speed_limit=limit,
        allowed=VEHICLE_CLASSES,
    )  # fmt: skip
    return RoadGraph(
        lanes={lane.id: lane}, edge_lanes={}, junctions={}, connections={}, regions={}, arcs=(), opposite={}, left_hand=False
    )


def test_the_score_is_the_mean_of_its_parts_by_their_weights():
    assert driving_score(PARTS, 0) == pytest.approx((5.0 * 1 + 5.0 * 0.8 + 4.0 * 0.5 + 2.0 * 0) / 16.0)
    assert driving_score(PARTS | {"speed_limit_score": None}, 0) == pytest.approx((5.0 + 4.0) / 12.0)


@pytest.mark.parametrize(("parts", "collisions"), [(PARTS, 1), (PARTS | {"progress_score": 0.19}, 0)])
def test_after_a_collision_or_without_progress_the_score_is_nought(parts, collisions):
    assert driving_score(parts, collisions) == 0.0


def test_progress_is_the_share_of_the_driving_time_that_is_not_lost():
    figures = {"ttc_score": 1, "comfort_score": 1, "speed_limit_score": 1.0}
    metrics = result(figures=figures, time_loss_s=5.0, stopped_s=10.0).metrics
    assert metrics["progress_score"] == pytest.approx(1.0 - 5.0 / 20.0)
    assert metrics["driving_score"] == pytest.approx((5.0 + 5.0 * 0.75 + 4.0 + 2.0) / 16.0, abs=1e-4)
    hit = result(figures=figures, faults=(Fault(9.0, COLLISION, "van", "a_0"),))
    assert hit.metrics["driving_score"] == 0.0


@pytest.mark.parametrize("steps", [SMOOTHED_STEPS, 40])
def test_derivatives_are_those_of_a_savitzky_golay_filter(steps):
    values = np.random.default_rng(1).normal(size=steps).cumsum()
    assert slopes(values, 0.1) == pytest.approx(savgol_filter(values, SMOOTHED_STEPS, 2, deriv=1, delta=0.1))


@pytest.mark.parametrize(("acceleration", "comfortable"), [(2.3, 1), (2.5, 0), (-3.9, 1), (-4.2, 0)])
def test_an_acceleration_is_comfortable_within_its_bounds(acceleration, comfortable):
    figures = judged(lambda t: record(t, speed=30.0 + acceleration * t))
    assert figures["comfort_score"] == comfortable
    assert figures["max_jerk_m_s3"] == pytest.approx(0.0, abs=1e-3)


@pytest.mark.parametrize(("yaw_rate", "speed", "comfortable"), [(0.9, 5.0, 1), (1.0, 4.0, 0), (0.6, 9.0, 0)])
def test_a_bend_is_comfortable_within_its_yaw_rate_and_lateral_acceleration(yaw_rate, speed, comfortable):
    figures = judged(lambda t: record(t, heading=(yaw_rate * t + math.pi) % (2.0 * math.pi) - math.pi, speed=speed))
    assert figures["max_yaw_rate_rad_s"] == pytest.approx(yaw_rate, abs=1e-3)
    assert figures["comfort_score"] == comfortable


def test_a_trip_shorter_than_the_filter_has_no_comfort():
    figures = judged(lambda t: record(t, speed=5.0), steps=10)
    assert {figures[name] for name in (*COMFORT_BOUNDS, "comfort_score")} == {None}


@pytest.mark.parametrize(
    ("other", "score"),
    [
        (user(x=20.0), 1),  # 15 m at 10 m/s: 1.5 s
        (user(x=14.0), 0),  # 9 m: 0.9 s
        (user(x=-9.0, speed=30.0), 1),  # from behind
        (user(x=9.0, heading=math.pi, speed=5.0), 1),  # oncoming
        (user(x=6.0, y=-5.0, heading=0.5 * math.pi, speed=8.0), 0),  # crossing
    ],
)
def test_a_short_time_to_collision_with_one_in_front_costs_its_score(other, score):
    assert judged(lambda t: record(t, speed=10.0), lambda t: [other], 2)["ttc_score"] == score


@pytest.mark.parametrize(("lane", "score"), [("road_0", 1.0 - 1.0 / 2.23), ("unknown_0", 1.0)])
def test_overspeed_costs_its_mean_over_what_is_too_much(lane, score):
    figures = judged(lambda t: record(t, speed=11.0, lane_id=lane), world=limited(10.0))
    assert figures["speed_limit_score"] == pytest.approx(score, abs=1e-3)


def test_inside_a_junction_the_limit_is_the_higher_one_of_its_roads():
    world = limited(10.0)
    line = Polyline(np.array([[0.0, 0.0], [10.0, 0.0]]))
    inside = Connection(
        id="c", junction_id="j", index=0, from_lane="slow_0", to_lane="road_0", parts=(":j_0_0",), path=line,
        turn=Turn.STRAIGHT, control=Control.MINOR,
    )  # fmt: skip
    slow = replace(world.lanes["road_0"], id="slow_0", speed_limit=5.0)
    known = replace(world, lanes=dict(world.lanes) | {"slow_0": slow}, connections={"c": inside})
    assert speed_limit(known, ":j_0_0") == 10.0


def test_who_stands_is_not_about_to_collide():
    """A crossing car comes within 0.9 s, which is its driver's business."""
    crossing = user(x=6.0, y=-5.0, heading=0.5 * math.pi, speed=8.0)
    assert judged(lambda t: record(t, x=5.5), lambda t: [crossing], 2)["ttc_score"] == 1


def test_without_a_map_nobody_knows_the_limits():
    assert judged(lambda t: record(t, speed=50.0))["speed_limit_score"] is None
