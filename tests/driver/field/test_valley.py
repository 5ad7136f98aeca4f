"""U₁: the valley floor stays on C, exactly and in the bitmaps (F&L 1991, §3.3.1)."""

import math

import numpy as np
import pytest
from helpers.cars import CAR
from helpers.curves import asked, driven, on_curve, plan_along, straight, turning
from hypothesis import example, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from sumo_reactive.driver.field.valley import LEAST_ROOM_M, least_to_static, valley_potential
from sumo_reactive.driver.field.valley_map import (
    CELLS,
    MAP_SIDE_M,
    map_potential,
    taxicab_transform,
    valley_bitmap,
    valley_map,
)
from sumo_reactive.driver.parameters import USUAL

LINE = straight()
places = st.tuples(st.floats(-5.0, 5.0), st.floats(-5.0, 5.0))
CELL = 0.2
MIDDLE = CELLS // 2


def exact_section(obstacles: list[tuple[float, float]], offsets: np.ndarray) -> np.ndarray:
    """U_p along a section across the line y = 0, of a body that is but a point."""
    left, right = to_static((0.0, 0.0), obstacles)
    away = np.minimum(left - offsets, right + offsets)
    places = zip(np.abs(offsets), away, strict=True)
    return np.array([valley_potential(d, o, USUAL.valley_attraction, USUAL.valley_repulsion) for d, o in places])


def to_static(place: tuple[float, float], obstacles: list[tuple[float, float]], half: float = 0.0) -> tuple[float, float]:
    """Least distance to obstacles left and right of a body at `place`; C runs eastwards through it."""
    c, static = LINE, np.array(obstacles).reshape(-1, 2)
    return least_to_static(static, c.x - 200.0 + place[0], c.y + place[1], c.heading, c.step, 200.0, half, 0.0, 0.0)


@given(st.lists(places, max_size=8))
def test_the_floor_of_the_valley_is_on_the_curve_however_near_an_obstacle_is(obstacles):
    section = exact_section(obstacles, np.linspace(-5.0, 5.0, 201))
    assert section[100] == 0.0
    assert (np.delete(section, 100) > 0.0).all()


def test_an_obstacle_makes_its_side_of_the_valley_steeper():
    section = exact_section([(0.0, 2.0)], np.array([-1.0, 1.0]))
    assert section[1] == pytest.approx(USUAL.valley_attraction + USUAL.valley_repulsion)
    assert section[0] == pytest.approx(USUAL.valley_attraction + USUAL.valley_repulsion / 3.0)


@given(places, st.lists(places, min_size=1, max_size=10), st.floats(0.0, 1.0))
def test_the_distance_to_obstacles_is_the_taxicab_one_from_the_body_to_the_nearest_on_either_side(place, obstacles, half):
    away = [(abs(x - place[0]) + abs(y - place[1]) - half, y > place[1]) for x, y in obstacles]
    nearest = [min((d for d, is_left in away if is_left is side), default=math.inf) for side in (True, False)]
    assert to_static(place, obstacles, half) == pytest.approx(nearest, abs=1e-6)


def test_beside_a_long_body_no_way_along_it_counts():
    along = LINE.x, LINE.y, LINE.heading, LINE.step, 100.0, 0.9
    static = np.array([(97.0, 2.0), (104.0, -3.0)])
    assert least_to_static(static, *along, 3.0, 3.0) == pytest.approx((1.1, 3.1))


@given(st.floats(-0.1, 0.1), st.floats(0.0, 12.0), st.floats(1.0, 2.0))
@example(0.09375, 7.0, 2.0)
def test_in_a_bend_the_distance_to_a_border_is_taken_across_c(bend, ahead, aside):
    curve = turning([60.0], [bend])
    x, y, heading = curve.at(30.0 + ahead)
    border = np.array([(x - aside * math.sin(heading), y + aside * math.cos(heading))])
    left, right = least_to_static(border, curve.x, curve.y, curve.heading, curve.step, 30.0, 0.9, 12.0, 0.0)
    assert left == pytest.approx(aside - 0.9, abs=0.1)
    assert right == math.inf


def test_at_an_obstacle_the_valley_is_steep_but_finite():
    assert valley_potential(1.0, -1.0, USUAL.valley_attraction, USUAL.valley_repulsion) == pytest.approx(
        USUAL.valley_attraction + USUAL.valley_repulsion / LEAST_ROOM_M
    )


@given(
    arrays.arrays(
        np.float64, arrays.array_shapes(min_dims=2, max_dims=2, max_side=12), elements=st.sampled_from([0.0, 0.0, 0.0, 1.0])
    )
)
def test_the_transform_gives_every_cell_its_taxicab_distance_to_the_nearest_seed(seeds):
    rows, columns = np.nonzero(seeds)
    i, j = np.indices(seeds.shape)
    away = np.abs(i[..., None] - rows) + np.abs(j[..., None] - columns)
    expected = 0.25 * away.min(axis=2) if len(rows) else np.full(seeds.shape, np.inf)
    assert np.array_equal(taxicab_transform(np.where(seeds > 0.0, 0.0, np.inf), 0.25), expected)


@settings(max_examples=8)
@given(st.lists(places, max_size=6))
def test_the_floor_of_the_bitmap_is_on_the_curve_however_near_an_obstacle_is(obstacles):
    half = MIDDLE * CELL
    x = np.arange(-half, half, 0.5 * CELL)
    static = np.array(obstacles).reshape(-1, 2)
    bitmap = valley_bitmap(np.column_stack((x, np.zeros_like(x))), static, -half, -half, CELL, USUAL)
    assert bitmap[MIDDLE] == pytest.approx(0.0, abs=1e-9)
    assert (np.delete(bitmap, MIDDLE, axis=0) > 0.5 * CELL * USUAL.valley_attraction).all()


@settings(max_examples=8)
@given(st.floats(-0.5, 0.5))
def test_between_two_rows_of_cells_the_bitmap_still_tells_how_far_the_curve_is(aside):
    half = MIDDLE * CELL
    x = np.arange(-half, half, 0.25 * CELL)
    line = np.column_stack((x, np.full_like(x, aside * CELL)))
    column = valley_bitmap(line, np.empty((0, 2)), -half, -half, CELL, USUAL)[:, MIDDLE]
    rows = np.arange(CELLS) - MIDDLE
    assert column == pytest.approx(USUAL.valley_attraction * CELL * np.abs(rows - aside), abs=1e-6)


def test_the_potential_of_a_place_lies_between_those_of_the_cells_around_and_is_outside_that_of_the_rim():
    bitmap = np.arange(12.0).reshape(3, 4)
    assert map_potential(bitmap, 11.0, 21.0, 10.0, 20.0, 1.0) == bitmap[1, 1]
    assert map_potential(bitmap, 10.75, 21.5, 10.0, 20.0, 1.0) == pytest.approx(0.75 + 4.0 * 1.5)
    assert map_potential(bitmap, 99.0, -99.0, 10.0, 20.0, 1.0) == bitmap[0, 3]


def test_the_maps_hold_the_car_while_it_stays_away_from_their_rim():
    maps = valley_map(straight(), 100.0, 0.0, CAR.wheelbase, np.empty((0, 2)), USUAL)
    assert maps.bitmaps.shape == (2, CELLS, CELLS)
    assert maps.cell == MAP_SIDE_M / CELLS
    assert maps.holds(100.0, 0.0, 20.0)
    assert not maps.holds(100.0 + 0.5 * MAP_SIDE_M - 19.0, 0.0, 20.0)


def test_each_control_point_has_its_valley_along_the_curve_that_it_traces():
    """In a steady turn of radius r the rear axle traces the circle of radius √(r² − L²) (F&L 1991, §3.1)."""
    radius = 12.0
    maps = valley_map(
        turning([75.0], [1.0 / radius]), 0.0, -math.asin(CAR.wheelbase / radius), CAR.wheelbase, np.empty((0, 2)), USUAL
    )
    rear = math.sqrt(radius**2 - CAR.wheelbase**2)
    for angle in np.linspace(0.2, 5.0, 40):
        for bitmap, r in ((maps.bitmaps[0], radius), (maps.bitmaps[1], rear)):
            x, y = r * math.sin(angle), radius - r * math.cos(angle)
            assert map_potential(bitmap, x, y, maps.x0, maps.y0, maps.cell) <= 1.5 * maps.cell * USUAL.valley_attraction


def test_obstacles_beside_the_curve_do_not_push_the_car_off_it():
    plan = plan_along(turning([20.0, 12.0, 40.0], [0.0, 1.0 / 8.0, 0.0]), 8.0)
    x, y, heading = plan.curve.at(26.0)
    wall = np.array([(x + d * math.sin(heading), y - d * math.cos(heading)) for d in np.linspace(1.0, 2.0, 10)])
    free, beside = (
        [abs(seen.d) for seen, _ in driven(plan, on_curve(plan.curve, 5.0, 5.0), lambda _: asked(plan), 9.0, static=static)]
        for static in (np.empty((0, 2)), wall)
    )
    assert max(beside) <= max(free) + 0.02


BORDER = np.column_stack([np.arange(-20.0, 20.5, 1.0), np.full(41, -1.6)])
"""A road's border half a lane to the right of the line y = 0, points 1 m apart."""


def slopes(section: np.ndarray) -> tuple[float, float]:
    """Rise of U₁ from the floor to 1 m on the right, beside the border, and on the left, 1/m."""
    right, floor, left = section
    return right - floor, left - floor


def test_beside_a_border_the_exact_valley_rises_faster_and_its_floor_stays_on_the_curve():
    section = exact_section([tuple(point) for point in BORDER], np.array([-1.0, 0.0, 1.0]))
    right, left = slopes(section)
    assert section[1] == 0.0
    assert right == pytest.approx(USUAL.valley_attraction + USUAL.valley_repulsion / 0.6)
    assert left == pytest.approx(USUAL.valley_attraction + USUAL.valley_repulsion / 2.6)


def test_beside_a_border_the_valley_of_the_bitmap_rises_faster_and_its_floor_stays_on_the_curve():
    half = MIDDLE * CELL
    x = np.arange(-half, half, 0.25 * CELL)
    bitmap = valley_bitmap(np.column_stack((x, np.zeros_like(x))), BORDER, -half, -half, CELL, USUAL)
    section = np.array([map_potential(bitmap, 0.0, y, -half, -half, CELL) for y in (-1.0, 0.0, 1.0)])
    right, left = slopes(section)
    assert section[1] == pytest.approx(0.0, abs=1e-9)
    assert right == pytest.approx(USUAL.valley_attraction + USUAL.valley_repulsion / 0.6)
    assert left == pytest.approx(USUAL.valley_attraction + USUAL.valley_repulsion / 2.6)
    assert (np.diff(bitmap[:, MIDDLE])[MIDDLE:] > 0.0).all()
