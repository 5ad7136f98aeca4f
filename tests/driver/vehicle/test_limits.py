"""The dimensions and limits of a car: valid at birth, and what follows from them."""

import math
from dataclasses import fields, replace

import pytest
from helpers.cars import CAR

POSITIVE = [field.name for field in fields(CAR) if field.name not in ("front_overhang", "parameters", "vehicle_class")]


@pytest.mark.parametrize("name", POSITIVE)
@pytest.mark.parametrize("value", [0.0, -1.0, math.nan, math.inf])
def test_a_limit_that_is_not_positive_and_finite_is_refused_by_name(name, value):
    with pytest.raises(ValueError, match=name):
        replace(CAR, **{name: value})


@pytest.mark.parametrize(
    "change", [{"width": 1000.0}, {"length": 3000.0}, {"max_steering_angle": 3.2}, {"time_headway": 1e9}, {"max_speed": 1e6}]
)
def test_what_no_road_vehicle_has_is_refused_by_name(change):
    with pytest.raises(ValueError, match=f"vehicle {next(iter(change))} is .*, more than"):
        replace(CAR, **change)


@pytest.mark.parametrize("change", [{"front_overhang": -0.1}, {"wheelbase": 3.5}, {"front_overhang": 2.0}])
def test_axles_that_do_not_fit_into_the_length_are_refused(change):
    with pytest.raises(ValueError, match="length"):
        replace(CAR, **change)


def test_the_overhangs_and_the_wheelbase_make_up_the_length():
    assert CAR.rear_overhang + CAR.wheelbase + CAR.front_overhang == pytest.approx(CAR.length)
    assert CAR.front_to_rear_axle == pytest.approx(3.2)


def test_the_largest_curvature_is_that_of_the_front_axle_at_full_lock():
    assert CAR.max_curvature == pytest.approx(math.sin(0.65) / 2.4)


def test_a_front_overhang_that_is_not_a_number_is_refused():
    with pytest.raises(ValueError, match="overhang"):
        replace(CAR, front_overhang=math.nan)
