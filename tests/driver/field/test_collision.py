"""The exact collision test (F&L 1991, §3.2)."""

import math

import numpy as np
import pytest
import shapely
from helpers.cars import CAR
from hypothesis import assume, given
from hypothesis import strategies as st

from sumo_reactive.driver.field.collision import braking_collides, foreseen_pose
from sumo_reactive.driver.geometry.footprint import Footprint, boxes_overlap

boxes = st.tuples(st.floats(-6, 6), st.floats(-6, 6), st.floats(-4, 4), st.floats(0.5, 12), st.floats(0.3, 3))


def polygon(x: float, y: float, heading: float, length: float, width: float) -> shapely.Polygon:
    """A box about its centre."""
    front = 0.5 * length
    return shapely.Polygon(
        Footprint(x + front * math.cos(heading), y + front * math.sin(heading), heading, length, width).corners()
    )


@given(boxes, boxes)
def test_two_boxes_overlap_where_their_polygons_do(one, other):
    a, b = polygon(*one), polygon(*other)
    shared = a.intersection(b).area
    assume(shared > 1e-9 or a.distance(b) > 1e-9)
    assert boxes_overlap(*one, *other) == (shared > 1e-9)


def test_boxes_that_only_touch_do_not_overlap():
    assert not boxes_overlap(0.0, 0.0, 0.0, 4.0, 2.0, 4.0, 0.0, 0.0, 4.0, 2.0)
    assert not boxes_overlap(0.0, 0.0, 0.0, 4.0, 2.0, 0.0, 2.0, 0.0, 4.0, 2.0)


def collides(
    speed: float, *others: tuple[float, ...], horizon: float = 10.0, turn: float = 0.0, left: float = math.inf
) -> bool:
    """Whether an ego with its rear axle at the origin, braking with 9 m/s² from now on, hits one of the others.

    They turn by `turn` rad/s, and leave the road `left` m farther on.
    """
    return braking_collides(
        0.0, 0.0, 0.0, speed, 0.0, CAR.wheelbase, CAR.front_to_rear_axle, CAR.length, CAR.width, 9.0,
        np.array([(*other, turn, left) for other in others]).reshape(-1, 8), 0.0, horizon, 0.1,
    )  # fmt: skip


def wall(distance: float, length: float = 1.0) -> tuple[float, ...]:
    """A broad thing that stands across the road, `distance` m before the front bumper."""
    return (CAR.front_to_rear_axle + distance + length, 0.0, 0.0, 0.0, length, 6.0)


@pytest.mark.parametrize("speed", [5.0, 10.0, 20.0])
def test_braking_ends_before_what_is_farther_than_the_braking_distance(speed):
    """Steps of 0.1 s cover up to v · 0.05 s more than v² / 2a."""
    way = speed**2 / (2.0 * 9.0)
    assert not collides(speed, wall(way + 0.1 * speed))
    assert collides(speed, wall(way - 0.5))


def test_a_car_that_drives_on_ahead_is_not_hit():
    assert not collides(15.0, (CAR.front_to_rear_axle + 2.0 + 4.7, 0.0, 0.0, 15.0, 4.7, 1.8))


def test_a_car_that_has_crossed_by_then_is_not_hit():
    crossing = (CAR.front_to_rear_axle + 5.0, 0.5, 0.5 * math.pi, 15.0, 4.7, 1.8)
    assert not collides(9.0, crossing)
    assert collides(9.0, (*crossing[:3], 0.0, *crossing[4:]))


def test_what_runs_into_the_rear_or_into_a_standing_ego_is_the_others_business():
    assert not collides(5.0, (-CAR.rear_overhang - 0.5, 0.0, 0.0, 8.0, 4.7, 1.8), horizon=0.5)
    assert not collides(0.0, (CAR.front_to_rear_axle + 3.0, 0.0, math.pi, 10.0, 4.7, 1.8))


def test_a_much_faster_follower_is_its_own_business():
    assert not collides(5.0, (-CAR.rear_overhang - 0.5, 0.0, 0.0, 20.0, 4.7, 1.8), horizon=0.7)


def test_nothing_beyond_the_horizon_counts():
    assert collides(20.0, wall(15.0))
    assert not collides(20.0, wall(15.0), horizon=0.5)


def test_a_car_that_comes_round_a_bend_beside_the_ego_is_not_met():
    """It is 5 m ahead and 3 m to the left, comes a quarter across the ego's way, and will be parallel in half a second."""
    oncoming = (CAR.front_to_rear_axle + 5.0, 3.0, math.pi + 0.45, 10.0, 4.5, 1.8)
    assert collides(6.0, oncoming, horizon=0.7)
    assert not collides(6.0, oncoming, horizon=0.7, turn=-1.0)


@given(st.floats(0.0, 20.0), st.floats(-1.5, 1.5), st.floats(0.0, 0.7), st.floats(-3.0, 3.0))
def test_a_turning_box_stays_on_its_circle(speed, turn, time, heading):
    box = np.array((2.0 * math.cos(heading), 2.0 * math.sin(heading), heading, speed, 4.0, 1.8, turn))
    x, y, after = foreseen_pose(box, time, turn)
    assume(abs(turn) > 0.01)
    radius = speed / turn
    cx, cy = -radius * math.sin(heading), radius * math.cos(heading)
    assert math.hypot(x - cx, y - cy) == pytest.approx(abs(radius), abs=0.01)
    assert after == pytest.approx(heading + turn * time)


def test_who_would_turn_across_its_path_is_the_pilots_matter():
    waiting_to_turn = (CAR.front_to_rear_axle + 6.0, 2.6, math.pi, 5.0, 4.3, 1.8)
    assert not collides(6.0, waiting_to_turn, horizon=0.7, turn=0.8)


def test_who_comes_towards_it_whichever_way_he_goes_is_braked_for():
    oncoming = (CAR.front_to_rear_axle + 5.0, 0.3, math.pi, 9.0, 4.3, 1.8)
    assert collides(6.0, oncoming, horizon=0.7, turn=0.1)


def test_who_leaves_the_road_before_they_meet_is_not_braked_for():
    """He comes from the right, and would be before the ego in 0.4 s."""
    arriving = (CAR.front_to_rear_axle + 2.0, -6.0, 0.5 * math.pi, 12.0, 4.3, 1.8)
    assert collides(6.0, arriving, horizon=0.7)
    assert not collides(6.0, arriving, horizon=0.7, left=2.0)


@pytest.mark.parametrize(
    ("length", "heading", "turn", "swings"),
    [(12.0, 0.0, 0.6, True), (12.0, 0.0, 0.0, False), (7.5, 0.0, 0.6, False), (12.0, 2.5, 0.6, False)],
)
def test_a_long_body_beside_that_turns_away_swings_its_tail_over_the_ego_whatever_else_it_might_do(
    length, heading, turn, swings
):
    beside = (12.0, 3.0, heading, 5.0, length, 2.5)
    assert collides(5.0, beside, horizon=3.0, turn=turn) is swings


@pytest.mark.parametrize(("length", "touches"), [(12.0, True), (7.0, False)])
def test_the_tail_of_a_long_body_comes_over_an_ego_that_has_braked_to_a_stand(length, touches):
    """It stops after 0.2 m; the body is more than a metre beside it then, and turns on."""
    beside = (10.5, 3.4, 0.0, 3.0, length, 2.5)
    assert not collides(1.5, beside, horizon=0.2, turn=0.3)
    assert collides(1.5, beside, horizon=2.0, turn=0.3) is touches


@pytest.mark.parametrize(("speed", "touches"), [(0.0, True), (2.0, False)])
def test_the_side_is_not_turned_into_who_stands_beside_it_and_who_drives_there_looks_out_himself(speed, touches):
    """His front is just behind the middle of the ego, 0.2 m to the left of its body."""
    beside = (1.2, 0.5 * (CAR.width + 1.8) + 0.2, 0.0, speed, 4.0, 1.8, 0.0, math.inf)

    def turning(angle: float) -> bool:
        return braking_collides(
            0.0, 0.0, 0.0, 5.0, angle, CAR.wheelbase, CAR.front_to_rear_axle, CAR.length, CAR.width, 4.0,
            np.array([beside]), 0.0, 2.0, 0.1,
        )  # fmt: skip

    assert not turning(0.0)
    assert turning(0.6) is touches
