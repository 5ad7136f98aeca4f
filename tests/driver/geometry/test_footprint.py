"""Footprints: corners and overlap, by hand and by property."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sumo_reactive.driver.geometry.footprint import Footprint, boxes_overlap

near = st.floats(-15.0, 15.0)
sizes = st.floats(0.5, 12.0)
boxes = st.builds(Footprint, x=near, y=near, heading=st.floats(-math.pi, math.pi), length=sizes, width=sizes)


def overlap(one: Footprint, other: Footprint) -> bool:
    return boxes_overlap(*(x for b in (one, other) for x in (*b.corners().mean(axis=0), b.heading, b.length, b.width)))


def test_the_reference_point_is_the_centre_of_the_front_bumper():
    corners = Footprint(10.0, 5.0, 0.0, 4.0, 2.0).corners()
    np.testing.assert_allclose(corners, [[10, 6], [6, 6], [6, 4], [10, 4]])


def test_a_box_that_points_north_lies_south_of_its_front_bumper():
    corners = Footprint(0.0, 0.0, math.pi / 2, 4.0, 2.0).corners()
    np.testing.assert_allclose(corners, [[-1, 0], [-1, -4], [1, -4], [1, 0]], atol=1e-12)


def test_boxes_that_only_touch_do_not_overlap():
    assert not overlap(Footprint(8.0, 0.0, 0.0, 4.0, 2.0), Footprint(4.0, 0.0, 0.0, 4.0, 2.0))


def test_a_box_turned_by_45_degrees_keeps_its_corner_out_of_a_near_wall():
    diamond = Footprint(math.sqrt(0.5), math.sqrt(0.5), math.pi / 4, 2.0, 2.0)
    assert not overlap(diamond, Footprint(10.0, 0.0, 0.0, 10.0 - math.sqrt(2.0) - 0.1, 6.0))
    assert overlap(diamond, Footprint(10.0, 0.0, 0.0, 10.0 - math.sqrt(2.0) + 0.1, 6.0))


def test_a_thin_box_through_the_middle_of_another_overlaps_without_a_corner_inside():
    assert overlap(Footprint(5.0, 0.0, 0.0, 10.0, 1.0), Footprint(0.0, 5.0, math.pi / 2, 10.0, 1.0))


@pytest.mark.parametrize(("length", "width"), [(0.0, 1.0), (1.0, -1.0), (math.nan, 1.0)])
def test_a_box_without_size_is_refused(length, width):
    with pytest.raises(ValueError, match="positive size"):
        Footprint(0.0, 0.0, 0.0, length, width)


@given(boxes, boxes)
def test_overlap_is_symmetric(a, b):
    assert overlap(a, b) == overlap(b, a)


@given(boxes)
def test_every_box_overlaps_itself(box):
    assert overlap(box, box)


@given(boxes)
def test_the_four_sides_have_the_stated_length_and_width(box):
    sides = np.linalg.norm(np.roll(box.corners(), -1, axis=0) - box.corners(), axis=1)
    np.testing.assert_allclose(sides, [box.length, box.width, box.length, box.width], atol=1e-9)
