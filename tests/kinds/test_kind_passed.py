"""Kinds of cars that have been passed: they must see the ego before them."""

from __future__ import annotations

import random

import pytest
from kinds import STEP_S, Net, Witness, car, driven, edge, link, node, program, situation, sort, standing, stop, stream

from sumo_reactive.lab.simulation import run_trial


@pytest.mark.parametrize("step", [0.1, 1.0])
def test_who_has_been_passed_stops_behind_the_ego(tmp_path, step):
    nodes = node("a", 0, 0) + node("b", 700, 0, type="traffic_light") + node("c", 900, 0)
    tractor = car("tractor", "ab bc", type="tractor", departPos=60, departSpeed=3)
    net = Net(nodes, edge("ab") + edge("ba") + edge("bc") + edge("cb"))
    red = program("b", (220, "rr"), (100, "GG"))
    slow = sort("tractor", maxSpeed=4, sigma=0)
    scenario = situation(tmp_path, net, slow, tractor, car("ego", "ab bc", 1), extra=red, until=300, step=step)
    witness, behaviours = Witness(), set()
    result = run_trial(scenario, observer=lambda scene: (witness(), behaviours.add(scene.step.behaviour)))
    assert "overtaking" in behaviours
    assert result.verdict == "arrived without a violation"
    assert witness.touched == {}


TWO_WAY = ("--no-turnarounds", "--opposites.guess")
"""SUMO's own driver may overtake on the oncoming lane, too."""


def two_way_road(length: float, bend: float = 0.0, speed: float = 13.9) -> Net:
    """Return a two-way road of `length` m and 200 m on, its middle node `bend` m aside."""
    nodes = node("a", 0, 0) + node("b", length, bend) + node("c", length + 200, 0)
    return Net(nodes, "".join(edge(ends, speed=speed) for ends in ("ab", "ba", "bc", "cb")), options=TWO_WAY)


@pytest.mark.parametrize(
    ("slow", "number", "gap"), [("tractor", 1, 4), ("tractor", 3, 12), ("cyclist", 3, 4), ("cyclist", 5, 4)]
)
@pytest.mark.parametrize("speed", [1, 4])
def test_slow_ones_who_leave_no_gap_are_passed_in_one_go_and_need_not_brake(tmp_path, slow, number, gap, speed):
    length = {"tractor": 4.7, "cyclist": 1.6}[slow]
    small = {"vClass": "bicycle", "length": 1.6, "width": 0.65}
    sorts = sort("tractor", maxSpeed=speed, sigma=0), sort("cyclist", maxSpeed=speed, sigma=0, **small)
    places = [60 + i * (gap + length) for i in range(number)]
    column = [car(f"t{i}", "ab bc", type=slow, departPos=at, departSpeed=speed) for i, at in enumerate(places)]
    run = driven(tmp_path, two_way_road(900), *sorts, *column, car("ego", "ab bc", 1), until=300)
    assert run.complaints() == []


@pytest.mark.parametrize(("seed", "step"), [(1, 1.0), (6, 1.0), (8, 0.1), (10, 0.1), (11, 0.1), (37, 0.1), (68, 1.0)])
def test_nobody_is_touched_where_slow_ones_are_passed_among_those_who_come_towards_the_ego(tmp_path, seed, step):
    drawn = random.Random(seed)
    length, speed = drawn.choice([400, 900, 1500]), drawn.choice([8.3, 13.9, 16.7])
    net = two_way_road(length, drawn.choice([0, 80]), speed)
    sorts = (
        sort("s0", maxSpeed=drawn.uniform(0.8, 5)),
        sort("s1", vClass="bicycle", length=1.6, width=0.65, maxSpeed=drawn.uniform(2, 6)),
        sort("s2", vClass="truck", length=drawn.choice([8, 12]), width=2.4, maxSpeed=drawn.uniform(1, 6)),
    )
    at, slow = 40.0, []
    for i in range(drawn.randint(1, 5)):
        kind = drawn.choice(["s0", "s1", "s2"])
        at += drawn.uniform(3, 25) + (12 if kind == "s2" else 5)
        slow.append(car(f"t{i}", "ab bc", type=kind, departPos=at, departSpeed=0.8))
    every = drawn.choice([8, 15, 30])
    oncoming = stream("o", "cb ba", [i * every + drawn.uniform(0, 5) for i in range(600 // every)])
    run = driven(tmp_path, net, *sorts, *slow, oncoming, car("ego", "ab bc", 1), until=700, step=step)
    assert run.complaints(slower=10.0) == []


PASSED = {
    "tractor": sort("tractor", maxSpeed=4, sigma=0) + car("x", "ab bc", type="tractor", departPos=80, departSpeed=4),
    "two": sort("tractor", maxSpeed=4, sigma=0)
    + "".join(car(f"x{k}", "ab bc", type="tractor", departPos=80 + 8 * k, departSpeed=4) for k in (0, 1)),
    "halted": standing("x", "ab bc", "ab_0", 160, 90),
}


@pytest.mark.parametrize("behind", [8, 20])
@pytest.mark.parametrize("passed", PASSED)
def test_who_follows_a_passing_ego_sees_whom_it_passes(tmp_path, passed, behind):
    """The ego is between them in the order of their lane, though beside it: its follower would touch who is passed."""
    nodes = node("a", 0, 0) + node("b", 900, 0) + node("c", 1100, 0)
    net = Net(nodes, "".join(edge(ends) for ends in ("ab", "ba", "bc", "cb")))
    ego = car("ego", "ab bc", 2, departPos=40, departSpeed=8)
    follower = car("f", "ab bc", 2, departPos=40 - behind, departSpeed=8, type="calm")
    run = driven(tmp_path, net, PASSED[passed], ego, follower, until=300)
    assert run.complaints() == []
    assert run.ego.duration < 80.0  # it passes


def test_nobody_is_passed_while_the_ego_is_overtaken(tmp_path):
    ego = car("ego", "ab bc", 2, departPos=40, departSpeed=8)
    others = car("f", "ab bc", 2, departPos=20, departSpeed=8) + car("g", "ab bc", 5)
    slow = sort("tractor", maxSpeed=4, sigma=0) + car("x", "ab bc", type="tractor", departPos=80, departSpeed=3)
    assert driven(tmp_path, two_way_road(900), slow, ego, others, until=300, step=1.0).complaints() == []


@pytest.mark.parametrize("until", [125, 129, 134])
def test_who_drives_on_before_the_last_of_a_column_is_not_chased_beside_it(tmp_path, until):
    """The first two of three crawl only as far as `until` (m): the ego comes back behind them, before the third."""
    slow, net = sort("tractor", maxSpeed=3, sigma=0), two_way_road(900)
    crawls = stop("ab_0", until, startPos=60, speed=3)
    first = "".join(car(f"x{k}", "ab bc", stops=crawls, departPos=88 + 8 * k, departSpeed=3) for k in (0, 1))
    last = car("y", "ab bc", type="tractor", departPos=80, departSpeed=3)
    scenario = situation(tmp_path, net, slow, first, last, car("ego", "ab bc", 1), until=200)
    witness, passing = Witness(), []
    run_trial(scenario, observer=lambda scene: (witness(), passing.append(scene.step.behaviour == "overtaking")))
    assert witness.touched == {}
    assert 0.0 < sum(passing) * STEP_S < 20.0  # it stayed there to the end of the road


@pytest.mark.parametrize(("number", "go", "first"), [(14, 12, 4), (20, 20, 4), (14, 12, 14), (20, 28, 14)])
def test_nobody_is_passed_in_a_queue_that_moves_up(tmp_path, number, go, first):
    """It begins to move at `go` (s), no faster than its `first` (m/s); the lane beside leads elsewhere."""
    nodes = node("a", 0, 0) + node("b", 400, 0, type="traffic_light") + node("c", 800, 0) + node("d", 400, 200)
    net = Net(nodes, edge("ab", numLanes=2) + edge("bc") + edge("bd"), link("ab bc", "00") + link("ab bd", "10"))
    lights = program("b", (go, "rG"), (60, "GG"), (3, "yG"), (30, "rG"))
    sorts = sort("first", maxSpeed=first), sort("usual", lcSpeedGain=0, lcCooperative=0)
    said = {"departSpeed": 0, "departLane": 0}
    queue = [car(f"q{k}", "ab bc", type="usual", departPos=382.5 - 7.5 * k, **said) for k in range(number)]
    head = car("head", "ab bc", type="first", departPos=390, **said)
    scenario = situation(tmp_path, net, *sorts, head, *queue, car("ego", "ab bc", 1), extra=lights, until=400)
    witness, behaviours = Witness(), set()
    result = run_trial(scenario, observer=lambda scene: (witness(), behaviours.add(scene.step.behaviour)))
    assert result.verdict == "arrived without a violation"
    assert "overtaking" not in behaviours
