"""The ego in a real simulation, where its body swings out of its lanes."""

import libsumo
from net_recipes import CROSS_NODES, converted, cross_edges

from sumo_reactive.messages.completed_plan import Intent
from sumo_reactive.messages.state import VehicleState
from sumo_reactive.sumo.ego import Ego
from sumo_reactive.sumo.net_reader import read_net
from sumo_reactive.sumo.units import pose_of

ROUTE = ("wc", "ce")
LANE_Y = -1.6
"""Centre of the lane wc_0, m; the oncoming lane lies at +1.6."""


def test_an_ego_that_swings_out_over_another_road_keeps_its_route(tmp_path):
    """A long vehicle in a U-turn does; with its route lost, SUMO's sublane model crashed."""
    net = converted(tmp_path, CROSS_NODES.format(kind="priority"), cross_edges(), "--no-turnarounds")
    routes = tmp_path / "ego.rou.xml"
    routes.write_text(f'<routes><vehicle id="ego" depart="0"><route edges="{" ".join(ROUTE)}"/></vehicle></routes>')
    lane = read_net(net).lane("wc_0")
    libsumo.start(["sumo", "-n", str(net), "-r", str(routes), "--no-step-log", "--step-length", "0.1"])
    try:
        libsumo.simulationStep()
        ego = Ego("ego")
        ego.take_over(0.1)
        mapped = []
        for y in (LANE_Y - 8.0, LANE_Y + 4.0, LANE_Y):  # beside the road, over the oncoming lane, back
            state = VehicleState(pose_of(-100.0, y, 0.0, ego.limits), 1.0, 0.0)
            ego.place(state, Intent.DRIVE, 0.1, lane)
            libsumo.simulationStep()
            mapped.append(ego.lane(state))
            assert libsumo.vehicle.getRoute("ego") == ROUTE
        assert (mapped[0], mapped[-1]) == ("", "wc_0")
    finally:
        libsumo.close()
