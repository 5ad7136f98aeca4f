"""The ground that bodies cover."""

from __future__ import annotations

import math

import numpy as np
import pytest
from helpers.cars import CAR
from hypothesis import given
from hypothesis import strategies as st

from sumo_reactive.driver.geometry.footprint import Footprint, boxes_overlap
from sumo_reactive.driver.nouns.state import Pose
from sumo_reactive.driver.vehicle.body import box_of, clear_behind, own_box

EGO = Pose(10.0, -4.0, 0.7)
places, angles = st.floats(-50.0, 50.0), st.floats(-math.pi, math.pi)


@given(places, places, angles)
def test_the_box_of_a_body_has_its_middle_amid_its_corners(x, y, heading):
    middle = Footprint(x, y, heading, 4.5, 1.8).corners().mean(axis=0)
    assert box_of(x, y, heading, 4.5, 1.8) == pytest.approx((*middle, heading, 4.5, 1.8))


@given(places, places, angles)
def test_the_egos_box_is_that_of_its_front_bumper(x, y, heading):
    pose = Pose(x, y, heading)
    front = pose.ahead(CAR.front_to_rear_axle)
    assert own_box(pose, CAR) == pytest.approx(box_of(*front, heading, CAR.length, CAR.width))


def test_room_around_the_ego_is_on_all_sides_and_room_beside_it_on_two():
    *_, length, width = own_box(EGO, CAR, around=0.5, beside=0.2)
    assert (length, width) == pytest.approx((CAR.length + 1.0, CAR.width + 1.4))


def behind(gap, aside=0.0):
    """Somebody of the ego's length and width, so far behind its rear bumper and to its left."""
    x, y = EGO.ahead(-CAR.rear_overhang - gap)
    left = -aside * math.sin(EGO.heading), aside * math.cos(EGO.heading)
    return np.array([[x + left[0], y + left[1], EGO.heading, 0.0, CAR.length, CAR.width, 0.0, 0.0]])


@pytest.mark.parametrize("gap", [0.3, 2.0, 20.0])
def test_the_room_behind_the_ego_ends_at_the_next_body(gap):
    row = behind(gap)
    assert clear_behind(row, EGO, CAR) == pytest.approx(gap)
    backed = Pose(*EGO.ahead(-gap - 0.1), EGO.heading)
    assert boxes_overlap(*own_box(backed, CAR), *box_of(*row[0, :3], *row[0, 4:6]))


@pytest.mark.parametrize("turned", [-2.0, -1.57, -0.8, 0.5, 1.57, 2.5])
@pytest.mark.parametrize("aside", [-2.4, -1.5, 0.0, 1.5, 2.4])
def test_who_stands_askew_behind_the_ego_is_not_backed_into(turned, aside):
    row = behind(2.5, aside)
    row[0, 2] += turned
    body = box_of(*row[0, :3], *row[0, 4:6])
    clear = clear_behind(row, EGO, CAR)
    for gap in np.arange(0.0, min(clear, 10.0), 0.1):
        assert not boxes_overlap(*own_box(Pose(*EGO.ahead(-gap), EGO.heading), CAR), *body)


def test_who_is_beside_the_lane_or_ahead_leaves_the_room_behind_the_ego_free():
    assert clear_behind(behind(2.0, aside=3.0), EGO, CAR) == math.inf
    assert clear_behind(behind(-3.0 * CAR.length), EGO, CAR) == math.inf
    assert clear_behind(np.empty((0, 8)), EGO, CAR) == math.inf
