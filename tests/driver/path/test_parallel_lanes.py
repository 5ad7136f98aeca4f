"""Which lanes beside C do as well for the route."""

from planner_roads import CAR, graph, road, start_on

from sumo_reactive.driver.nouns.plan import LaneSegment, ParallelLane
from sumo_reactive.driver.path.lane_choice import choose_lanes, parallel_lanes
from sumo_reactive.driver.path.planner import plan
from sumo_reactive.driver.world.road_graph import RoadGraph
from sumo_reactive.driver.world.route import Route, ScheduledStop


def world(*links: tuple[str, str], lanes: int = 2) -> RoadGraph:
    a, b = road("a", [(0, 0), (200, 0)], lanes), road("b", [(201, 0), (401, 0)], lanes)
    c = road("c", [(402, 0), (602, 0)], lanes)
    through = [(f"b_{k}", f"c_{k}") for k in range(lanes)]
    return graph([a, b, c], [*links, *through])


def ways(made: RoadGraph, lane_id: str, route: Route) -> tuple[ParallelLane, ...]:
    found = plan(made, route, CAR, start_on(made.lanes[lane_id], 10.0))
    return found.parallel_lanes.get(0, ())


ABC = Route(("a", "b", "c"))


def test_a_lane_that_leads_on_as_well_costs_the_change_to_it() -> None:
    made = world(("a_0", "b_0"), ("a_1", "b_1"))
    assert ways(made, "a_1", ABC) == (ParallelLane(from_lane="a_1", to_lane="a_0", side=-1, cost=1.0),)
    assert ways(made, "a_0", ABC) == (ParallelLane(from_lane="a_0", to_lane="a_1", side=1, cost=1.0, is_inner=True),)


def test_a_lane_that_has_to_be_left_again_before_the_junction_is_none() -> None:
    assert ways(world(("a_1", "b_1")), "a_1", ABC) == ()


def test_there_is_none_where_c_ends_on_a_lane_that_it_still_has_to_leave() -> None:
    made = world(("a_1", "b_1"))
    choice = choose_lanes(made, ABC, "passenger")
    assert parallel_lanes(choice, (LaneSegment(lane_id="a_0", start=0.0, end=100.0, lane_offset=0.0, route_index=0),)) == {}


def test_a_change_that_has_to_be_made_back_later_is_counted() -> None:
    made = world(("a_0", "b_0"), ("a_1", "b_1"))
    (way,) = ways(made, "a_1", Route(("a", "b", "c"), arrival_lane=1))
    assert way.cost == 2.0


def test_a_change_that_the_route_needs_later_costs_nothing_now() -> None:
    made = world(("a_0", "b_0"), ("a_1", "b_1"))
    (way,) = ways(made, "a_1", Route(("a", "b", "c"), arrival_lane=0))
    assert way.cost == 0.0


def test_before_a_stop_on_the_lane_there_is_none() -> None:
    made = world(("a_0", "b_0"), ("a_1", "b_1"))
    stop = ScheduledStop("a_1", 100.0, 10.0, None)
    assert ways(made, "a_1", Route(("a", "b", "c"), stops=(stop,))) == ()


def test_where_c_changes_lanes_itself_that_change_comes_first() -> None:
    made = world(("a_0", "b_0"), ("a_1", "b_1"), lanes=3)
    assert {way.from_lane for way in ways(made, "a_2", ABC)} == {"a_1"}
