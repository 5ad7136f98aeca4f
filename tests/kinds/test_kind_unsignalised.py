"""Kinds of junctions without lights: signs, the right before left, rings, rails, crossings for walkers and cyclists."""

from __future__ import annotations

import math
from itertools import pairwise

import pytest
from kinds import ARMS, Net, car, cross, driven, edge, element, fails, link, node, sort, stop, stream

FOUR = ("wc ce", "sc cn", "ec cw", "nc cs")
"""Straight on from each side."""


def others(*routes: str) -> str:
    """Return a car on each route, simultaneous with the ego."""
    return "".join(car(f"c{i}", route) for i, route in enumerate(routes))


@pytest.mark.parametrize("route", ["sc cn", "sc cw", "sc ce"])
def test_from_a_minor_road_the_ego_takes_a_gap_of_a_stream(tmp_path, route):
    both = stream("e", "ec cw", [0, 2.2, 4.5, 9, 13, 20, 21.5]) + stream("w", "wc ce", [0.8, 3, 5.5, 8, 15, 21, 23])
    assert driven(tmp_path, cross(), car("ego", route), both).complaints() == []


@pytest.mark.parametrize("turn", ["ce", "cn", "cs"])
def test_four_cars_that_each_have_one_on_the_right_resolve_it(tmp_path, turn):
    assert driven(tmp_path, cross("right_before_left"), car("ego", f"wc {turn}"), others(*FOUR[1:])).complaints() == []


@pytest.mark.parametrize("turn", ["ce", "cn", "cs"])
def test_four_cars_at_an_all_way_stop_take_turns(tmp_path, turn):
    run = driven(tmp_path, cross("allway_stop"), car("ego", f"wc {turn}"), others(*FOUR[1:]))
    assert run.complaints() == []
    assert run.ego.slowest("wc") < 0.1


@pytest.mark.parametrize("turn", ["cn", "cw"])
@pytest.mark.parametrize("until", [12, 15, 18, 70])
def test_who_has_halted_before_the_junction_is_not_waited_for_nor_met_when_he_leaves(tmp_path, turn, until):
    halted = car("x", "ec cw", type="bus", stops=stop("ec_0", 75, until=until))
    run = driven(tmp_path, cross("priority_stop"), car("ego", f"sc {turn}", 3), halted, until=120)
    assert run.complaints(slower=2.0) == []


def test_a_stop_sign_asks_for_a_full_stop_before_the_gap(tmp_path):
    net = cross("priority_stop")
    run = driven(tmp_path, net, car("ego", "sc cn"), stream("e", "ec cw", [2, 12]), stream("w", "wc ce", [3, 4.5, 14]))
    assert run.complaints() == []
    assert run.ego.slowest("sc") < 0.1


def ring() -> Net:
    """Return a roundabout of two lanes with a radius of 22 m."""
    far = "".join(node(a, 100 * x, 100 * y) for a, (x, y) in ARMS.items())
    places = {"e": "E", "n": "N", "w": "W", "s": "S"}
    near = "".join(node(places[a], 22 * x, 22 * y, type="priority") for a, (x, y) in ARMS.items())
    arms = "".join(
        edge(ends, numLanes=2, priority=1) for a, inner in places.items() for ends in (f"{a}{inner}", f"{inner}{a}")
    )
    order, arcs = "ENWS", ""
    for i, start in enumerate(order):
        angles = [math.radians(90.0 * i + 9.0 * k) for k in range(11)]
        shape = " ".join(f"{22 * math.cos(t):.2f},{22 * math.sin(t):.2f}" for t in angles)
        arcs += edge(start + order[(i + 1) % 4], numLanes=2, priority=9, speed=8.3, shape=shape, spreadType="center")
    edges = " ".join(order[i] + order[(i + 1) % 4] for i in range(4))
    return Net(far + near, arms + arcs + element("roundabout", nodes=" ".join(order), edges=edges))


@pytest.mark.parametrize("route", ["sS SE Ee", "sS SE EN Nn", "sS SE EN NW Ww"])
def test_a_roundabout_of_two_lanes_is_entered_and_left(tmp_path, route):
    ringing = stream("w", "wW WS SE Ee", [0, 2.5, 5, 11], departLane="best") + stream("n", "nN NW WS SE EN Nn", [0, 3, 8])
    side = stream("s", "sS SE Ee", [0.5, 4], departLane=0) + stream("e", "eE EN NW Ww", [0, 3, 6, 9])
    run = driven(tmp_path, ring(), car("ego", route, 1.5, departLane="best"), ringing, side, until=80)
    assert run.complaints() == []


@pytest.mark.parametrize("late", [-0.6, 0.0, 0.6])
@pytest.mark.parametrize("lane", [0, 1])
def test_at_a_zipper_two_lanes_become_one(tmp_path, lane, late):
    nodes = node("a", 0, 0) + node("b", 120, 0, type="zipper") + node("d", 240, 0)
    net = Net(nodes, edge("ab", numLanes=2) + edge("bd"), link("ab bd", "00") + link("ab bd", "10"))
    beside = stream("b", "ab bd", [1 + late, 3, 5.5], departLane=1 - lane)
    run = driven(tmp_path, net, car("ego", "ab bd", 1, departLane=lane), beside, car("front", "ab bd", departLane=lane))
    assert run.complaints() == []


@pytest.mark.parametrize("late", [-0.6, 0.0, 0.6])
def test_at_a_zipper_who_is_nearer_to_his_line_goes_first_although_it_lies_farther_back(tmp_path, late):
    ground = "-24,1 -24,-4 -4,-5 -4,-8 1,-8 6,-4 6,1"
    nodes = node("w", -90, 0) + node("s", 0, -90) + node("c", 0, 0, type="zipper", shape=ground) + node("e", 120, 0)
    net = Net(nodes, edge("wc") + edge("sc") + edge("ce"), link("wc ce") + link("sc ce"))
    run = driven(tmp_path, net, car("ego", "sc ce", 0.6), stream("x", "wc ce", [1 + late, 7 + late]), until=60)
    assert run.complaints() == []
    assert min((b.speed - a.speed) / (b.time - a.time) for a, b in pairwise(run.ego.moments)) > -3.5


@pytest.mark.parametrize("route", ["wc ce", "wc cn"])
def test_where_nothing_is_ruled_the_ego_looks_out_itself(tmp_path, route):
    run = driven(tmp_path, cross("unregulated"), car("ego", route), others("sc cn", "ec cw"), car("n", "nc cs", 1.5))
    assert run.complaints() == []


def test_a_train_goes_first_at_a_rail_crossing(tmp_path):
    nodes = "".join(node(a, (90 if a in "we" else 400) * x, (90 if a in "we" else 400) * y) for a, (x, y) in ARMS.items())
    roads = "".join(edge(e) for e in ("wc", "ce", "ec", "cw"))
    rails = "".join(edge(e, allow="rail", speed=25) for e in ("nc", "cs"))
    rules = "".join(link(e) for e in ("wc ce", "ec cw", "nc cs"))
    net = Net(nodes + node("c", 0, 0, type="rail_crossing"), roads + rails, rules)
    train = car("train", "nc cs", 0, type="train")
    run = driven(tmp_path, net, car("ego", "wc ce", 8), train, car("other", "ec cw", 9), until=80)
    assert run.complaints() == []
    assert run.ego.slowest("wc") < 0.1


def walker(name: str, edges: str, depart: float, at: float = 0.0) -> str:
    """Return somebody who walks."""
    return element("person", element("walk", edges=edges), id=name, depart=depart, departPos=at)


def zebra(kind: str = "priority") -> Net:
    """Return a road with a crossing at b where pedestrians have priority, if a junction of that kind has any."""
    nodes = node("a", 0, 0) + node("b", 100, 0, type=kind) + node("d", 200, 0)
    edges = "".join(edge(e, sidewalkWidth=2) for e in ("ab", "bd", "db", "ba"))
    rules = link("ab bd", "11") + link("db ba", "11") + element("crossing", node="b", edges="ab ba", priority="true")
    return Net(nodes, edges, rules)


@pytest.mark.parametrize("depart", [0.0, 0.5, 1.0, 2.0])
def test_a_pedestrian_on_the_crossing_is_not_touched(tmp_path, depart):
    people = walker("p", "ab ba", depart, 90) + walker("q", "ba ab", depart + 1, 2)
    assert driven(tmp_path, zebra(), car("ego", "ab bd"), people).complaints() == []


@pytest.mark.parametrize("depart", [0.0, 0.5, 1.0])
def test_a_pedestrian_who_walks_onto_the_road_where_no_rule_makes_him_wait_is_let_over(tmp_path, depart):
    people = walker("p", "ab ba", depart, 90) + walker("q", "ba ab", depart + 1, 2)
    run = driven(tmp_path, zebra("unregulated"), car("ego", "ab bd"), people, step=0.5)
    assert run.complaints(slower=1.7) == []
    assert run.ego.slowest("ab") < 0.1


TOO_LATE = "he comes up to the crossing when the ego can no longer stop comfortably; SUMO's own driver brakes hard"


@pytest.mark.parametrize("depart", [0.7, 1.0, fails(2.0, because=TOO_LATE)])
def test_a_pedestrian_who_walks_up_to_the_crossing_is_let_over(tmp_path, depart):
    people = walker("p", "ab ba", depart, 90) + walker("q", "ba ab", depart + 1, 2)
    run = driven(tmp_path, zebra(), car("ego", "ab bd"), people)
    assert run.own.slowest("ab") < 0.1
    assert run.ego.slowest("ab") < 5.0


@pytest.mark.parametrize("turn", ["cs", "ce", "cn"])
def test_pedestrians_at_a_crossing_with_sidewalks_are_let_over(tmp_path, turn):
    net = cross("traffic_light", options=("--crossings.guess",), sidewalkWidth=2)
    walks = ("sc cn", "wc ce", "nc cs", "ec cw", "cw ec", "ce wc", "cn sc", "cs nc")
    people = "".join(walker(f"p{i}", walk, 36 + i, 60 if walk[1] == "c" else 20) for i, walk in enumerate(walks))
    run = driven(tmp_path, net, car("ego", f"wc {turn}", 41), people, car("on", "ec cw", 43), until=120)
    assert run.complaints() == []


TOO_SLOW = "it foresees the whole way to the turn at the turn's speed, so that a gap of 6 s is too short, and then stands"


@pytest.mark.parametrize("late", [5.0, fails(7.0, because=TOO_SLOW), 9.0, 11.0])
def test_a_right_turn_lets_cyclists_beside_it_go_straight_on(tmp_path, late):
    lanes = element("lane", index=0, allow="bicycle", width=1.6) + element("lane", index=1, disallow="pedestrian bicycle")
    nodes = "".join(node(a, x * 90, y * 90) for a, (x, y) in ARMS.items()) + node("c", 0, 0, type="priority")
    edges = "".join(edge(e, lanes, numLanes=2, priority=5 if a in "we" else 1) for a in ARMS for e in (f"{a}c", f"c{a}"))
    rules = "".join(link("wc ce", two) for two in ("00", "11")) + link("wc cs", "11")
    bikes = stream("b", "wc ce", [0, 1.5, 3], type="bike", departLane=0)
    run = driven(tmp_path, Net(nodes, edges, rules), car("ego", "wc cs", late, departLane=1), bikes)
    assert run.complaints() == []


def over_each_other() -> Net:
    """Return a road on whose last metres before b the oncoming lane lies, as on some imported maps."""
    nodes = node("a", 0, 0) + node("b", 100, 0, type="priority") + node("d", 160, 0) + node("e", 240, 0)
    near = edge("ab", shape="0,-1.6 85,-1.6 93,0.4 100,-1.6", spreadType="center")
    near += edge("ba", shape="100,1.6 95,1.0 86,1.2 78,5 0,5", spreadType="center")
    ways = "".join(link(ends) for ends in ("ab bd", "db ba", "bd de", "ed db"))
    return Net(nodes, near + "".join(edge(ends) for ends in ("bd", "db", "de", "ed")), ways)


@pytest.mark.parametrize("departs", [[0], [1], [0, 1, 2, 3, 4], [0, 2, 4]])
def test_where_the_oncoming_lane_lies_on_its_own_the_ego_waits_before_it_until_it_can_leave_it(tmp_path, departs):
    """SUMO's own cars drive through each other there."""
    run = driven(tmp_path, over_each_other(), car("ego", "ab bd de"), stream("on", "ed db ba", departs))
    assert run.complaints(slower=2.0) == []


def test_the_ego_does_not_come_to_stand_behind_a_queue_where_the_oncoming_lane_lies_on_its_own(tmp_path):
    jam = car("jam", "bd de", 0, stop("bd_0", 9, until=14), departPos=2, departSpeed=0)
    run = driven(tmp_path, over_each_other(), car("ego", "ab bd de"), jam, car("on", "ed db ba", 2))
    assert run.complaints() == []


@pytest.mark.parametrize("step", [0.1, 0.5])
@pytest.mark.parametrize("late", [-1.5, -1.0, -0.5, 0.0, 0.5])
def test_who_goes_first_and_will_brake_for_his_turn_is_not_followed_into_it_too_soon(tmp_path, late, step):
    turner = car("x", "ec cn", 3.0 + late)
    run = driven(tmp_path, cross(arm=150.0, speed=16.0), car("ego", "sc cn", 3.0, departSpeed=10), turner, step=step)
    assert run.complaints() == []


@pytest.mark.parametrize("at", [41, 47, 53])
def test_a_motorcycle_speeds_up_too_fast_for_a_bus_to_turn_before_it(tmp_path, at):
    """It comes from the left, `at` m from the beginning of its road, slowly at first."""
    moto = sort("moto", vClass="motorcycle", length=2.2, width=0.9, sigma=0)
    other = car("m", "wc ce", 7, type="moto", departPos=at, departSpeed=4)
    run = driven(tmp_path, cross(arm=140.0), moto, other, car("ego", "sc cw", type="bus"), until=90)
    assert run.complaints() == []


@pytest.mark.parametrize("waits", [3.5, 3.8, 4.2])
@pytest.mark.parametrize("depart", [1.0, 3.0])
def test_who_waits_inside_to_turn_is_passed_within_the_lane_where_others_may_turn_around(tmp_path, waits, depart):
    """He waits `waits` m behind his line: his front covers what the ego would drive over in the middle of its lane."""
    nodes = "".join(node(a, 90 * x, 90 * y) for a, (x, y) in ARMS.items()) + node("c", 0, 0, type="priority", radius=1.5)
    edges = "".join(edge(ends, priority=5 if a in "we" else 1) for a in ARMS for ends in (f"{a}c", f"c{a}"))
    links = link("wc cn", contPos=waits) + "".join(link(f"wc c{to}") for to in "esw")
    net = Net(nodes, edges, links, options=())
    run = driven(tmp_path, net, car("ego", "ec cw", depart), car("x", "wc cn", departSpeed="max"))
    assert run.complaints(slower=1.05) == []
