"""Footprints: corners, overlap and clearance, by hand and by property."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sumo_reactive.driver.geometry.footprint import Footprint

near = st.floats(-15.0, 15.0)
sizes = st.floats(0.5, 12.0)
boxes = st.builds(Footprint, x=near, y=near, heading=st.floats(-math.pi, math.pi), length=sizes, width=sizes)


def moved(box: Footprint, dx: float, dy: float) -> Footprint:
    return Footprint(box.x + dx, box.y + dy, box.heading, box.length, box.width)


def test_the_reference_point_is_the_centre_of_the_front_bumper():
    corners = Footprint(10.0, 5.0, 0.0, 4.0, 2.0).corners()
    np.testing.assert_allclose(corners, [[10, 6], [6, 6], [6, 4], [10, 4]])


def test_a_box_that_points_north_lies_south_of_its_front_bumper():
    corners = Footprint(0.0, 0.0, math.pi / 2, 4.0, 2.0).corners()
    np.testing.assert_allclose(corners, [[-1, 0], [-1, -4], [1, -4], [1, 0]], atol=1e-12)


def test_boxes_that_only_touch_do_not_overlap():
    ahead, behind = Footprint(8.0, 0.0, 0.0, 4.0, 2.0), Footprint(4.0, 0.0, 0.0, 4.0, 2.0)
    assert not ahead.overlaps(behind)
    assert ahead.clearance(behind) == 0.0


def test_clearance_between_two_cars_in_line_is_the_gap_from_bumper_to_bumper():
    assert Footprint(10.0, 0.0, 0.0, 4.0, 2.0).clearance(Footprint(3.5, 0.0, 0.0, 4.0, 2.0)) == pytest.approx(2.5)


def test_clearance_between_corners_is_their_diagonal_distance():
    assert Footprint(0.0, 0.0, 0.0, 4.0, 2.0).clearance(Footprint(7.0, 6.0, 0.0, 4.0, 2.0)) == pytest.approx(5.0)


def test_a_box_turned_by_45_degrees_keeps_its_corner_out_of_a_near_wall():
    diamond = Footprint(math.sqrt(0.5), math.sqrt(0.5), math.pi / 4, 2.0, 2.0)
    wall = Footprint(10.0, 0.0, 0.0, 10.0 - math.sqrt(2.0) - 0.1, 6.0)
    assert not diamond.overlaps(wall)
    assert diamond.clearance(wall) == pytest.approx(0.1)


def test_a_thin_box_through_the_middle_of_another_overlaps_without_a_corner_inside():
    assert Footprint(5.0, 0.0, 0.0, 10.0, 1.0).overlaps(Footprint(0.0, 5.0, math.pi / 2, 10.0, 1.0))


@pytest.mark.parametrize(("length", "width"), [(0.0, 1.0), (1.0, -1.0), (math.nan, 1.0)])
def test_a_box_without_size_is_refused(length, width):
    with pytest.raises(ValueError, match="positive size"):
        Footprint(0.0, 0.0, 0.0, length, width)


@given(boxes, boxes)
def test_overlap_and_clearance_are_symmetric(a, b):
    assert a.overlaps(b) == b.overlaps(a)
    assert a.clearance(b) == pytest.approx(b.clearance(a), abs=1e-9)


@given(boxes)
def test_every_box_overlaps_itself(box):
    assert box.overlaps(box)


@given(boxes, boxes)
def test_boxes_with_a_clearance_do_not_overlap_and_part_by_it(a, b):
    clearance = a.clearance(b)
    assert clearance >= 0.0
    assert not (a.overlaps(b) and clearance > 0.0)


@given(boxes, boxes, near, near)
def test_clearance_does_not_change_when_both_boxes_move_together(a, b, dx, dy):
    assert moved(a, dx, dy).clearance(moved(b, dx, dy)) == pytest.approx(a.clearance(b), abs=1e-6)


@given(boxes, boxes, near, near)
def test_clearance_changes_by_no_more_than_a_box_moves(a, b, dx, dy):
    assert abs(a.clearance(moved(b, dx, dy)) - a.clearance(b)) <= math.hypot(dx, dy) + 1e-6


@given(boxes, boxes)
def test_clearance_is_at_most_the_distance_between_any_two_corners(a, b):
    corners = np.linalg.norm(a.corners()[:, None] - b.corners()[None, :], axis=2)
    assert a.clearance(b) <= corners.min() + 1e-9


@given(boxes)
def test_the_four_sides_have_the_stated_length_and_width(box):
    sides = np.linalg.norm(np.roll(box.corners(), -1, axis=0) - box.corners(), axis=1)
    np.testing.assert_allclose(sides, [box.length, box.width, box.length, box.width], atol=1e-9)
