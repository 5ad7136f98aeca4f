"""Kinds of following: leaders who stop, brake hard, cut in, ride bicycles, serve bus stops, stand across a junction."""

from __future__ import annotations

import pytest
from kinds import Net, car, cross, driven, edge, element, link, node, road, sort, standing, stop, stream

TWO_WAY = Net(node("a", 0, 0) + node("b", 300, 0), edge("ab") + edge("ba"))
SMOOTH = '<lanechange.duration value="2"/>'
"""SUMO's cars change lanes within 2 s instead of at once."""


def test_a_leader_that_stops_and_goes_is_followed(tmp_path):
    stops = "".join(stop("ab_0", at, duration=2) for at in (40, 70, 110, 160, 200))
    run = driven(tmp_path, road(300), car("ego", "ab", 1.5), car("x", "ab", stops=stops))
    assert run.complaints() == []


@pytest.mark.parametrize(("onward", "lane", "at"), [((200,), "bc_0", 2.5), ((1, 200), "cd_0", 1.5)])
def test_who_has_left_the_last_road_but_for_its_rear_is_still_followed(tmp_path, onward, lane, at):
    way = "ab bc cd"[: 2 + 3 * len(onward)]
    leaves = car("x", way, 0, stop(lane, at, duration=25))
    run = driven(tmp_path, road(200, *onward), leaves, car("ego", "ab", 2), car("behind", way, 5))
    assert run.complaints() == []


@pytest.mark.parametrize("headway", [1.2, 1.6, 2.5])
def test_a_leader_that_brakes_as_in_an_emergency_is_not_touched(tmp_path, headway):
    hard = sort("hard", decel=9, emergencyDecel=9, sigma=0)
    leader = car("x", "ab", 0, stop("ab_0", 180, duration=4), type="hard")
    run = driven(tmp_path, road(300), hard, leader, car("ego", "ab", headway), car("behind", "ab", headway + 2.5))
    assert run.complaints() == []


@pytest.mark.parametrize("early", [0.4, 0.8, 1.2])
def test_somebody_who_cuts_in_from_the_next_lane_is_let_in(tmp_path, early):
    rude = sort("rude", lcAssertive=5, lcStrategic=0.5)
    nodes = node("a", 0, 0) + node("b", 150, 0) + node("c", 300, 0) + node("s", 150, -80)
    rules = link("ab bc", "00") + link("ab bc", "11") + link("ab bs", "00")
    net = Net(nodes, edge("ab", numLanes=2) + edge("bc", numLanes=2) + edge("bs"), rules)
    other = car("x", "ab bs", 2 - early, type="rude", departLane=1)
    run = driven(tmp_path, net, rude, other, car("ego", "ab bc", 2, departLane=0), options=SMOOTH)
    assert run.complaints() == []


@pytest.mark.parametrize("net", [road(300), TWO_WAY], ids=["one lane", "two ways"])
def test_a_bicycle_in_the_lane_is_followed_or_passed(tmp_path, net):
    bike = car("bike", "ab", 0, type="bike", departPos=60)
    run = driven(tmp_path, net, bike, car("ego", "ab", 3), until=90)
    assert run.complaints() == []


def test_a_bicycle_is_not_passed_against_a_dense_oncoming_stream(tmp_path):
    oncoming = stream("on", "ba", [2.5 * i for i in range(24)])
    run = driven(tmp_path, TWO_WAY, car("bike", "ab", 0, type="bike", departPos=60), car("ego", "ab", 3), oncoming, until=90)
    assert run.complaints() == []


@pytest.mark.parametrize("gaps", [True, False])
def test_a_bus_at_its_stop_on_the_lane_is_passed_in_a_gap_or_waited_for(tmp_path, gaps):
    halt = element("busStop", id="halt", lane="ab_0", startPos=140, endPos=160)
    bus = car("bus", "ab", 0, element("stop", busStop="halt", duration=15), type="bus", departPos=110, departSpeed=5)
    oncoming = stream("on", "ba", [0, 2, 25, 27] if gaps else [2.0 * i for i in range(20)])
    run = driven(tmp_path, TWO_WAY, bus, car("ego", "ab", 2), oncoming, extra=halt)
    assert run.complaints() == []


@pytest.mark.parametrize("route", ["sc cn", "sc cw"])
def test_a_queue_that_leaves_the_junction_free_is_crossed(tmp_path, route):
    queue = standing("jam", "ce", "ce_0", 8, 30) + stream("q", "wc ce", [0, 1.5, 3])
    run = driven(tmp_path, cross(), car("ego", route, 4), queue)
    assert run.complaints() == []


def test_a_queue_that_stands_in_the_junction_is_waited_for(tmp_path):
    net = cross()
    rules = link("wc ce", keepClear="false") + link("sc cn", keepClear="false")
    queue = standing("jam", "ce", "ce_0", 8, 20) + stream("q", "wc ce", [0, 1.5, 3])
    run = driven(tmp_path, Net(net.nodes, net.edges, rules), car("ego", "sc cn", 4), queue)
    assert run.complaints() == []


@pytest.mark.parametrize("declared", [500, 120])
def test_who_drives_on_a_lane_of_another_length_than_drawn_is_followed_as_fast_as_he_moves(tmp_path, declared):
    """SUMO counts places and speeds on it in metres of the declared length."""
    net = Net(node("a", 0, 0) + node("b", 200, 0) + node("c", 260, 0), edge("ab", length=declared) + edge("bc"))
    slow = sort("slow", maxSpeed=8, sigma=0)
    cars = car("x", "ab bc", type="slow"), car("ego", "ab bc", 6), car("y", "ab bc", 14)
    run = driven(tmp_path, net, *cars, extra=slow, until=150)
    assert run.complaints(slower=2.0) == []
