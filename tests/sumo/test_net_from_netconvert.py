"""Networks as netconvert makes them, compared with what sumolib and SUMO say of them."""

import itertools

import libsumo
import numpy as np
import pytest
import sumolib
from net_recipes import CROSS_NODES, converted, cross_edges

from sumo_reactive.driver.world.junction import Control, Junction, Turn
from sumo_reactive.driver.world.regions import SWEPT_WIDTH_M, ConflictKind
from sumo_reactive.sumo.net_reader import NetFile, read_net

SIDEWALKS = ("--sidewalks.guess", "--sidewalks.guess.min-speed", "1", "--sidewalks.guess.max-speed", "20")
PEDESTRIANS = (*SIDEWALKS, "--crossings.guess", "--crossings.guess.speed-threshold", "20")
KINDS = ("priority", "right_before_left", "allway_stop", "priority_stop", "traffic_light", "zipper", "unregulated")


def crossroads(tmp_path, kind="priority", lanes=1, *options) -> NetFile:
    nodes = CROSS_NODES.format(kind=kind)
    return read_net(converted(tmp_path, nodes, cross_edges(lanes), "--no-turnarounds", *options))


def by_id(junction: Junction):
    return {connection.id: connection for connection in junction.connections}


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("options", [(), PEDESTRIANS, ("--lefthand",)])
def test_indices_and_right_of_way_agree_with_sumolib(tmp_path, kind, options):
    net = crossroads(tmp_path, kind, 2, *options)
    node = sumolib.net.readNet(str(net.path), withInternal=True, withPedestrianConnections=True).getNode("c")
    junction = net.junction("c")
    inside = node.getInternal()
    assert [connection.parts[-1] for connection in junction.connections][: len(inside)] == inside
    links = {node.getLinkIndex(link): link for link in links_into(node)}
    for i, j in itertools.product(range(len(inside)), repeat=2):
        assert junction.connections[i].id == named(links[i])
        if kind != "unregulated":
            assert junction.right_of_way.in_conflict(i, j) == node.areFoes(i, j)
            assert junction.right_of_way.must_yield(i, j) == node.forbids(links[j], links[i])


def links_into(node):
    """Yield sumolib's connections that lead into a node from outside or from a walking area."""
    for edge in node.getIncoming():
        for lane in edge.getLanes():
            yield from lane.getOutgoing()


def named(link) -> str:
    """Return the id of one of sumolib's connections."""
    ends = link.getFromLane().getID(), link.getToLane().getID()
    return ends[1] if ends[0].startswith(":") else "->".join(ends)


def test_crossings_are_connections_and_ways_onto_walking_areas_are_not(tmp_path):
    junction = crossroads(tmp_path, "priority", 1, *PEDESTRIANS).junction("c")
    crossings = [connection for connection in junction.connections if connection.is_crossing]
    assert len(crossings) == 4
    for crossing in crossings:
        assert crossing.id == crossing.parts[0]
        assert "_w" in crossing.from_lane
        assert "_w" in crossing.to_lane
        assert crossing.width == 4.0


def test_a_crossing_on_the_way_is_a_conflict_region_without_vehicle_approaches(tmp_path):
    graph = crossroads(tmp_path, "priority", 1, *PEDESTRIANS).build(["wc", "ce"])
    others = {region.other_id for region in graph.regions.values()}
    crossed = [other for other in others if graph.connections[other].is_crossing]
    assert crossed
    assert all(graph.approaches[other] == () for other in crossed)


def test_sumo_lists_the_same_links(tmp_path):
    net = crossroads(tmp_path, "priority", 2)
    libsumo.start(["sumo", "-n", str(net.path), "--no-step-log"])
    try:
        for connection in net.junction("c").connections:
            links = {link[4]: link[0] for link in libsumo.lane.getLinks(connection.from_lane)}
            assert links[connection.parts[0]] == connection.to_lane
            foes = set(libsumo.lane.getInternalFoes(connection.parts[-1]))
            row = net.junction("c").right_of_way.conflicts[connection.index]
            assert {net.junction("c").connections[j].parts[-1] for j in np.flatnonzero(row)} <= foes
    finally:
        libsumo.close()


def test_two_straight_lanes_that_cross_at_right_angles_share_a_stretch_as_long_as_a_body_is_wide(tmp_path):
    graph = crossroads(tmp_path).build(["wc", "ce"])
    region = next(r for r in graph.regions_on(graph.connections["wc_0->ce_0"]) if r.other_id == "nc_0->cs_0")
    own = graph.connections[region.own_id]
    # the side road's lane towards the south runs at x = -1.6
    middle = -1.6 - own.path.points[0, 0]
    assert region.kind is ConflictKind.CROSSING
    assert (region.own.start, region.own.end) == pytest.approx(
        (middle - SWEPT_WIDTH_M / 2, middle + SWEPT_WIDTH_M / 2), abs=0.02
    )


def test_a_minor_road_yields_to_the_priority_road(tmp_path):
    junction = crossroads(tmp_path).junction("c")
    ways = by_id(junction)
    side, main = ways["nc_0->cs_0"], ways["wc_0->ce_0"]
    assert (side.control, main.control) == (Control.MINOR, Control.MAJOR)
    assert junction.right_of_way.must_yield(side.index, main.index)
    assert not junction.right_of_way.must_yield(main.index, side.index)


def test_a_left_turn_waits_for_oncoming_traffic_before_it_crosses_its_way(tmp_path):
    graph = crossroads(tmp_path).build(["wc", "cn"])
    left = graph.connections["wc_0->cn_0"]
    oncoming = next(r for r in graph.regions_on(left) if r.other_id == "ec_0->cw_0")
    assert left.turn is Turn.LEFT
    assert len(left.parts) == 2
    assert left.wait_at is not None
    assert left.wait_at <= oncoming.own.end
    assert graph.junctions["c"].right_of_way.must_yield(left.index, graph.connections[oncoming.other_id].index)


def test_in_left_hand_traffic_it_is_the_right_turn_that_waits_and_lane_0_lies_left(tmp_path):
    graph = crossroads(tmp_path, "priority", 2, "--lefthand").build(["wc", "cs"])
    right = next(c for c in graph.ways_from("wc_1") if c.to_lane.startswith("cs"))
    assert graph.left_hand
    assert right.turn is Turn.RIGHT
    assert right.wait_at is not None
    outer, inner = graph.edge_lanes["wc"]
    assert outer.spine.project(*inner.spine.at(50.0))[1] < 0.0
    assert graph.neighbours("wc_0") == (None, inner)


def test_roads_of_both_directions_share_a_carriageway(tmp_path):
    assert crossroads(tmp_path, "priority", 2).build(["wc", "ce"]).opposite == {"wc": "cw", "ce": "ec"}


def test_the_two_directions_of_a_spread_motorway_do_not_share_a_carriageway(tmp_path):
    nodes = '<nodes><node id="a" x="0" y="0"/><node id="b" x="500" y="0"/></nodes>'
    far = '<edge id="ba" from="b" to="a" shape="500,30 0,30"/>'
    net = converted(tmp_path, nodes, f'<edges><edge id="ab" from="a" to="b"/>{far}</edges>', "--no-turnarounds=false")
    assert read_net(net).build(["ab"]).opposite == {}


def test_lights_name_their_signal_and_index(tmp_path):
    connections = crossroads(tmp_path, "traffic_light").junction("c").connections
    assert all(connection.control is Control.LIGHT for connection in connections)
    assert sorted(connection.light.index for connection in connections) == list(range(len(connections)))


def test_lanes_that_merge_and_diverge_are_regions_of_their_kind(tmp_path):
    graph = crossroads(tmp_path).build(["wc", "ce"])
    kinds = {region.other_id: region.kind for region in graph.regions_on(graph.connections["wc_0->ce_0"])}
    assert kinds["wc_0->cn_0"] is ConflictKind.DIVERGING
    assert kinds["sc_0->ce_0"] is ConflictKind.MERGING
    assert kinds["nc_0->cs_0"] is ConflictKind.CROSSING


def test_straight_lanes_side_by_side_do_not_conflict(tmp_path):
    graph = crossroads(tmp_path, "priority", 2).build(["wc", "ce"])
    assert all(region.other_id != "wc_1->ce_1" for region in graph.regions_on(graph.connections["wc_0->ce_0"]))


def test_every_shared_region_knows_the_lanes_that_lead_to_it(tmp_path):
    graph = crossroads(tmp_path, "priority", 2).build(["wc", "ce"])
    for region in graph.regions.values():
        nearest = graph.approaches[region.other_id][0]
        other = graph.connections[region.other_id]
        assert nearest.lane_id == other.from_lane
        assert nearest.distance == pytest.approx(graph.lanes[other.from_lane].spine.length)
        assert nearest.edges[-1] == other.to_lane.rpartition("_")[0]


def test_every_arc_joins_known_nodes(tmp_path):
    graph = crossroads(tmp_path, "priority", 2).build(["wc", "ce"])
    nodes = {*graph.lanes, *graph.regions, *(region.post.id for region in graph.regions.values())}
    for arc in graph.arcs:
        assert {arc.source, arc.target} <= nodes
