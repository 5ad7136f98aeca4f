"""Kinds of egos and of steps: from 2.2 m to 16.5 m, 50 m/s, steps up to 1 s."""

from __future__ import annotations

from dataclasses import replace

import pytest
from kinds import Net, car, cross, driven, edge, link, node, sort, standing, stop, stream

SIZES = {
    2.2: ("passenger", 0.9),
    4.7: ("passenger", 1.8),
    7.0: ("delivery", 2.2),
    12.0: ("bus", 2.5),
    16.5: ("trailer", 2.5),
}


@pytest.mark.parametrize("turn", ["cs", "cn"])
@pytest.mark.parametrize("length", SIZES)
def test_short_and_long_cars_turn_at_a_crossing(tmp_path, length, turn):
    vehicle_class, width = SIZES[length]
    size = sort("size", length=length, width=width, vClass=vehicle_class)
    other = stream("on", "ec cw", [0, 2])
    assert driven(tmp_path, cross(), size, car("ego", f"wc {turn}", 2, type="size"), other).complaints() == []


@pytest.mark.parametrize("turn", ["cn", "cs"])
@pytest.mark.parametrize("length", SIZES)
def test_short_and_long_cars_turn_past_or_after_somebody_who_waits_at_the_line(tmp_path, length, turn):
    vehicle_class, width = SIZES[length]
    size = sort("size", length=length, width=width, vClass=vehicle_class)
    waits = standing("waits", f"{turn[1]}c cw", f"{turn[1]}c_0", 81, 20)
    assert driven(tmp_path, cross(), size, car("ego", f"wc {turn}", 2, type="size"), waits).complaints(slower=3.0) == []


@pytest.mark.parametrize("lanes", [1, 2])
def test_at_50_metres_per_second_a_slower_car_is_met(tmp_path, lanes):
    fast = sort("fast", maxSpeed=50)
    slow = sort("slow", maxSpeed=25)
    net = Net(node("a", 0, 0) + node("b", 2000, 0), edge("ab", numLanes=lanes, speed=50))
    other = car("x", "ab", type="slow", departPos=300)
    run = driven(tmp_path, net, fast, slow, car("ego", "ab", 1, type="fast"), other, until=90)
    assert run.complaints() == []


@pytest.mark.parametrize("route", ["sc cn", "sc cw", "wc cn"])
@pytest.mark.parametrize("step", [0.05, 0.1, 0.25, 0.5, 1.0])
def test_every_step_is_fine_at_a_crossing_with_traffic(tmp_path, step, route):
    both = stream("e", "ec cw", [0, 2, 4, 9, 13, 20]) + stream("w", "wc ce", [0, 5.5, 8, 15, 21])
    assert driven(tmp_path, cross(), car("ego", route, 2), both, step=step).complaints() == []


@pytest.mark.parametrize("length", SIZES)
def test_short_and_long_cars_pass_somebody_who_waits_inside_for_them(tmp_path, length):
    vehicle_class, width = SIZES[length]
    size = sort("size", length=length, width=width, vClass=vehicle_class)
    net = replace(cross(), rules=link("ec cs", contPos=5.5))
    ahead = stream("ahead", "wc ce", [0, 1.5, 3])
    run = driven(tmp_path, net, size, car("ego", "wc ce", 4.5, type="size"), ahead, car("waits", "ec cs", 0), until=60)
    assert run.complaints() == []


@pytest.mark.parametrize("at", [30, 80])
def test_after_a_stop_of_the_route_the_ego_drives_on_as_fast_as_the_road_allows(tmp_path, at):
    """The time of a stop counts once: what is left of it, while it is served, and nothing afterwards."""
    net = Net(node("a", 0, 0) + node("b", 200, 0) + node("c", 400, 0), edge("ab") + edge("bc"))
    ego = car("ego", "ab bc", stops=stop("ab_0", at, duration=20))
    run = driven(tmp_path, net, ego, until=150)
    assert run.complaints(slower=1.1) == []
