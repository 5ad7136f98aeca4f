"""The labelled oriented graph W (F&L 1991, §2)."""

from dataclasses import replace

import pytest
from world_pieces import connection, junction, lane

from sumo_reactive.driver.world.regions import conflict_regions
from sumo_reactive.driver.world.road_graph import ArcLabel, RoadGraph, arcs_of, walk

EAST = connection("w_0->e_0", [(-8, 0), (8, 0)], 0)
NORTH = connection("s_0->n_0", [(1, -8), (1, 8)], 1)


def graph(left_hand: bool = False) -> RoadGraph:
    place = junction(EAST, NORTH, foes=[(0, 1)])
    lanes = {name: lane(name) for name in ("w_0", "w_1", "w_2", "e_0", ":j_0_0")}
    connections = {EAST.id: EAST, NORTH.id: NORTH}
    regions = {region.id: region for region in conflict_regions([EAST], place)[EAST.id]}
    return RoadGraph(
        lanes=lanes,
        edge_lanes={"w": (lanes["w_0"], lanes["w_1"], lanes["w_2"]), "e": (lanes["e_0"],)},
        junctions={"j": place},
        connections=connections,
        regions=regions,
        arcs=arcs_of(connections, regions.values()),
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
    assert graph().successors("w_0", ArcLabel.FOLLOWS) == [":j_0_0"]
    assert graph().successors(":j_0_0", ArcLabel.FOLLOWS) == ["e_0"]
    assert graph().ways_from("w_0") == graph().ways_into("e_0") == [EAST]


def test_a_lane_enters_a_conflict_region_which_clears_into_a_post_conflict_region_that_leads_to_a_lane():
    (region,) = graph().regions.values()
    assert graph().successors("w_0", ArcLabel.ENTERS) == [region.id]
    assert graph().successors(region.id, ArcLabel.CLEARS) == [region.post.id]
    assert graph().successors(region.post.id, ArcLabel.LEADS_TO) == ["e_0"]
    assert graph().successors("e_0", ArcLabel.ENTERS) == ()


WHOLE = ("w_0", ":j_0_0", "e_0")


@pytest.mark.parametrize("lanes", [WHOLE, ("w_1", *WHOLE), ("w_0", "e_0"), (":j_0_0", "e_0"), ("w_0", ":j_0_0")])
def test_a_walk_along_lanes_passes_their_connection_once_with_its_regions(lanes):
    world = graph()
    assert list(walk(world, lanes)) == [(EAST, tuple(world.regions.values()))]


@pytest.mark.parametrize("lanes", [(), ("w_0",), ("w_0", "w_1"), ("e_0",), ("s_0", "e_0")])
def test_a_walk_that_passes_no_junction_finds_nothing(lanes):
    assert list(walk(graph(), lanes)) == []


@pytest.mark.parametrize("label", [ArcLabel.ENTERS, ArcLabel.CLEARS, ArcLabel.LEADS_TO])
def test_without_an_arc_the_region_behind_it_is_not_found(label):
    world = graph()
    (arc,) = (arc for arc in world.arcs if arc.label is label)
    cut = replace(world, arcs=tuple(one for one in world.arcs if one is not arc))
    assert list(walk(cut, WHOLE)) == [(EAST, ())]


@pytest.mark.parametrize("source", ["w_0", ":j_0_0"])
def test_where_no_lane_follows_the_walk_passes_nothing(source):
    world = graph()
    cut = replace(world, arcs=tuple(one for one in world.arcs if (one.source, one.label) != (source, ArcLabel.FOLLOWS)))
    assert list(walk(cut, WHOLE)) == []


def test_a_region_that_leads_elsewhere_is_not_on_the_way():
    turn = connection("w_0->n_0", [(-8, 0), (1, 0), (1, 8)], 2)
    place = junction(EAST, NORTH, turn, foes=[(0, 1), (2, 1)])
    found = conflict_regions([EAST, turn], place)
    connections = {one.id: one for one in place.connections}
    regions = {region.id: region for on_one in found.values() for region in on_one}
    world = replace(graph(), connections=connections, regions=regions, arcs=arcs_of(connections, regions.values()))
    assert list(walk(world, ("w_0", ":j_2_0", "n_0"))) == [(turn, found[turn.id])]
    assert list(walk(world, WHOLE)) == [(EAST, found[EAST.id])]


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
