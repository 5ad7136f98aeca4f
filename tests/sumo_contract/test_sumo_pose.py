"""What a pose set with moveToXY is after the step."""

import math

import libsumo
import pytest
from contract_driving import another, depart, place, take_over


@pytest.mark.parametrize("step", [0.05, 0.1, 1.0])
@pytest.mark.parametrize("option", [(), ("--lateral-resolution", "0.5"), ("--lanechange.duration", "3")], ids=str)
def test_a_pose_set_with_move_to_xy_is_exact_after_the_step(simulate, priority_cross, step, option):
    wants_to_change_lane = depart("wc cn", lane=0, speed=5) + another("slow", 0, 80, kind="crawling")
    simulate(priority_cross, wants_to_change_lane, *option, step=step)
    take_over()
    x, _ = libsumo.vehicle.getPosition("ego")
    for k in range(round(8 / step)):
        x, y, angle = x + 5 * step, 195.2 + 1.5 * math.sin(k * step), 90 + 5 * math.cos(k * step)
        place(x, y, 5.0, angle)
        assert libsumo.vehicle.getPosition("ego") == pytest.approx((x, y), abs=1e-9)
        assert libsumo.vehicle.getAngle("ego") == pytest.approx(angle, abs=1e-9)


@pytest.mark.parametrize("step", [0.05, 0.1, 1.0])
def test_speed_and_acceleration_are_those_set_not_those_of_the_displacement(simulate, priority_cross, step):
    simulate(priority_cross, depart("wc ce"), step=step)
    take_over()
    place(30.0, 198.4, 10.0)
    for speed in (10.0, 12.0, 9.0, 17.0):
        before = libsumo.vehicle.getSpeed("ego")
        place(40.0, 198.4, speed)
        assert libsumo.vehicle.getSpeed("ego") == pytest.approx(speed)
        assert libsumo.vehicle.getAcceleration("ego") == pytest.approx((speed - before) / step)


def test_position_is_the_front_bumper_centre(simulate, priority_cross):
    simulate(priority_cross, depart("wc ce", position=20) + another("leader", 1, 60))
    take_over()
    ego, ahead = libsumo.vehicle.getPosition("ego"), libsumo.vehicle.getPosition("leader")
    assert ego[0] == pytest.approx(libsumo.vehicle.getLanePosition("ego"))
    assert ego[1] == pytest.approx(198.4)
    gap_beyond_min_gap = libsumo.vehicle.getLeader("ego", 100)[1]
    assert gap_beyond_min_gap + libsumo.vehicle.getMinGap("ego") == pytest.approx(ahead[0] - 4.5 - ego[0])


def test_angle_is_navigational(simulate, priority_cross):
    routes = {"ec cw": 270, "nc cs": 180, "sc cn": 0, "wc ce": 90}
    cars = "".join(
        f'<vehicle id="{angle}" type="other" depart="0" departPos="50"><route edges="{route}"/></vehicle>'
        for route, angle in routes.items()
    )
    simulate(priority_cross, cars)
    libsumo.simulationStep()
    for angle in routes.values():
        assert libsumo.vehicle.getAngle(str(angle)) == pytest.approx(angle)


def test_parameters_are_read_from_where_they_were_written_and_are_empty_if_unknown(simulate, priority_cross):
    simulate(priority_cross, depart("wc ce"))
    take_over()
    libsumo.vehicletype.setParameter("ego", "reactive.wheelbase", "2.7")
    libsumo.vehicle.setLength("ego", 4.6)
    own_type = libsumo.vehicle.getTypeID("ego")
    assert own_type != "ego"
    assert libsumo.vehicletype.getParameter(own_type, "reactive.wheelbase") == "2.7"
    assert libsumo.vehicle.getParameter("ego", "reactive.wheelbase") == ""
