"""The ego in a real simulation, where its body swings out of its lanes."""

from contextlib import contextmanager

import libsumo
import pytest
from net_recipes import CROSS_NODES, converted, cross_edges

from sumo_reactive.messages.completed_plan import Intent
from sumo_reactive.messages.state import VehicleState
from sumo_reactive.sumo.ego import Ego
from sumo_reactive.sumo.net_reader import read_net
from sumo_reactive.sumo.units import front_of, pose_of

ROUTE = ("wc", "ce")
LANE_Y = -1.6
"""Centre of the lane wc_0, m; the oncoming lane lies at +1.6."""


@contextmanager
def on_cross(tmp_path, attributes=""):
    """Run a simulation of a cross with an ego on ROUTE; yield it and its lane."""
    net = converted(tmp_path, CROSS_NODES.format(kind="priority"), cross_edges(), "--no-turnarounds")
    routes = tmp_path / "ego.rou.xml"
    vehicle = f'<vehicle id="ego" depart="0" {attributes}><route edges="{" ".join(ROUTE)}"/></vehicle>'
    routes.write_text(f"<routes>{vehicle}</routes>")
    with seen_first(net, routes) as ego:
        yield ego, read_net(net).lane("wc_0")


@contextmanager
def seen_first(net, routes):
    """Run a simulation, after the first step of which the ego is on the road."""
    libsumo.start(["sumo", "-n", str(net), "-r", str(routes), "--no-step-log", "--step-length", "0.1"])
    try:
        libsumo.simulationStep()
        yield Ego("ego")
    finally:
        libsumo.close()


def test_an_ego_that_swings_out_over_another_road_keeps_its_route(tmp_path):
    """A long vehicle in a U-turn does; with its route lost, SUMO's sublane model crashed."""
    with on_cross(tmp_path) as (ego, lane):
        ego.take_over(0.1)
        mapped = []
        for y in (LANE_Y - 8.0, LANE_Y + 4.0, LANE_Y):  # beside the road, over the oncoming lane, back
            state = VehicleState(pose_of(-100.0, y, 0.0, ego.limits), 1.0, 0.0)
            ego.place(state, Intent.DRIVE, 0.1, lane)
            libsumo.simulationStep()
            mapped.append(ego.lane(state))
            assert libsumo.vehicle.getRoute("ego") == ROUTE
        assert (mapped[0], mapped[-1]) == ("", "wc_0")


def test_others_expect_of_the_ego_what_they_expect_of_its_type_until_it_brakes_harder(tmp_path):
    """SUMO's cars choose their gaps behind a vehicle by its type: with more to fear they would at once brake hard."""
    with on_cross(tmp_path) as (ego, lane):
        usual = libsumo.vehicle.getApparentDecel("ego")
        ego.take_over(0.1)
        feared = []
        for acceleration in (0.0, -3.0, -8.0, -1.0):
            state = VehicleState(pose_of(-60.0, LANE_Y, 0.0, ego.limits), 10.0, 0.0, acceleration)
            ego.place(state, Intent.DRIVE, 0.1, lane)
            libsumo.simulationStep()
            feared.append(libsumo.vehicle.getApparentDecel("ego"))
        assert feared == [usual, usual, ego.limits.emergency_deceleration, usual]


def test_the_ego_asks_for_room_only_while_it_seeks_a_gap(tmp_path):
    with on_cross(tmp_path) as (ego, _):
        ego.take_over(0.1)
        modes = []
        for wants_room in (False, True, True, False):
            ego.ask_for_room(wants_room)
            modes.append(libsumo.vehicle.getLaneChangeMode("ego") != 0)
        assert modes == [False, True, True, False]


def over_the_lane_beside(net):
    """The places of an ego that swings over lane wc_0 on its way from wc_1 into the junction, and the lane inside."""
    graph = read_net(net).build(("wc", "cn"))
    beside, own = graph.lanes["wc_0"].spine, graph.lanes["wc_1"]
    (turn,) = (c for c in graph.outgoing["wc_1"] if c.to_lane.startswith("cn"))
    inside = graph.lanes[turn.parts[0]]
    way = [(*beside.at(beside.length + s), own) for s in (-1.5, -1.0, -0.5, 0.0)]
    return [*way, *((*inside.spine.at(s), inside) for s in (0.5, 1.0))], inside


def test_an_ego_that_swings_over_the_lane_beside_as_it_turns_keeps_its_speed_for_sumo(tmp_path):
    """From the end of a lane that does not lead where the ego goes SUMO would stop it for a step."""
    net = converted(tmp_path, CROSS_NODES.format(kind="priority"), cross_edges(2), "--no-turnarounds")
    routes = tmp_path / "ego.rou.xml"
    vehicle = '<vehicle id="ego" depart="0" departLane="1"><route edges="wc cn"/></vehicle>'
    routes.write_text(f"<routes>{vehicle}</routes>")
    way, inside = over_the_lane_beside(net)
    with seen_first(net, routes) as ego:
        ego.take_over(0.1)
        seen = []
        for x, y, lane in way:
            state = VehicleState(pose_of(x, y, 0.0, ego.limits), 5.0, 0.0)
            ego.place(state, Intent.DRIVE, 0.1, lane)
            libsumo.simulationStep()
            seen.append((ego.lane(state), libsumo.vehicle.getSpeed("ego")))
        assert [lane for lane, _ in seen] == ["wc_0"] * 4 + [inside.id] * 2
        assert [speed for _, speed in seen] == [5.0] * 6


def test_who_follows_does_not_brake_for_a_step_in_which_sumo_has_stopped_the_ego(tmp_path):
    """With somebody on the ego's lane SUMO has it on the one beside to its end, and stops it there for a step."""
    net = converted(tmp_path, CROSS_NODES.format(kind="priority"), cross_edges(2), "--no-turnarounds")
    routes = tmp_path / "ego.rou.xml"
    vehicles = """<routes><vType id="car" sigma="0"/>
        <vehicle id="ego" depart="0" departLane="1"><route edges="wc cn"/></vehicle>
        <vehicle id="behind" depart="0" departLane="0" departPos="124" departSpeed="5"><route edges="wc ce"/></vehicle>
        <vehicle id="left" depart="0" departLane="1" departPos="20" departSpeed="5"><route edges="wc cn"/></vehicle>
        </routes>"""
    routes.write_text(vehicles)
    way, _ = over_the_lane_beside(net)
    with seen_first(net, routes) as ego:
        ego.take_over(0.1)
        told, braking = [], []
        for x, y, lane in way:
            state = VehicleState(pose_of(x, y, 0.0, ego.limits), 5.0, 0.0)
            ego.place(state, Intent.DRIVE, 0.1, lane)
            libsumo.simulationStep()
            braking.append(libsumo.vehicle.getAcceleration("behind"))
            told.append((libsumo.vehicle.getSpeed("ego"), ego.lane(state) and libsumo.vehicle.getSpeed("ego")))
        assert told == [(5.0, 5.0)] * 4 + [(0.0, 5.0), (5.0, 5.0)]  # as SUMO says, and as the others see it
        assert min(braking[1:]) > -1.0


@pytest.mark.parametrize(("speed", "is_turned"), [(14.0, True), (2.0, False)])
def test_an_ego_inserted_askew_at_the_start_of_its_lane_is_laid_along_it_unless_it_steers_back(tmp_path, speed, is_turned):
    """On a lane that begins with a bend SUMO shows the angle of a body whose rear is nowhere yet."""
    with on_cross(tmp_path, 'departPos="0"') as (ego, lane):
        seen = ego.take_over(0.1)
        x, y = front_of(seen.pose, ego.limits)
        askew = VehicleState(pose_of(x, y, seen.pose.heading + 0.5, ego.limits), speed, 0.0)
        laid = ego.laid_along(lane, askew)
        assert laid.pose.heading == pytest.approx(0.0 if is_turned else askew.pose.heading, abs=1e-3)
        assert front_of(laid.pose, ego.limits) == pytest.approx((x, y))


def test_an_ego_whose_body_is_on_its_lane_keeps_the_angle_it_has(tmp_path):
    with on_cross(tmp_path) as (ego, lane):
        seen = ego.take_over(0.1)
        askew = VehicleState(pose_of(seen.pose.x, seen.pose.y, 0.5, ego.limits), 14.0, 0.0)
        assert ego.laid_along(lane, askew) is askew
