"""Where a long body covers the lane beside its own in a bend."""

import math

import pytest
from net_recipes import converted

from sumo_reactive.driver.nouns.state import Pose, VehicleState
from sumo_reactive.driver.path.planner import PlanStart, plan
from sumo_reactive.driver.vehicle.limits import VehicleLimits
from sumo_reactive.driver.world.route import Route
from sumo_reactive.sumo.net_reader import read_net
from sumo_reactive.sumo.straddling import cut_lane, haunt

CAR = VehicleLimits(4.7, 1.8, 2.8, 0.85, 50.0, 2.6, 2.5, 4.5, 9.0, 0.65, 1.0, 4.0, 3.0)
BUS = VehicleLimits(12.0, 2.5, 7.2, 2.16, 25.0, 1.2, 2.5, 4.5, 7.0, 0.8, 1.0, 4.0, 3.0)
NODES = '<nodes><node id="a" x="0" y="0"/><node id="b" x="100" y="0"/><node id="c" x="100" y="100"/></nodes>'
EDGES = '<edges><edge id="ab" from="a" to="b" numLanes="2"/><edge id="bc" from="b" to="c" numLanes="2"/></edges>'


@pytest.mark.parametrize(("limits", "shown"), [(CAR, {None}), (BUS, {None, "ab_1", ":b_0_1", "bc_1"})])
def test_a_bus_is_shown_on_the_inner_lane_of_a_turn_that_it_takes_on_the_outer(tmp_path, limits, shown):
    graph = read_net(converted(tmp_path, NODES, EDGES, "--no-turnarounds")).build(("ab", "bc"))
    lane = graph.lanes["ab_0"]
    x, y = lane.spine.at(20.0)
    pose = Pose(x - limits.front_to_rear_axle, y, 0.0)
    found = plan(graph, Route(("ab", "bc")), "bus", limits, PlanStart(pose, 8.0, 0.0, 0.0, "ab_0", 20.0, 0))
    seen = {}
    for s in range(int(found.curve.length) - 10):
        here = next(g for g in found.segments if s < g.end)
        lane = cut_lane(graph, found, here, float(s), 5.0, limits)
        seen[lane.id if lane else None] = s
    assert set(seen) == shown
    assert limits is CAR or math.isclose(seen[None], int(found.curve.length) - 11)


@pytest.mark.parametrize(("aside", "shown"), [(-3.2, "ab_1"), (-6.5, "ab_0")])
def test_an_ego_whose_front_has_swung_out_is_shown_where_sumo_does_not_map_it(tmp_path, aside, shown):
    """SUMO maps it to the lane beside, or, farther out, to none: then to be seen on the lane under its middle."""
    graph = read_net(converted(tmp_path, NODES, EDGES, "--no-turnarounds")).build(("ab", "bc"))
    x, y = graph.lanes["ab_1"].spine.at(50.0)
    start = PlanStart(Pose(x - BUS.front_to_rear_axle, y, 0.0), 5.0, 0.0, 0.0, "ab_1", 50.0, 0)
    found = plan(graph, Route(("ab", "bc")), "bus", BUS, start)
    heading, reach = -0.5, BUS.front_to_rear_axle
    pose = Pose(x - reach * math.cos(heading), y + aside - reach * math.sin(heading), heading)
    here = next(g for g in found.segments if g.lane_id == "ab_1")
    seen = haunt(graph, found, here, VehicleState(pose, 2.0, 0.0), 0.0, BUS, ("ab", "bc"))
    assert seen is not None
    assert seen.lane.id == shown
