"""Kinds of merging: lanes that end, lanes that the route needs, ramps, weaving."""

from __future__ import annotations

from dataclasses import replace

import pytest
from kinds import Net, car, driven, edge, link, node, situation, stream

from sumo_reactive.lab.ego_rule import EgoRule
from sumo_reactive.lab.fleet import run_fleet


@pytest.mark.parametrize("ahead", [12, 6, 0, -6])
def test_a_lane_that_ends_is_left_in_time(tmp_path, ahead):
    nodes = node("a", 0, 0) + node("b", 210, 0) + node("d", 360, 0)
    net = Net(nodes, edge("ab", numLanes=2) + edge("bd"), link("ab bd", "10"))
    beside = "".join(car(f"b{i}", "ab bd", departLane=1, departPos=60 + ahead - 22 * i) for i in range(-1, 3))
    run = driven(tmp_path, net, car("ego", "ab bd", departLane=0, departPos=60), beside)
    assert run.complaints() == []


@pytest.mark.parametrize("headway", [1.6, 2.0, 3.0])
def test_a_change_that_the_route_needs_is_made_in_dense_traffic_on_a_short_edge(tmp_path, headway):
    nodes = node("a", 0, 0) + node("b", 180, 0) + node("d", 280, 0) + node("n", 180, 100)
    rules = link("ab bd", "00") + link("ab bn", "11")
    net = Net(nodes, edge("ab", numLanes=2) + edge("bd", numLanes=1) + edge("bn", numLanes=2), rules)
    dense = stream("l", "ab bn", [headway * i for i in range(18)], departLane=1, type="calm")
    run = driven(tmp_path, net, car("ego", "ab bn", 8, departLane=0, departPos=60), dense, until=90)
    assert run.complaints() == []


@pytest.mark.parametrize("headway", [1.8, 2.2, 3.0])
def test_an_on_ramp_joins_a_fast_stream(tmp_path, headway):
    nodes = node("a", 0, 0) + node("b", 300, 0) + node("d", 500, 0) + node("e", 700, 0) + node("r", 100, -60)
    edges = edge("ab", speed=25) + edge("rb", speed=20) + edge("bd", numLanes=2, speed=25) + edge("de", speed=25)
    rules = link("ab bd", "01") + link("rb bd", "00") + link("bd de", "10")
    fast = stream("f", "ab bd de", [headway * i for i in range(16)])
    run = driven(tmp_path, Net(nodes, edges, rules), car("ego", "rb bd de", 6, departSpeed=15), fast)
    assert run.complaints() == []


@pytest.mark.parametrize("depart", [5.5, 6.0, 7.0, 8.0])
@pytest.mark.parametrize("headway", [2.2, 3.0])
def test_a_ramp_lane_that_ends_in_a_merge_is_left_as_soon_as_there_is_a_gap(tmp_path, headway, depart):
    nodes = node("a", 0, 0) + node("b", 300, 0) + node("d", 550, 0) + node("e", 750, 0) + node("r", 100, -60)
    edges = edge("ab", speed=25) + edge("rb", speed=20) + edge("bd", numLanes=2, speed=25) + edge("de", speed=25)
    rules = link("ab bd", "01") + link("rb bd", "00") + link("bd de", "00") + link("bd de", "10")
    fast = stream("f", "ab bd de", [headway * i for i in range(24)], departLane=0)
    run = driven(tmp_path, Net(nodes, edges, rules), car("ego", "rb bd de", depart, departSpeed=15), fast)
    assert run.complaints(slower=1.2) == []


def slow_ramp(length: float, speed: float, ends: str = "") -> Net:
    """Return a fast road "ab bd de" that a ramp "rb" joins, driven at `speed` (m/s), its own lane `length` m long."""
    end = 300 + length
    nodes = node("a", -300, 0) + node("b", 300, 0) + node("d", end, 0) + node("e", end + 400, 0) + node("r", 150, -60)
    edges = edge("ab", speed=28) + edge("rb", speed=speed) + edge("bd", numLanes=2, speed=28) + edge("de", speed=28)
    return Net(nodes, edges, link("ab bd", "01") + link("rb bd", "00") + link("bd de", "10") + ends)


@pytest.mark.parametrize("depart", [12.0, 12.7, 13.4])
@pytest.mark.parametrize("headway", [2.0, 2.5, 3.0])
@pytest.mark.parametrize("ends", ["", link("bd de", "00")])
def test_somebody_in_a_dense_fast_stream_lets_the_ego_in_from_a_slow_ramp(tmp_path, ends, headway, depart):
    fast = stream("f", "ab bd de", [headway * i for i in range(30)])
    run = driven(tmp_path, slow_ramp(150, 13, ends), car("ego", "rb bd de", depart), fast, until=150.0)
    assert run.complaints(slower=1.2) == []
    assert run.ego.duration < 40.0  # nobody need wait until all have passed


@pytest.mark.parametrize("ends", ["", link("bd de", "00")])
def test_egos_let_each_other_in(tmp_path, ends):
    fast = stream("f", "ab bd de", [2.5 * k for k in range(24)])
    ramp = stream("r", "rb bd de", [10, 25, 40])
    scenario = situation(tmp_path, slow_ramp(150, 13, ends), fast, ramp, until=200.0)
    fleet = run_fleet(replace(scenario, ego=None), EgoRule(share=1.0))
    assert len(fleet.results) == 27
    assert {result.verdict for result in fleet.results} == {"arrived without a violation"}
    assert max(result.duration_s for result in fleet.results if result.ego.startswith("r")) < 50.0


@pytest.mark.parametrize("depart", [12.0, 13.0])
def test_a_body_that_hardly_reaches_over_the_lane_beside_stops_nobody_there(tmp_path, depart):
    fast = stream("f", "ab bd de", [1.7 * i for i in range(30)])
    run = driven(tmp_path, slow_ramp(90, 8), car("ego", "rb bd de", depart), fast, until=150.0)
    assert run.complaints() == []


@pytest.mark.parametrize("late", [-1.0, 0.0, 1.0])
@pytest.mark.parametrize("length", [80, 150])
def test_two_cars_exchange_their_lanes(tmp_path, late, length):
    end = 150 + length
    nodes = node("a", 0, -50) + node("b", 0, 50) + node("c", 150, 0) + node("d", end, 0)
    nodes += node("e", end + 120, 50) + node("f", end + 120, -50)
    edges = edge("ac") + edge("bc") + edge("cd", numLanes=2) + edge("de") + edge("df")
    rules = link("ac cd", "00") + link("bc cd", "01") + link("cd df", "00") + link("cd de", "10")
    weaving = stream("w", "bc cd df", [2 + late, 4 + late])
    run = driven(tmp_path, Net(nodes, edges, rules), car("ego", "ac cd de", 2), weaving)
    assert run.complaints() == []


@pytest.mark.parametrize("ahead", [0.0, 0.6, 1.2, 1.8])
def test_who_comes_beside_an_ego_that_swings_out_to_turn_round_is_let_past(tmp_path, ahead):
    nodes = node("a", 0, 0) + node("b", 120, 0) + node("c", 240, 0)
    ways = "".join(edge(ends, numLanes=2) for ends in ("ab", "ba", "bc"))
    links = link("ab bc") + link("ab bc", "11") + link("ab ba", "11")
    net = Net(nodes, ways, links, options=())
    beside = stream("x", "ab bc", [6.0 - ahead + 2.0 * k for k in range(8)], departLane=0)
    run = driven(tmp_path, net, car("ego", "ab ba", 3, departLane=1), beside)
    assert run.complaints(slower=2.5) == []  # the stream lasts as long as SUMO's own driver takes, which turns on the spot


@pytest.mark.parametrize("behind", [0, 5, 10])
def test_who_is_alongside_is_not_cut_off_where_the_change_is_due_on_a_later_road(tmp_path, behind):
    nodes = node("a", 0, 0) + node("b", 150, 0) + node("c", 300, 0) + node("d", 400, 0)
    net = Net(nodes, edge("ab", numLanes=2) + edge("bc", numLanes=2) + edge("cd"), link("bc cd", "10"))
    beside = car("x", "ab bc cd", departLane=1, departPos=60 - behind, type="calm")
    run = driven(tmp_path, net, car("ego", "ab bc cd", departLane=0, departPos=60), beside)
    assert run.complaints() == []


@pytest.mark.parametrize("behind", [-16, -8, 0, 6])
@pytest.mark.parametrize("length", [170, 200, 230])
def test_two_changes_in_a_row_to_a_turn_force_nobody_on_either_lane(tmp_path, length, behind):
    nodes = node("a", 0, 0) + node("b", length, 0) + node("d", length + 150, 0) + node("s", length, -100)
    rules = link("ab bs", "00") + link("ab bd", "10") + link("ab bd", "21")
    net = Net(nodes, edge("ab", numLanes=3) + edge("bd", numLanes=2) + edge("bs"), rules)
    beside = "".join(car(f"m{i}", "ab bd", departLane=1, departPos=50 - 14 * i, type="calm") for i in range(-1, 4))
    places = [place for i in range(-3, 3) if (place := 60 - behind - 25 * i) < length - 5]
    turning = "".join(car(f"r{i}", "ab bs", departLane=0, departPos=at, type="calm") for i, at in enumerate(places))
    turning += stream("q", "ab bs", [1 + 1.8 * i for i in range(10)], departLane=0, type="calm")
    run = driven(tmp_path, net, car("ego", "ab bs", departLane=2, departPos=60), beside + turning)
    assert run.complaints() == []


@pytest.mark.parametrize("room", [25, 32, 40])
@pytest.mark.parametrize("depart", [0, 2, 4, 6])
def test_a_change_at_once_behind_a_junction_is_met_with_the_way_to_wait_for_a_gap(tmp_path, room, depart):
    """The road behind is `room` m long, and others come onto its other lane from another side."""
    nodes = node("w", -150, 0) + node("n", 0, 120) + node("a", 0, 0) + node("b", room, 0)
    nodes += node("e", room + 150, 0) + node("s", room, -120)
    edges = edge("wa") + edge("na", priority=1) + edge("ab", numLanes=2) + edge("be") + edge("bs")
    links = link("wa ab") + link("na ab", "01") + link("ab be", "10") + link("ab bs")
    beside = stream("n", "na ab be", [2, 4, 6, 8, 12])
    run = driven(tmp_path, Net(nodes, edges, links), car("ego", "wa ab be", depart), beside, until=90)
    assert run.complaints(slower=1.7) == []
    assert run.result.figures["emergencies"] == 0
