"""What lies ahead is found by walking W: an arc that is not there hides what is behind it (F&L 1991, §2)."""

from dataclasses import replace

import pytest
from helpers.situations import before

from sumo_reactive.driver.ablation import Mechanism
from sumo_reactive.driver.nouns.decision import Reason
from sumo_reactive.driver.parameters import Parameters
from sumo_reactive.driver.view.ahead import passages_ahead
from sumo_reactive.driver.world.road_graph import ArcLabel

SOUTH_WEST, WEST_EAST = ("from_south", "to_west"), ("from_west", "to_east")


@pytest.fixture(scope="module")
def ego():
    """The ego at the line of the minor road."""
    return before("four_way_priority", SOUTH_WEST, 1.0, 0.0)


def from_west(ego):
    return ego.other("west", "from_west_0", -26.0, 13.0, WEST_EAST)


def without(ego, label, keeps=lambda arc: False):
    """The ego in a world whose arcs of a label are gone, but those that are to be kept."""
    arcs = tuple(arc for arc in ego.graph.arcs if arc.label is not label or keeps(arc))
    return replace(ego, graph=replace(ego.graph, arcs=arcs))


def test_each_passage_of_the_plan_is_found_with_its_regions_in_order(ego):
    ((number, connection, conflicts),) = passages_ahead(ego.graph, ego.plan, ego.limits, ego.seen().passages)
    assert (number, connection) == (0, ego.connection)
    starts = [conflict.region.own.start for conflict in conflicts]
    assert starts == sorted(starts) and len(starts) > 3


def test_only_what_is_in_sight_is_told(ego):
    assert passages_ahead(ego.graph, ego.plan, ego.limits, ()) == ()


@pytest.mark.parametrize("label", [ArcLabel.ENTERS, ArcLabel.CLEARS, ArcLabel.LEADS_TO])
def test_without_the_arcs_to_its_regions_the_minor_road_yields_to_nobody(ego, label):
    assert ego.stop(from_west(ego)).reason is Reason.YIELD_TO
    blind = without(ego, label)
    assert blind.stop(from_west(ego)) is None
    assert blind.seen(from_west(ego)).foes == ()


def test_without_the_arc_to_one_region_those_behind_others_are_found_still(ego):
    (_, _, known), *_ = passages_ahead(ego.graph, ego.plan, ego.limits, (0,))
    first = known[0].region
    blind = without(ego, ArcLabel.ENTERS, lambda arc: arc.target != first.id)
    (_, _, found), *_ = passages_ahead(blind.graph, blind.plan, blind.limits, (0,))
    assert [one.region.id for one in found] == [one.region.id for one in known[1:]]


def test_where_no_lane_follows_no_passage_is_found(ego):
    assert passages_ahead(without(ego, ArcLabel.FOLLOWS).graph, ego.plan, ego.limits, (0,)) == ()


def test_a_driver_without_the_graph_finds_nothing_ahead(ego):
    without_graph = replace(ego, limits=replace(ego.limits, parameters=Parameters(without=Mechanism.GRAPH)))
    assert passages_ahead(ego.graph, ego.plan, without_graph.limits, (0,)) == ()
    assert without_graph.stop(from_west(ego)) is None


@pytest.mark.parametrize("moved", [0.0, 3.0])
def test_who_waits_for_the_ego_in_its_corridor_is_told_wherever_it_leads(moved):
    ego = before("signalised_left_turns", ("from_north", "to_south"), 12.0, 6.0)
    turn = ego.graph.connections["from_south_1->to_west_1"]
    drawn = replace(turn, wait_at=turn.wait_at + moved)
    graph = replace(ego.graph, connections={**ego.graph.connections, turn.id: drawn})
    ((_, _, conflicts),) = passages_ahead(graph, ego.plan, ego.limits, (0,))
    (found,) = [conflict for conflict in conflicts if conflict.other.id == turn.id]
    assert found.is_yielded_to and found.waits_in_the_way is (moved > 0.0)
