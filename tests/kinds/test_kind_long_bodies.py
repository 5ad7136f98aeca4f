"""Kinds of long bodies that swing in turns: over the lane of those who come, and over who waits at another road's line; the
ego's own, and others'."""

from __future__ import annotations

import math

import pytest
from kinds import Net, car, cross, driven, edge, link, node, program, sort, stream

LONG = sort("long", vClass="bus", length=12, width=2.5) + sort("trailer", vClass="trailer", length=16, width=2.5)


def fork(angle: float, radius: float = 1.5) -> Net:
    """Return a road from a to b that goes on to n, and turns right by `angle` degrees to e, both ways there."""
    turn = math.radians(angle)
    nodes = node("a", 0, -90) + node("b", 0, 0, radius=radius) + node("n", 0, 90)
    nodes += node("e", 90 * math.sin(turn), 90 * math.cos(turn))
    return Net(nodes, "".join(edge(ends) for ends in ("ab", "ba", "bn", "nb", "be", "eb")))


@pytest.mark.parametrize(("gap", "first", "slower"), [(3, 0, 2.5), (3, 1.4, 2.5), (6, 1, 1.6), (8, 1, 1.3)])
def test_a_bus_waits_before_its_line_for_those_whose_lane_its_front_swings_over(tmp_path, gap, first, slower):
    """Nobody who comes looks at it, and no rule of the map is between them."""
    others = stream("x", "eb bn", [first + gap * k for k in range(7)])
    run = driven(tmp_path, fork(125), car("ego", "ab be", type="long"), others, extra=LONG)
    assert run.complaints(slower=slower) == []
    assert run.ego.slowest(":b") > 1.0


@pytest.mark.parametrize("gap", [3, 6])
def test_a_car_that_swings_over_nobody_waits_for_nobody(tmp_path, gap):
    run = driven(tmp_path, fork(125), car("ego", "ab be"), stream("x", "eb bn", [gap * k for k in range(7)]))
    assert run.complaints(slower=1.15) == []


@pytest.mark.parametrize("kind", ["right_before_left", "priority"])
@pytest.mark.parametrize("way", ["nc cs", "nc ce", "nc cw"])
@pytest.mark.parametrize("first", [0, 2])
def test_a_trailer_lets_those_go_whose_line_it_cuts_over(tmp_path, kind, way, first):
    """They would wait for it at their line, and it for them in front of it."""
    net = cross(kind, options=("--default.junctions.radius", "1.5"))
    others = stream("x", way, [first + 4 * k for k in range(4)])
    run = driven(tmp_path, net, car("ego", "wc cn", type="trailer"), others, extra=LONG, until=120)
    assert run.complaints(slower=2.5) == []


@pytest.mark.parametrize("kind", ["long", "trailer"])
@pytest.mark.parametrize("angle", [135, 150])
@pytest.mark.parametrize(("gap", "first"), [(4, 0), (4, 1.4), (8, 1), (12, 2)])
def test_who_swings_out_before_its_line_waits_on_its_own_lane_for_those_who_come_out(tmp_path, kind, angle, gap, first):
    """At its line it would stand across the lane by which they leave the junction; a gap of 8 s is too small for some."""
    others = stream("x", "nb ba", [first + gap * k for k in range(7)])
    run = driven(tmp_path, fork(angle), car("ego", "ab be", type=kind), others, extra=LONG, until=120)
    assert run.complaints(slower=5) == []


@pytest.mark.parametrize(
    ("kind", "angle", "radius", "first"),
    [("long", 135, 1.5, 4.5), ("trailer", 135, 1.5, 4.5), ("trailer", 150, 1.5, 3), ("long", 150, 4, 3)],
)
def test_who_is_crooked_behind_a_sharp_turn_waits_for_whose_line_it_covers_there(tmp_path, kind, angle, radius, first):
    """They start far away and speed up as far as their road allows, though their turn allows less."""
    x = car("x", "eb ba", first, departSpeed=0)
    run = driven(tmp_path, fork(angle, radius), car("ego", "ab be", type=kind), x, extra=LONG, until=120)
    assert run.complaints(slower=3) == []


@pytest.mark.parametrize("kind", ["long", "trailer"])
@pytest.mark.parametrize("first", [3, 5, 7])
def test_who_is_crooked_behind_a_sharp_turn_waits_for_those_whose_trip_ends_there(tmp_path, kind, first):
    """They drive up to the line, and turn nowhere behind it."""
    others = stream("x", "eb", [first + 3 * k for k in range(5)])
    run = driven(tmp_path, fork(135), car("ego", "ab be", type=kind), others, extra=LONG, until=120)
    assert run.complaints(slower=5) == []


@pytest.mark.parametrize("kind", ["long", "trailer"])
def test_a_long_body_that_goes_straight_on_waits_for_nobody_on_the_ramp_beside_it(tmp_path, kind):
    """Their ways lie over each other before both lines; it covers no more of the ramp than the map knows."""
    nodes = node("a", -200, 0) + node("r", -140, -55) + node("b", 0, 0) + node("c", 150, 0)
    roads = edge("ab", numLanes=2) + edge("rb") + edge("bc", numLanes=3)
    ways = link("rb bc", "00") + link("ab bc", "01") + link("ab bc", "12")
    others = stream("x", "rb bc", [3 * k for k in range(25)])
    run = driven(tmp_path, Net(nodes, roads, ways), car("ego", "ab bc", 5, type=kind), others, extra=LONG, until=120)
    assert run.complaints(slower=1.2) == []


@pytest.mark.parametrize("kind", ["priority", "right_before_left"])
@pytest.mark.parametrize("way", ["sc cn", "sc cw"])
def test_a_car_waits_farther_back_for_a_bus_that_cuts_the_corner_over_its_line(tmp_path, kind, way):
    """SUMO's own driver stands at the line, in its way."""
    net = cross(kind, options=("--default.junctions.radius", "1.5"))
    others = stream("x", "ec cs", [0, 4, 8], type="long")
    run = driven(tmp_path, net, others, car("ego", way, 3), extra=LONG)
    assert run.complaints() == []


@pytest.mark.parametrize("kind", ["priority", "right_before_left"])
@pytest.mark.parametrize("body", ["long", "trailer"])
@pytest.mark.parametrize("way", ["wc cn", "sc cn"])
def test_a_car_keeps_clear_of_a_long_tail_that_reaches_out_of_its_bend(tmp_path, kind, body, way):
    """The map knows of no conflict there, or of one that ends before the tail has gone."""
    net = cross(kind, options=("--default.junctions.radius", "1.5"))
    run = driven(tmp_path, net, stream("x", "nc cw", [0, 4, 8], type=body), car("ego", way, 3), extra=LONG)
    assert run.complaints(slower=2.0) == []


@pytest.mark.parametrize("radius", [1.5, 4.0])
@pytest.mark.parametrize(("other", "late"), [("wc", 0.0), ("wc", 3.0), ("sc", 1.5), ("sc", 2.0), ("sc", 2.5), ("sc", 3.5)])
def test_a_bus_that_cuts_the_corner_waits_inside_for_nobody_who_has_not_come_in(tmp_path, other, late, radius):
    """Its body comes over the lane beside its own behind the junction, to which another's way leads: he stands at his red
    light, or he is behind it and sees it there."""
    nodes = node("w", -150, 0) + node("c", 0, 0, type="traffic_light", radius=radius) + node("s", 0, -90)
    roads = "".join(edge(ends, numLanes=2) for ends in ("sc", "wc", "cd", "de"))
    ways = "".join(link(ends, lanes) for ends in ("sc cd", "wc cd", "cd de") for lanes in ("00", "11"))
    net = Net(nodes + node("d", 40, 0) + node("e", 140, 0), roads, ways)
    light, x = program("c", (40, "GGrr"), (40, "rrGG")), car("x", f"{other} cd de", late, departLane=0)
    run = driven(tmp_path, net, LONG, car("ego", "sc cd de", departLane=1, type="long"), x, extra=light, until=90)
    assert run.complaints() == []
    assert run.ego.slowest(":c") > 1.0


def roundabout(radius: float, arms: str = "abcde", outer: str = "vwxyz") -> Net:
    """Return a roundabout of two lanes with the entries "va", "wb", …, of two lanes the first."""
    nodes = edges = ""
    for k, (near, far) in enumerate(zip(arms, outer, strict=True)):
        turn = 2.0 * math.pi * k / len(arms)
        nodes += "".join(
            node(name, r * math.cos(turn), r * math.sin(turn)) for name, r in ((near, radius), (far, radius + 150))
        )
        edges += edge(far + near, priority=1, numLanes=1 + (k == 0)) + edge(near + far, priority=1)
        edges += edge(near + arms[(k + 1) % len(arms)], priority=5, numLanes=2, speed=11)
    return Net(nodes, edges, options=("--no-turnarounds", "--roundabouts.guess"))


@pytest.mark.parametrize(("radius", "depart"), [(14, 9), (14, 10), (18, 8), (18, 9), (18, 11)])
def test_a_bus_that_swings_over_the_inner_lane_sees_who_comes_round_from_another_arm(tmp_path, radius, depart):
    """The road before the last arm is hardly longer than a car: who has to brake for the bus is still before that."""
    around = stream("f", "va ab bc cd de ez", [4 * k for k in range(8)], departLane=1, type="calm")
    run = driven(tmp_path, roundabout(radius), around, car("ego", "yd de ez", depart, type="bus"), until=150)
    assert run.complaints(slower=3.0) == []
