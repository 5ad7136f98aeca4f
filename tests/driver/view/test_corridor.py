"""Which stretch of C a body blocks, against cases computed by hand."""

import math
from dataclasses import replace

import numpy as np
import pytest
from helpers.cars import CAR
from helpers.curves import STEP, straight, turning

from sumo_reactive.driver.geometry.curve import Curve
from sumo_reactive.driver.parameters import USUAL
from sumo_reactive.driver.view.corridor import CorridorSides, band_of, blocking_ones

BUS = replace(CAR, length=12.0, width=2.5, wheelbase=7.2, front_overhang=2.16)

HALF = 1.1
"""m; half the ego's width and the margin."""


def even(curve: Curve) -> CorridorSides:
    """A corridor of HALF on either side."""
    return CorridorSides(np.full(len(curve.x), HALF), np.full(len(curve.x), HALF), HALF)


def blocked(curve: Curve, *box: float, start: float = 0.0, end: float = 100.0) -> list[float]:
    """First and last arc length that the box (front x, y, heading, speed, length, width) blocks, velocity along, across."""
    boxes = np.array([box])
    _, found = blocking_ones(boxes, curve.x, curve.y, curve.heading, curve.step, start, end, *even(curve))
    return found[0].tolist() if len(found) else [math.nan] * 4


STRAIGHT = straight(120.0)
RADIUS = 20.0
RING = turning([100.0], [1.0 / RADIUS])


def beside_the_ring(angle: float, radius: float, length: float) -> tuple[float, float, float]:
    """Front of a tangent box whose middle lies at `angle` of the ring, at `radius` from its centre (0, RADIUS)."""
    x, y = radius * math.sin(angle), RADIUS - radius * math.cos(angle)
    return x + 0.5 * length * math.cos(angle), y + 0.5 * length * math.sin(angle), angle


def test_a_car_ahead_blocks_its_own_length_and_moves_along():
    start, end, along, across = blocked(STRAIGHT, 30.3, 0.0, 0.0, 8.0, 5.0, 1.8)
    assert start == pytest.approx(25.3, abs=1e-6)
    assert 30.3 - STEP <= end <= 30.3
    assert (along, across) == pytest.approx((8.0, 0.0))


def test_an_oncoming_car_blocks_from_its_front_on_and_moves_against():
    start, end, along, _ = blocked(STRAIGHT, 40.2, 0.5, math.pi, 10.0, 5.0, 1.8)
    assert start == pytest.approx(40.2, abs=1e-6)
    assert 45.2 - STEP <= end <= 45.2
    assert along == pytest.approx(-10.0)


def test_a_crossing_car_blocks_its_width_and_moves_to_the_left():
    start, end, along, across = blocked(STRAIGHT, 50.0, 1.0, 0.5 * math.pi, 6.0, 5.0, 1.8)
    assert start == pytest.approx(49.1, abs=1e-6)
    assert 50.9 - STEP <= end <= 50.9
    assert (along, across) == pytest.approx((0.0, 6.0), abs=1e-9)


@pytest.mark.parametrize(("left", "blocks"), [(1.95, True), (2.05, False), (-1.95, True), (-2.05, False)])
def test_a_car_beside_blocks_only_if_it_reaches_into_the_corridor(left, blocks):
    assert math.isfinite(blocked(STRAIGHT, 30.0, left, 0.0, 0.0, 5.0, 1.8)[0]) == blocks


def test_a_slanted_car_reaches_in_with_its_corner():
    """Front 3 m left, 45° to the right: its right front corner lies at 3 − 0.9 · cos 45° = 2.36, its rear farther left."""
    assert math.isnan(blocked(STRAIGHT, 30.0, 3.0, -0.25 * math.pi, 0.0, 5.0, 1.8)[0])
    start, _, _, _ = blocked(STRAIGHT, 30.0, 1.5, -0.25 * math.pi, 0.0, 5.0, 1.8)
    assert 26.0 < start < 30.0


def test_what_is_behind_the_start_or_beyond_the_end_does_not_block():
    assert math.isnan(blocked(STRAIGHT, 20.0, 0.0, 0.0, 0.0, 5.0, 1.8, start=25.0)[0])
    assert math.isnan(blocked(STRAIGHT, 80.0, 0.0, 0.0, 0.0, 5.0, 1.8, end=60.0)[0])


def test_a_body_around_the_start_blocks_from_there():
    start, _, _, _ = blocked(STRAIGHT, 30.0, 0.0, 0.0, 0.0, 5.0, 1.8, start=27.0)
    assert start == pytest.approx(27.0)


@pytest.mark.parametrize("angle", [0.5, 1.3, 2.6, 4.0])
def test_a_car_ahead_in_a_bend_blocks_the_arc_that_it_covers_and_moves_along(angle):
    start, end, along, across = blocked(RING, *beside_the_ring(angle, RADIUS, 4.0), 7.0, 4.0, 1.8)
    assert start == pytest.approx(RADIUS * angle - 2.0, abs=0.3)
    assert end == pytest.approx(RADIUS * angle + 2.0, abs=STEP + 0.3)
    assert along == pytest.approx(7.0, abs=0.1)
    assert abs(across) < 1.0


@pytest.mark.parametrize("radius", [RADIUS - 3.0, RADIUS + 3.0])
def test_a_car_on_the_next_lane_of_a_bend_does_not_block(radius):
    assert math.isnan(blocked(RING, *beside_the_ring(1.3, radius, 4.0), 7.0, 4.0, 1.8)[0])


def test_each_body_is_judged_on_its_own():
    boxes = np.array([(30.0, 0.0, 0.0, 5.0, 5.0, 1.8), (30.0, 9.0, 0.0, 5.0, 5.0, 1.8), (60.0, 0.0, 0.0, 5.0, 5.0, 1.8)])
    which, found = blocking_ones(boxes, STRAIGHT.x, STRAIGHT.y, STRAIGHT.heading, STEP, 0.0, 100.0, *even(STRAIGHT))
    assert which.tolist() == [0, 2]
    assert found[:, 0] == pytest.approx([25.0, 55.0])


@pytest.mark.parametrize("radius", [8.0, 15.0, 40.0])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_in_a_steady_turn_the_corridor_holds_what_axle_and_bumper_sweep(radius, side):
    """With the front axle on a circle the rear axle runs on one of √(r² − L²), the bumper on one of √(r² + o² + 2oL)."""
    ring = turning([2.0 * radius], [side / radius])
    length, overhang = BUS.wheelbase, BUS.front_overhang
    inner = radius - math.sqrt(max(radius**2 - length**2, 0.0))
    outer = math.sqrt(radius**2 + overhang**2 + 2.0 * overhang * length) - radius
    band, last = band_of(ring, BUS), len(ring.x) - 1 - int((length + overhang) / STEP)
    within, beyond = (band.left, band.right) if side > 0.0 else (band.right, band.left)
    assert within[last // 2] == pytest.approx(0.5 * BUS.width + max(inner, USUAL.corridor_margin_m), abs=0.1 * inner + 0.05)
    assert beyond[last - 2] == pytest.approx(0.5 * BUS.width + max(outer, USUAL.corridor_margin_m), abs=0.1 * outer + 0.05)
    assert band.widest == pytest.approx(max(band.left.max(), band.right.max()))


def test_on_a_straight_and_in_a_wide_bend_a_car_keeps_the_same_room_on_both_sides():
    for curve in (STRAIGHT, turning([60.0], [1.0 / 30.0])):
        band = band_of(curve, CAR)
        assert np.allclose(band.left, HALF)
        assert np.allclose(band.right, HALF)


def test_a_bus_sees_who_waits_where_its_rear_cuts_a_left_turn():
    bend = turning([20.0, 16.0, 20.0], [0.0, math.pi / 32.0, 0.0])
    waiting = (20.0, 5.0, math.pi, 0.0, 5.0, 1.8)
    boxes = np.array([waiting])
    seen = [
        blocking_ones(boxes, bend.x, bend.y, bend.heading, bend.step, 0.0, 50.0, *band_of(bend, one))[0].tolist()
        for one in (BUS, CAR)
    ]
    assert seen == [[0], []]
