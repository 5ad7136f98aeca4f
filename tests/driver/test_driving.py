"""The driver alone, without SUMO: it changes lanes, overtakes, plans on and takes another way, past cars placed by hand."""

import math
from dataclasses import replace
from itertools import pairwise

import pytest
from helpers.cars import BODY, CAR
from helpers.situations import NETWORKS, graph_of

from sumo_reactive.driver.controller import Controller
from sumo_reactive.driver.driving import Driving, set_out, shortest_change
from sumo_reactive.driver.nouns.completed_plan import Replanning, Request
from sumo_reactive.driver.nouns.decision import Instruction
from sumo_reactive.driver.nouns.state import Pose
from sumo_reactive.driver.nouns.traffic import RoadUser, Traffic
from sumo_reactive.driver.path.planner import PlanStart
from sumo_reactive.driver.world.route import Route
from sumo_reactive.errors import PlanError
from sumo_reactive.sumo.net_reader import read_net

PERIOD = 0.1


class Straight:
    """A car that keeps its speed along its lane, seen from above."""

    def __init__(self, graph, name, lane_id, position, speed, route):
        self.lane, self.id, self.position, self.speed, self.route = graph.lanes[lane_id], name, position, speed, route

    def at(self, time):
        at = self.position + self.speed * time
        spine = self.lane.spine
        return RoadUser(self.id, *spine.at(at), spine.heading_at(at), self.speed, self.lane.id, at, BODY, self.route)


def setting_out(network, edges, lane, position, speed, ways=None) -> Driving:
    graph = graph_of(network, edges)
    spine, back = graph.lanes[lane].spine, CAR.front_to_rear_axle
    x, y = spine.at(position - back)
    start = PlanStart(Pose(x, y, spine.heading_at(position)), speed, 0.0, 0.0, lane, position, 0)
    return set_out(Controller(graph=graph, limits=CAR), Route(edges), start, ways=ways)


def driven(driving, seconds, *others):
    """Drive, and return every step with the driving after it."""
    found = []
    for k in range(round(seconds / PERIOD)):
        time = k * PERIOD
        sight = driving.drive.completed.sight if driving.drive.completed else 0.0
        traffic = Traffic(time=time, users=tuple(one.at(time) for one in others), lights={}, sight=sight)
        step = driving.step(traffic, PERIOD)
        driving = driving.after(step, time + PERIOD)
        found.append((step, driving))
        if driving.left <= 0.0:
            break
    return found


def test_it_changes_to_the_lane_that_its_route_turns_off_from_and_arrives():
    edges = ("road_in", "road_before_exit", "exit")
    driving = setting_out("multi_lane_road", edges, "road_in_2", 40.0, 20.0)
    beside = Straight(driving.graph, "beside", "road_in_1", 38.0, 20.0, edges[:2])
    found = driven(driving, 120.0, beside)
    changes = [step.completed.request.change_lane for step, _ in found if step.completed.request.change_lane]
    assert changes == [-1, -1]
    assert sum(a.drive.plan is not b.drive.plan for (_, a), (_, b) in pairwise(found)) >= 2
    assert found[-1][1].left <= 0.0


def test_it_overtakes_a_slow_car_and_comes_back_to_its_lane():
    edges = ("eastbound", "eastbound_out")
    driving = setting_out("country_road", edges, "eastbound_0", 100.0, 20.0)
    slow = Straight(driving.graph, "slow", "eastbound_0", 160.0, 8.0, edges)
    found = driven(driving, 30.0, slow)
    assert any(step.completed.instruction is Instruction.OVERTAKE for step, _ in found)
    assert any(after.drive.plan.aside is not None for _, after in found)
    spine = driving.graph.lanes["eastbound_0"].spine
    last = found[-1][1]
    ahead, aside = spine.project(last.drive.ego.pose.x, last.drive.ego.pose.y)
    assert ahead > slow.at(30.0).lane_position + CAR.length
    assert abs(aside) < 0.3 and last.drive.completed.instruction is not Instruction.OVERTAKE
    sides = [spine.project(after.drive.ego.pose.x, after.drive.ego.pose.y)[1] for _, after in found]
    assert max(sides) > 2.0


def test_where_the_curve_ends_before_the_route_it_plans_on():
    driving = setting_out("country_road", ("eastbound", "eastbound_out"), "eastbound_0", 30.0, 20.0)
    assert driving.drive.plan.goal is None
    end = driving.drive.plan.curve.length
    *_, (_, last) = driven(driving, 1.2 * end / 20.0)
    assert last.drive.plan is not driving.drive.plan
    assert last.graph.lanes["eastbound_0"].spine.project(last.drive.ego.pose.x, last.drive.ego.pose.y)[0] > end


class Detour:
    """Roads beyond the world, with one way round; counts who asks."""

    def __init__(self, way):
        self.net, self.way, self.asked = read_net(NETWORKS / "multi_lane_road" / "multi_lane_road.net.xml"), way, 0

    def build(self, edges):
        return self.net.build(edges)

    def quickest_way(self, firsts, goals):
        self.asked += 1
        return self.way if set(self.way[:1]) <= set(firsts) else ()


def missing_its_turn(ways, waiting_since) -> tuple[Driving, Driving]:
    """A driver on the left lane whose pilot asks, twice, for another way than off to the right; what it makes of that."""
    driving = setting_out("multi_lane_road", ("road_before_exit", "exit"), "road_before_exit_2", 40.0, 20.0, ways)
    step = driving.step(Traffic(time=0.0, users=(), lights={}), PERIOD)
    memory = step.drive.memory._replace(waiting_since=waiting_since)
    asks = replace(step.completed, request=Request(what=Replanning.ROUTE))
    step = step._replace(completed=asks, drive=step.drive._replace(memory=memory))
    return driving, driving.after(step, PERIOD).after(step, PERIOD)


def test_it_takes_the_way_round_that_it_has_waited_long_enough_for_in_the_world_around_that():
    ways = Detour(("road_after_exit",))
    _, after = missing_its_turn(ways, -1000.0)
    assert after.route.edges == ("road_before_exit", "road_after_exit")
    assert "road_after_exit" in after.graph.edge_lanes
    assert after.drive.plan.segments[0].lane_id == "road_before_exit_2"


@pytest.mark.parametrize(("way", "waiting_since"), [(("road_after_exit",), None), ((), -1000.0)])
def test_it_looks_for_a_way_round_once_on_each_lane_and_keeps_to_its_route_without_one(way, waiting_since):
    ways = Detour(way)
    before, after = missing_its_turn(ways, waiting_since)
    assert ways.asked == 1
    assert after.route is before.route


def test_a_driver_that_knows_no_roads_beyond_its_world_keeps_to_its_route():
    before, after = missing_its_turn(None, -1000.0)
    assert after.route is before.route


@pytest.mark.parametrize(("left", "is_taken"), [(1.0, True), (5.0, True), (30.0, False)])
def test_a_change_that_no_steering_has_room_for_is_not_begun_where_there_is_another_way(left, is_taken):
    ways = Detour(("road_after_exit",))
    end = graph_of("multi_lane_road", ("road_before_exit", "exit")).lanes["road_before_exit_1"].spine.length
    driving = setting_out("multi_lane_road", ("road_before_exit", "exit"), "road_before_exit_1", end - left, 1.0, ways)
    assert ways.asked == is_taken
    assert (driving.route.edges == ("road_before_exit", "road_after_exit")) is is_taken
    assert bool(driving.drive.plan.lane_changes) is not is_taken


def test_a_change_without_room_is_begun_where_there_is_no_other_way():
    ways = Detour(())
    end = graph_of("multi_lane_road", ("road_before_exit", "exit")).lanes["road_before_exit_1"].spine.length
    driving = setting_out("multi_lane_road", ("road_before_exit", "exit"), "road_before_exit_1", end - 1.0, 1.0, ways)
    assert ways.asked == 1 and driving.drive.plan.lane_changes


@pytest.mark.parametrize("aside", [0.0, 1.0, 3.2])
def test_the_shortest_change_is_two_arcs_of_the_tightest_circle(aside):
    radius = 5.0
    length = shortest_change(aside, 1.0 / radius)
    turned = math.asin(0.5 * length / radius)
    assert 2.0 * radius * (1.0 - math.cos(turned)) == pytest.approx(aside)


def test_a_route_that_no_lanes_join_is_refused():
    with pytest.raises(PlanError):
        setting_out("multi_lane_road", ("road_in", "exit"), "road_in_2", 40.0, 20.0)
