"""Lane choice: which lanes lead on, and where the plan changes."""

import math
from dataclasses import replace

import pytest
from planner_roads import CAR, graph, road, start_on

from sumo_reactive.driver.path.lane_choice import choose_lanes
from sumo_reactive.driver.path.planner import plan
from sumo_reactive.driver.world.road_graph import RoadGraph
from sumo_reactive.driver.world.route import Route, ScheduledStop
from sumo_reactive.errors import PlanError


def three_edges(middle: float = 100.0, links: tuple[tuple[str, str], ...] | None = None) -> RoadGraph:
    a = road("a", [(0, 0), (200, 0)], 3)
    b = road("b", [(201, 0), (201 + middle, 0)], 3)
    c = road("c", [(202 + middle, 0), (402 + middle, 0)], 1)
    through = tuple((f"a_{k}", f"b_{k}") for k in range(3))
    return graph([a, b, c], links or (*through, ("b_0", "c_0")))


ABC = Route(("a", "b", "c"))


def test_a_lane_that_ends_needs_as_many_changes_as_there_are_lanes_between() -> None:
    choice = choose_lanes(three_edges(), ABC, "passenger")
    assert [choice.best[0][k].changes for k in range(3)] == [0, 1, 2]


def test_the_car_stays_on_its_lane_until_the_last_edge_that_leads_on() -> None:
    world = three_edges()
    found = plan(world, ABC, CAR, start_on(world.lanes["a_1"], 10.0))
    (change,) = found.lane_changes
    assert (change.from_lane, change.to_lane, change.side) == ("b_1", "b_0", -1)
    assert change.opens == 0.0
    assert change.end < found.passages[1].start - 1.5


def test_a_short_last_edge_makes_the_car_change_on_the_edge_before() -> None:
    world = three_edges(middle=15.0)
    found = plan(world, ABC, CAR, start_on(world.lanes["a_1"], 10.0))
    assert [change.from_lane for change in found.lane_changes] == ["a_1"]


def test_two_changes_follow_one_another() -> None:
    world = three_edges()
    first, second = plan(world, ABC, CAR, start_on(world.lanes["a_2"], 10.0)).lane_changes
    assert (first.to_lane, second.to_lane) == ("b_1", "b_0")
    assert first.end <= second.start + 1e-6


def test_a_change_opens_only_where_the_neighbour_lane_leads_there() -> None:
    world = three_edges(links=(("a_1", "b_1"), ("a_2", "b_2"), ("b_0", "c_0")))
    found = plan(world, ABC, CAR, start_on(world.lanes["a_1"], 10.0))
    assert found.lane_changes[0].opens == pytest.approx(found.passages[0].end, abs=0.1)


def test_lanes_closed_to_the_class_are_not_used() -> None:
    a, b = road("a", [(0, 0), (200, 0)], 2, closed=[0]), road("b", [(201, 0), (300, 0)], 1)
    world = graph([a, b], [("a_0", "b_0")])
    assert choose_lanes(world, Route(("a", "b")), "passenger").best[0][1].cost == math.inf
    assert choose_lanes(world, Route(("a", "b")), "bus").best[0][1].changes == 1


def test_a_route_without_a_lane_sequence_names_the_edges_where_it_breaks() -> None:
    world = three_edges(links=(("a_0", "b_0"),))
    with pytest.raises(PlanError, match="'b' to edge 'c'"):
        plan(world, ABC, CAR, start_on(world.lanes["a_0"], 10.0))


def test_a_route_may_repeat_an_edge() -> None:
    world = three_edges(links=(("a_0", "b_0"), ("b_0", "a_1"), ("b_0", "c_0"), ("a_1", "b_0")))
    found = plan(world, Route(("a", "b", "a", "b", "c")), CAR, start_on(world.lanes["a_0"], 10.0))
    assert [s.route_index for s in found.segments if s.lane_id.startswith(("a", "b", "c"))] == [0, 1, 2, 3, 4]


def test_a_stop_on_another_lane_makes_the_car_change_before_it() -> None:
    world = three_edges(links=(*((f"a_{k}", f"b_{k}") for k in range(3)), ("b_0", "c_0"), ("b_1", "c_0")))
    route = Route(("a", "b", "c"), stops=(ScheduledStop("a_0", 150.0, 20.0),))
    found = plan(world, route, CAR, start_on(world.lanes["a_1"], 10.0))
    assert found.lane_changes[0].to_lane == "a_0"
    assert found.lane_changes[0].end < found.stops[0].s
    assert found.stops[0].s == pytest.approx(150.0 - 9.1, abs=0.5)


def test_a_stop_that_no_lane_reaches_is_named() -> None:
    world = three_edges(links=(("a_1", "b_1"), ("b_0", "c_0")))
    a, b = road("a", [(0, 0), (200, 0)], 2, closed=[0]), road("b", [(201, 0), (300, 0)], 1)
    world = graph([a, b], [("a_1", "b_0")])
    route = Route(("a", "b"), stops=(ScheduledStop("a_0", 150.0, 20.0),))
    with pytest.raises(PlanError, match="a_0"):
        plan(world, route, CAR, start_on(world.lanes["a_1"], 10.0))


def test_the_arrival_lane_is_reached() -> None:
    world = graph([road("a", [(0, 0), (300, 0)], 3)], [])
    found = plan(world, Route(("a",), 250.0, 2), CAR, start_on(world.lanes["a_0"], 10.0))
    assert [change.side for change in found.lane_changes] == [1, 1]
    assert found.goal == pytest.approx(240.9, abs=1.0)


@pytest.mark.parametrize(("left_hand", "side"), [(False, 1), (True, -1)])
def test_lane_changes_obey_the_side_that_the_driver_sees(left_hand: bool, side: int) -> None:
    barred = "change_left" if side == 1 else "change_right"
    lanes = road("a", [(0, 0), (300, 0)], 2)
    free = replace(graph([lanes], []), left_hand=left_hand)
    closed = replace(graph([(replace(lanes[0], **{barred: frozenset()}), lanes[1])], []), left_hand=left_hand)
    start, route = start_on(lanes[0], 20.0), Route(("a",), None, 1)
    assert [change.side for change in plan(free, route, CAR, start).lane_changes] == [side]
    with pytest.raises(PlanError, match="no lane changes"):
        plan(closed, route, CAR, start)


@pytest.mark.parametrize("position", [56.0, 58.0])
def test_the_stop_line_is_where_a_late_change_leads_over_it_slantwise(position: float) -> None:
    a, b = road("a", [(0, 0), (60, 0)], 2), road("b", [(61, 0), (160, 0)], 1)
    world = graph([a, b], [("a_0", "b_0")])
    found = plan(world, Route(("a", "b")), CAR, start_on(world.lanes["a_1"], position, 3.0))
    assert found.curve.at(found.passages[0].start)[0] == pytest.approx(60.0, abs=0.02)


def test_the_stop_line_of_a_turn_that_swings_out_for_it_is_where_c_first_leads_over_it() -> None:
    a, b = road("a", [(0, 0), (60, 0)]), road("b", [(60, 7), (0, 7)])
    world = graph([a, b], [("a_0", "b_0")], {"a_0": [(62, 3.5)]})
    found = plan(world, Route(("a", "b")), CAR, start_on(world.lanes["a_0"], 10.0, 5.0))
    assert found.curve.at(found.passages[0].start)[0] == pytest.approx(60.0, abs=0.05)
    assert max(found.curve.at(0.1 * k)[0] for k in range(int(10.0 * found.passages[0].start))) < 60.0
