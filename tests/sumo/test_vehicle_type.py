"""The ego's limits, as its vehicle type and its parameters say them."""

import math

import pytest
from net_recipes import CROSS_NODES, converted, cross_edges
from simulations import running, simulated, vehicle

from sumo_reactive.driver.parameters import USUAL
from sumo_reactive.errors import ScenarioError
from sumo_reactive.sumo.vehicle_type import (
    FRONT_OVERHANG_FRACTION,
    LONG_VEHICLE_STEERING_ANGLE,
    MAX_STEERING_ANGLE,
    TURNING_CIRCLE_M,
    WHEELBASE_FRACTION,
    limits_of,
    steering_angle_of,
)

KIND = 'length="4.4" width="1.7" accel="2.1" decel="4.1" emergencyDecel="8.5" maxSpeed="33" tau="1.3" minGap="1.7"'


@pytest.fixture(scope="module")
def net(tmp_path_factory):
    return converted(tmp_path_factory.mktemp("net"), CROSS_NODES.format(kind="priority"), cross_edges(), "--no-turnarounds")


def limits(net, folder, kind: str = KIND, of_kind: str = "", of_vehicle: str = ""):
    """The limits of a vehicle of a type with these attributes; `of_…`: parameters."""
    content = f'<vType id="t" {kind}>{of_kind}</vType>' + vehicle("ego", "wc ce", of_vehicle, type="t")
    with running(net, folder, content):
        simulated()
        return limits_of("ego")


def param(name: str, value: object) -> str:
    return f'<param key="reactive.{name}" value="{value}"/>'


def test_sizes_and_accelerations_are_those_of_the_type_and_the_rest_follows(net, tmp_path):
    found = limits(net, tmp_path)
    assert (found.length, found.width, found.max_speed) == pytest.approx((4.4, 1.7, 33.0))
    assert (found.wheelbase, found.front_overhang) == pytest.approx(
        (WHEELBASE_FRACTION * 4.4, FRONT_OVERHANG_FRACTION * 4.4)
    )
    assert (found.max_acceleration, found.service_deceleration, found.emergency_deceleration) == pytest.approx(
        (2.1, 4.1, 8.5)
    )
    assert (found.comfort_deceleration, found.time_headway, found.standstill_gap) == pytest.approx(
        (USUAL.comfort_deceleration, 1.3, 1.7)
    )
    assert (found.max_steering_angle, found.max_steering_rate) == (MAX_STEERING_ANGLE, USUAL.max_steering_rate)
    assert found.max_lateral_acceleration == USUAL.max_lateral_acceleration
    assert found.comfort_lateral_acceleration == USUAL.comfort_lateral_acceleration


@pytest.mark.parametrize(("gap", "kept"), [(0.2, 1.0), (1.5, 1.5), (5.0, USUAL.standstill_gap_m)])
def test_the_gap_of_a_stand_is_the_types_within_bounds(net, tmp_path, gap, kept):
    assert limits(net, tmp_path, f'minGap="{gap}"').standstill_gap == pytest.approx(kept)


def test_a_weak_brake_bounds_the_comfortable_one_and_the_emergencys_is_never_weaker_than_the_service_one(net, tmp_path):
    found = limits(net, tmp_path, 'decel="2" emergencyDecel="1"')
    assert (found.comfort_deceleration, found.service_deceleration, found.emergency_deceleration) == (2.0, 2.0, 2.0)


def test_a_parameter_of_the_vehicle_wins_over_its_types_and_that_over_the_rest(net, tmp_path):
    found = limits(net, tmp_path, KIND, param("wheelbase", 2.5) + param("max_steering_angle", 0.5), param("wheelbase", 2.7))
    assert (found.wheelbase, found.max_steering_angle) == (2.7, 0.5)


def test_a_parameter_that_is_no_number_is_told_with_vehicle_and_name(net, tmp_path):
    with pytest.raises(ScenarioError) as told:
        limits(net, tmp_path, KIND, "", param("width", "wide"))
    assert str(told.value) == "vehicle 'ego': parameter 'reactive.width' is not a number: 'wide'"


def test_an_impossible_vehicle_is_told_with_its_name(net, tmp_path):
    with pytest.raises(ScenarioError, match=r"^vehicle 'ego': .*wheelbase"):
        limits(net, tmp_path, KIND, "", param("wheelbase", -1))


def test_a_car_has_a_cars_lock():
    assert steering_angle_of(2.6, 0.8, 1.8) == MAX_STEERING_ANGLE


@pytest.mark.parametrize(("wheelbase", "overhang", "width"), [(7.2, 2.2, 2.5), (7.0, 2.8, 2.3)])
def test_a_longer_vehicle_keeps_its_front_corner_within_the_turning_circle(wheelbase, overhang, width):
    angle = steering_angle_of(wheelbase, overhang, width)
    assert MAX_STEERING_ANGLE < angle < LONG_VEHICLE_STEERING_ANGLE
    beside = wheelbase / math.tan(angle) + 0.5 * width
    assert math.hypot(wheelbase + overhang, beside) == pytest.approx(TURNING_CIRCLE_M)


@pytest.mark.parametrize(("wheelbase", "overhang"), [(11.0, 2.0), (20.0, 5.0)])
def test_no_wheels_turn_farther_than_a_long_vehicles(wheelbase, overhang):
    assert steering_angle_of(wheelbase, overhang, 2.5) == LONG_VEHICLE_STEERING_ANGLE
