"""The labelled oriented graph W (F&L 1991, §2)."""

import pytest
from world_pieces import connection, junction, lane

from sumo_reactive.driver.world.regions import conflict_regions
from sumo_reactive.driver.world.road_graph import Arc, ArcLabel, RoadGraph

EAST = connection("w_0->e_0", [(-8, 0), (8, 0)], 0)
NORTH = connection("s_0->n_0", [(1, -8), (1, 8)], 1)


def graph(left_hand: bool = False) -> RoadGraph:
    place = junction(EAST, NORTH, foes=[(0, 1)])
    lanes = {name: lane(name) for name in ("w_0", "w_1", "w_2", "e_0", ":j_0_0")}
    return RoadGraph(
        lanes=lanes,
        edge_lanes={"w": (lanes["w_0"], lanes["w_1"], lanes["w_2"]), "e": (lanes["e_0"],)},
        junctions={"j": place},
        connections={EAST.id: EAST, NORTH.id: NORTH},
        outgoing={"w_0": (EAST,)},
        incoming={"e_0": (EAST,)},
        connection_of={":j_0_0": EAST},
        regions=conflict_regions([EAST], place),
        opposite={},
        left_hand=left_hand,
    )


def names(graph: RoadGraph, lane_id: str) -> list[str | None]:
    return [found.id if found else None for found in graph.neighbours(lane_id)]


def test_the_outermost_lane_is_the_rightmost_in_right_hand_traffic():
    assert names(graph(), "w_0") == ["w_1", None]
    assert names(graph(), "w_1") == ["w_2", "w_0"]
    assert names(graph(), "w_2") == [None, "w_1"]


def test_the_outermost_lane_is_the_leftmost_in_left_hand_traffic():
    assert names(graph(left_hand=True), "w_0") == [None, "w_1"]
    assert names(graph(left_hand=True), "w_2") == ["w_1", None]


def test_an_internal_lane_has_no_neighbours():
    assert names(graph(), ":j_0_0") == [None, None]


def test_lanes_that_follow_each_other_are_joined():
    arcs = set(graph().arcs())
    assert Arc("w_0", ":j_0_0", ArcLabel.FOLLOWS) in arcs
    assert Arc(":j_0_0", "e_0", ArcLabel.FOLLOWS) in arcs


def test_a_lane_enters_a_conflict_region_which_clears_into_a_post_conflict_region_that_leads_to_a_lane():
    arcs = set(graph().arcs())
    (region,) = graph().regions[EAST.id]
    assert Arc("w_0", region.id, ArcLabel.ENTERS) in arcs
    assert Arc(region.id, region.post.id, ArcLabel.CLEARS) in arcs
    assert Arc(region.post.id, "e_0", ArcLabel.LEADS_TO) in arcs


def test_a_conflict_is_an_arc_both_ways():
    arcs = set(graph().arcs())
    (region,) = graph().regions[EAST.id]
    assert Arc(region.id, NORTH.id, ArcLabel.CONFLICTS) in arcs
    assert Arc(NORTH.id, region.id, ArcLabel.CONFLICTS) in arcs


def test_lanes_side_by_side_say_which_is_left():
    arcs = set(graph().arcs())
    assert Arc("w_1", "w_0", ArcLabel.LEFT_OF) in arcs
    assert Arc("w_0", "w_1", ArcLabel.RIGHT_OF) in arcs
    assert Arc("w_0", "w_1", ArcLabel.LEFT_OF) in set(graph(left_hand=True).arcs())


def test_who_yields_is_known_only_between_connections_with_a_row():
    table = graph().junctions["j"].right_of_way
    assert table.must_yield(0, 1)
    assert not table.must_yield(1, 0)
    assert table.in_conflict(1, 0)
    assert not table.must_yield(-1, 0)
    assert not table.in_conflict(0, 7)


def test_a_lane_without_extent_is_refused():
    with pytest.raises(ValueError, match="width and length must be positive"):
        lane("w_0", width=0.0)


def test_a_lane_tells_who_may_drive_on_it_and_leave_it():
    bus_lane = lane("w_0", allowed=frozenset({"bus"}), change_left=frozenset({"bus"}))
    assert bus_lane.allows("bus")
    assert not bus_lane.allows("passenger")
    assert not bus_lane.allows_change_left("passenger")
    assert bus_lane.allows_change_right("passenger")


def test_positions_on_a_lane_are_scaled_to_its_spine():
    assert lane("w_0", length=50.0).scale == pytest.approx(2.0)
