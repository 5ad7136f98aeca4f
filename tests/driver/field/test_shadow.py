"""U₂: the three zero cases of the paper, hand-computed times to collision, and a sampled brute force (F&L 1991, §3.3.2)."""

import math

import numpy as np
import pytest
import shapely
from hypothesis import assume, given
from hypothesis import strategies as st

from sumo_reactive.driver.field.shadow import corners_of, shadow_potential, shadow_sum
from sumo_reactive.driver.geometry.footprint import Footprint

LENGTH, WIDTH = 4.0, 2.0
FAR = 1e6
speeds = st.floats(0.0, 30.0)
gaps = st.floats(0.1, 30.0)
headings = st.floats(-math.pi, math.pi)


def box(along: float, left: float, road: float, heading: float, speed: float) -> tuple[float, ...]:
    """A car whose front bumper is `along` m ahead of and `left` m beside the origin on a road of direction `road`."""
    c, s = math.cos(road), math.sin(road)
    return (along * c - left * s, along * s + left * c, road + heading, speed, LENGTH, WIDTH)


def potential(speed: float, *boxes: tuple[float, ...], road: float = 0.0, horizon: float = FAR) -> float:
    """U₂ with k₀ = 1 of an ego on that road whose front bumper is at the origin; its rear axle is 3 m behind that."""
    others = np.array(boxes)
    x, y = -3.0 * math.cos(road), -3.0 * math.sin(road)
    return shadow_sum(x, y, road, speed, 3.0, LENGTH - 3.0, WIDTH, others, corners_of(others), 1.0, horizon)


def outline(one: tuple[float, ...]) -> np.ndarray:
    return Footprint(one[0], one[1], one[2], one[4], one[5]).corners()


def rim(corners: np.ndarray, points: int = 25) -> np.ndarray:
    """Points spread over a body's boundary, its corners among them."""
    f = np.linspace(0.0, 1.0, points)[:, None]
    return np.concatenate([a + f * (b - a) for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True)])


def sampled_distance(own: np.ndarray, other: np.ndarray, u: np.ndarray) -> float:
    """The paper's δ over points of both boundaries: rays along the relative motion from one body to the other."""
    nearest = math.inf
    for points, body, way in ((rim(own), other, u), (rim(other), own, -u)):
        target = shapely.Polygon(body)
        for p in points:
            hit = shapely.LineString([p, p + 1000.0 * way]).intersection(target)
            if not hit.is_empty:
                nearest = min(nearest, shapely.Point(p).distance(hit))
    return nearest


@given(headings, speeds, st.floats(0.0, 1.0), gaps, st.floats(-1.5, 1.5))
def test_it_is_zero_for_a_follower_that_is_no_faster(road, speed, share, gap, left):
    assert potential(speed, box(-LENGTH - gap, left, road, 0.0, share * speed), road=road) == 0.0


@given(headings, speeds, st.floats(0.0, 1.0), gaps, st.floats(-1.5, 1.5))
def test_it_is_zero_for_one_ahead_that_is_no_slower(road, speed, share, gap, left):
    assert potential(share * speed, box(gap + LENGTH, left, road, 0.0, speed), road=road) == 0.0


@given(
    headings,
    speeds,
    speeds,
    st.floats(-40.0, 40.0),
    st.floats(0.01, 5.0),
    st.sampled_from([-1, 1]),
    st.sampled_from([0.0, math.pi]),
)
def test_it_is_zero_on_parallel_lanes(road, speed, other_speed, along, gap, side, heading):
    assert potential(speed, box(along, side * (WIDTH + gap), road, heading, other_speed), road=road) == 0.0


@pytest.mark.parametrize(
    ("speed", "other", "time_to_collision"),
    [
        (10.0, box(20.0 + LENGTH, 0.0, 0.0, 0.0, 0.0), 2.0),  # standing, 20 m ahead
        (15.0, box(30.0 + LENGTH, 1.0, 0.0, 0.0, 5.0), 3.0),  # slower, 30 m ahead, half beside
        (10.0, box(-12.0 - LENGTH, 0.0, 0.0, 0.0, 14.0), 3.0),  # faster from behind
        (10.0, box(50.0, 0.5, 0.0, math.pi, 15.0), 2.0),  # oncoming, 50 m between the bumpers
        (10.0, box(10.0, -11.0, 0.0, 0.5 * math.pi, 10.0), 1.0),  # from the right, 10 m to both corners
        (0.0, box(-1.0, -6.0, 0.0, 0.5 * math.pi, 5.0), 1.0),  # into the side of a car that stands
    ],
    ids=["standing", "slower", "faster behind", "oncoming", "from the right", "into the side"],
)
def test_it_is_the_reciprocal_time_to_collision(speed, other, time_to_collision):
    assert potential(speed, other) == pytest.approx(1.0 / time_to_collision)


def test_it_is_zero_for_one_that_will_have_passed():
    assert potential(10.0, box(10.0, -1.5, 0.0, 0.5 * math.pi, 15.0)) == 0.0


def test_it_grows_without_end_but_stays_finite_at_contact():
    touching = potential(10.0, box(LENGTH, 0.0, 0.0, 0.0, 0.0))
    assert potential(10.0, box(LENGTH + 1.0, 0.0, 0.0, 0.0, 0.0)) < touching < math.inf


others = st.builds(box, st.floats(-30, 30), st.floats(-30, 30), st.just(0.0), headings, speeds)


@given(speeds, others)
def test_it_agrees_with_points_sampled_over_both_boundaries(speed, other):
    own, body = outline(box(0.0, 0.0, 0.0, 0.0, speed)), outline(other)
    assume(shapely.Polygon(own).distance(shapely.Polygon(body)) > 0.1)
    relative = np.array([speed - other[3] * math.cos(other[2]), -other[3] * math.sin(other[2])])
    pace = math.hypot(*relative)
    assume(pace > 0.01)
    velocity = (other[3] * math.cos(other[2]), other[3] * math.sin(other[2]))
    exact = shadow_potential(own, speed, 0.0, body, *velocity, 1.0)
    sampled = pace / sampled_distance(own, body, relative / pace)
    assert exact == pytest.approx(sampled, rel=1e-6, abs=1e-9)


@given(speeds, st.lists(others, min_size=1, max_size=6))
def test_the_sum_leaves_out_only_those_that_miss(speed, boxes):
    own = outline(box(0.0, 0.0, 0.0, 0.0, speed))
    each = [shadow_potential(own, speed, 0.0, outline(b), b[3] * math.cos(b[2]), b[3] * math.sin(b[2]), 1.0) for b in boxes]
    assert potential(speed, *boxes) == pytest.approx(sum(each), rel=1e-9, abs=1e-12)


def test_nobody_beyond_the_horizon_counts():
    ahead = box(60.0 + LENGTH, 0.0, 0.0, 0.0, 0.0)
    assert potential(10.0, ahead, horizon=80.0) > 0.0
    assert potential(10.0, ahead, horizon=40.0) == 0.0
