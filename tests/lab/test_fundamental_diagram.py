"""Flow, density and speed of groups of edges, and vehicles over a cut, of counts made by hand."""

import pytest

from sumo_reactive.errors import ScenarioError
from sumo_reactive.lab.fundamental_diagram import CountedEdges, diagram_of
from sumo_reactive.lab.metric_names import metric_of
from sumo_reactive.sumo.edge_counts import EdgeTime, Road

ROADS = {
    "a": Road("a", "main", {"a_0": 400.0, "a_1": 400.0}),
    "b": Road("b", "main", {"b_0": 200.0}),
    "c": Road("c", "side", {"c_0": 100.0}),
}
TIMES = [
    EdgeTime(0.0, 60.0, "a", 120.0, 10.0),
    EdgeTime(0.0, 60.0, "b", 30.0, 5.0),
    EdgeTime(60.0, 120.0, "b", 30.0, 5.0),
]


def test_flow_density_and_speed_are_those_of_edie_per_lane():
    point = diagram_of(TIMES, {"main": [ROADS["a"], ROADS["b"]]}, 120.0)[0]
    assert (point.edges, point.begin_s, point.end_s) == ("main", 0.0, 60.0)
    assert point.flow_per_h == pytest.approx(3600.0 * (1200.0 + 150.0) / (60.0 * 1000.0))
    assert point.density_per_km == pytest.approx(1000.0 * 150.0 / (60.0 * 1000.0))
    assert point.speed_m_s == pytest.approx(9.0)
    assert point.flow_per_h == pytest.approx(3.6 * point.density_per_km * point.speed_m_s)


def test_every_group_has_a_point_for_each_interval_and_nobody_has_no_speed():
    points = diagram_of(TIMES, CountedEdges().groups_in(ROADS), 120.0)
    assert [(one.edges, one.begin_s) for one in points] == [("main", 0.0), ("main", 60.0), ("side", 0.0), ("side", 60.0)]
    assert points[-1][3:] == (0.0, 0.0, None)


def test_the_last_interval_ends_with_the_run():
    whole, cut_short = (diagram_of(TIMES, {"main": [ROADS["b"]]}, until)[1] for until in (120.0, 90.0))
    assert (whole.end_s, cut_short.end_s) == (120.0, 90.0)
    assert cut_short.flow_per_h == pytest.approx(2.0 * whole.flow_per_h)


def test_edges_are_grouped_by_the_class_of_their_road_unless_the_groups_are_named():
    assert {name: [road.edge_id for road in roads] for name, roads in CountedEdges().groups_in(ROADS).items()} == {
        "main": ["a", "b"], "side": ["c"],
    }  # fmt: skip
    named = CountedEdges(groups=(("mine", ("c", "a")),)).groups_in(ROADS)
    assert {name: [road.edge_id for road in roads] for name, roads in named.items()} == {"mine": ["c", "a"]}


def test_a_cut_adds_up_the_lanes_of_its_edges_to_vehicles_an_hour():
    counted = CountedEdges(cuts=(("north", ("a", "c")), ("south", ("b",))))
    assert counted.lanes_of_cuts(ROADS) == {"a_0": 400.0, "a_1": 400.0, "c_0": 100.0, "b_0": 200.0}
    found = counted.throughput({"a_0": 3, "a_1": 2, "c_0": 1, "other_0": 9}, ROADS, 120.0)
    assert found == {"cut_north_per_h": 180.0, "cut_south_per_h": 0.0}
    assert metric_of("cut_north_per_h").title == "throughput of 'north' (1/h)"


def test_an_interval_of_nothing_is_refused():
    with pytest.raises(ScenarioError, match="an interval of 0 s"):
        CountedEdges(0.0)
