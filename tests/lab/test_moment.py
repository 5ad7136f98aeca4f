"""The judges' ruler, held against polygons that are moved and laid over one another."""

import math

import numpy as np
import pytest
import shapely
from hypothesis import assume, given
from hypothesis import strategies as st

from sumo_reactive.lab.metrics.moment import SHRINK_M, contacts

LENGTH, WIDTH = 4.7, 1.8
sizes = st.tuples(st.floats(0.3, 15.0), st.floats(0.3, 3.0))
places = st.tuples(st.floats(-25.0, 25.0), st.floats(-25.0, 25.0), st.floats(-4.0, 4.0), st.floats(0.0, 25.0))
boxes = st.builds(lambda place, size: (*place, *size), places, sizes)


def polygon(box: tuple[float, ...], after: float = 0.0, shrink: float = 0.0) -> shapely.Polygon:
    """A box with front (x, y) that has driven on for `after` s, `shrink` m smaller on each side."""
    x, y, heading, speed, length, width = box
    c, s = math.cos(heading), math.sin(heading)
    x, y = x + after * speed * c, y + after * speed * s
    corners = [(-shrink, 0.5 * width - shrink), (shrink - length, 0.5 * width - shrink)]
    corners += [(ahead, -left) for ahead, left in reversed(corners)]
    return shapely.Polygon([(x + ahead * c - left * s, y + ahead * s + left * c) for ahead, left in corners])


def ruler(own: tuple[float, ...], *others: tuple[float, ...]) -> list[tuple[float, float]]:
    """Overlap and time to collision of each of the others."""
    return list(zip(*contacts(np.array(own), np.array(others)).tolist(), strict=True))


def velocity(box: tuple[float, ...]) -> tuple[float, float]:
    """Its velocity (m/s)."""
    return box[3] * math.cos(box[2]), box[3] * math.sin(box[2])


def car(x: float, y: float = 0.0, heading: float = 0.0, speed: float = 0.0) -> tuple[float, ...]:
    """A car whose front is at (x, y)."""
    return (x, y, heading, speed, LENGTH, WIDTH)


@given(boxes, boxes)
def test_boxes_touch_where_their_shrunk_polygons_do(own, other):
    mine, theirs = polygon(own, shrink=SHRINK_M), polygon(other, shrink=SHRINK_M)
    shared = mine.intersection(theirs).area
    assume(shared > 1e-9 or mine.distance(theirs) > 1e-9)
    assert ruler(own, other)[0][0] == (shared > 1e-9)


@given(boxes, boxes)
def test_at_the_time_to_collision_they_meet_and_before_they_do_not(own, other):
    assume(math.dist(velocity(own), velocity(other)) > 0.01)
    time = ruler(own, other)[0][1]
    moments = [t for t in np.linspace(0.0, min(time, 60.0), 40) if t < time]
    assert not any(polygon(own, t).intersection(polygon(other, t)).area > 1e-6 for t in moments)
    if time < math.inf:
        assert polygon(own, time).distance(polygon(other, time)) < 1e-6 * (1.0 + time)


@pytest.mark.parametrize(
    ("own", "other", "time"),
    [
        (car(0.0, speed=10.0), car(20.0 + LENGTH), 2.0),
        (car(0.0, speed=15.0), car(30.0 + LENGTH, 1.7, speed=5.0), 3.0),
        (car(0.0, speed=10.0), car(-12.0 - LENGTH, speed=14.0), 3.0),  # from behind
        (car(0.0, speed=10.0), car(50.0, 0.5, math.pi, 15.0), 2.0),  # oncoming
        (car(0.0, speed=10.0), car(10.0, -10.9, 0.5 * math.pi, 10.0), 1.0),  # from the right
        (car(0.0, speed=10.0), car(3.0), 0.0),  # touches
        (car(0.0, speed=10.0), car(30.0, speed=10.0), math.inf),  # keeps its distance
        (car(0.0, speed=10.0), car(4.69, speed=10.0), math.inf),  # keeps it, less than a centimetre over the other's
        (car(0.0, speed=10.0), car(30.0, speed=11.0), math.inf),
        (car(0.0, speed=10.0), car(20.0, WIDTH), math.inf),  # side by side
        (car(0.0, speed=10.0), car(10.0, -30.0, 0.5 * math.pi, 10.0), math.inf),  # passes behind
    ],
)
def test_the_time_to_collision_is_the_gap_over_the_closing_speed(own, other, time):
    assert ruler(own, other)[0][1] == pytest.approx(time)


def test_each_of_many_is_measured_by_itself():
    own, others = car(0.0, speed=10.0), (car(30.0), car(3.0), car(-20.0))
    assert ruler(own, *others) == [ruler(own, one)[0] for one in others]
