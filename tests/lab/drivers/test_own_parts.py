"""Parts of the controller exchanged: a rule, a pilot, an executor of somebody else's, each with what it changes."""

import math
import sys
from pathlib import Path

import pytest
from test_users_trip import EXAMPLES, driven_by, steps_of

from sumo_reactive.driver.controller import PARTS, Controller, Parts
from sumo_reactive.driver.driving import set_out
from sumo_reactive.driver.nouns.state import Pose
from sumo_reactive.driver.nouns.traffic import Body, RoadUser, Traffic
from sumo_reactive.driver.path.planner import PlanStart
from sumo_reactive.driver.vehicle.limits import VehicleLimits
from sumo_reactive.driver.world.route import Route
from sumo_reactive.lab.drivers.choice import DriverChoice
from sumo_reactive.lab.drivers.loading import controller_parts
from sumo_reactive.sumo.net_reader import read_net

sys.path.insert(0, str(EXAMPLES))
from sumo_reactive_examples import own_parts

ROOT = Path(__file__).resolve().parents[3]
LIMITS = VehicleLimits(
    length=4.0, width=1.8, wheelbase=2.4, front_overhang=0.8, max_speed=50.0, max_acceleration=2.6, comfort_deceleration=2.5,
    service_deceleration=4.5, emergency_deceleration=9.0, max_steering_angle=0.65, max_steering_rate=1.0,
    max_lateral_acceleration=4.0, comfort_lateral_acceleration=3.0,
)  # fmt: skip
BIKE = Body(1.6, 0.65, 5.0, 5.0)


def least_room_beside_a_cyclist(parts: Parts) -> float:
    """Drive up to a cyclist at the edge of the lane; return the least room to his side while the bodies overlap along it."""
    route = Route(("eastbound", "eastbound_out"))
    graph = read_net(ROOT / "networks" / "country_road" / "country_road.net.xml").build(route.edges)
    start = PlanStart(Pose(136.8, 98.4, 0.0), 10.0, 0.0, 0.0, "eastbound_0", 100.0, 0)
    driving, rooms = set_out(Controller(graph=graph, limits=LIMITS, parts=parts), route, start), [math.inf]
    for k in range(300):
        x = 180.0 + 0.4 * k
        cyclist = RoadUser("bike", x, 96.9, 0.0, 4.0, "eastbound_0", x - 40.0, BIKE, ("eastbound", "eastbound_out"))
        driving = driving.after(driving.step(Traffic(time=0.1 * k, users=(cyclist,), lights={}), 0.1), 0.1 * k + 0.1)
        front = driving.drive.ego.pose.ahead(LIMITS.front_to_rear_axle)
        if -LIMITS.length < x - front[0] < BIKE.length:
            rooms.append(abs(front[1] - 96.9) - 0.5 * (LIMITS.width + BIKE.width))
    return min(rooms)


def test_a_rule_of_ones_own_keeps_a_metre_from_cyclists():
    usual, kept = least_room_beside_a_cyclist(PARTS), least_room_beside_a_cyclist(own_parts.ROOM_FOR_CYCLISTS)
    assert usual < 1.0 <= kept


@pytest.mark.parametrize("name", ["HURRIED", "STANLEY"])
def test_a_pilot_or_an_executor_of_ones_own_drives_the_trip_with_the_rest_of_this_projects(name):
    result, steps = steps_of(driven_by(f"sumo_reactive_examples.own_parts:{name}", EXAMPLES))
    assert result.exit_code == 0, result.verdict
    assert any(step.decisions for step in steps)
    assert (max(step.u for step in steps) == 0.0) == (name == "STANLEY")


def test_what_is_named_is_parts_only_if_it_is_some():
    assert controller_parts(DriverChoice("sumo_reactive_examples.own_parts:STANLEY", folder=EXAMPLES)) == own_parts.STANLEY
    assert controller_parts(DriverChoice("sumo_reactive_examples.idm_mobil:IdmMobil", folder=EXAMPLES)) is PARTS
    assert controller_parts(DriverChoice("reactive")) is PARTS
