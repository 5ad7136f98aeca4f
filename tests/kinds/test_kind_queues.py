"""Kinds of queues: behind somebody who waits to turn, with a lane beside that flows; and queues that are no reason."""

from __future__ import annotations

import pytest
from kinds import Net, car, cross, driven, edge, link, node, program, road, sort, standing, stream

ONCOMING = "ec cw"


def lanes(run) -> list[str]:
    """Return the lanes of the approach that the ego drives on, in order."""
    found: list[str] = []
    for moment in run.ego.moments:
        if moment.lane.startswith("wc_") and found[-1:] != [moment.lane]:
            found.append(moment.lane)
    return found


def oncoming(headway: float) -> str:
    """A stream on both lanes that leaves who turns left no gap for a minute."""
    departs = [headway * k for k in range(int(60.0 / headway))]
    return "".join(stream(f"o{k}", ONCOMING, departs, departLane=k) for k in (0, 1))


def turners(count: int) -> str:
    return "".join(car(f"t{k}", "wc cn", 2.0 * k, departLane=1) for k in range(count))


@pytest.mark.parametrize("count", [1, 2, 3])
@pytest.mark.parametrize("depart", [8, 14])
def test_a_queue_behind_somebody_who_waits_to_turn_is_left(tmp_path, count, depart):
    ego = car("ego", "wc ce", depart, departLane=1)
    run = driven(tmp_path, cross(arm=180, numLanes=2), turners(count), oncoming(1.8), ego, until=120)
    assert run.complaints() == []
    assert lanes(run) == ["wc_1", "wc_0"]
    assert run.ego.duration < 45.0


@pytest.mark.parametrize("headway", [2.5, 4.0])
def test_it_is_left_for_a_gap_in_the_lane_that_flows_and_nobody_there_brakes_hard(tmp_path, headway):
    ego = car("ego", "wc ce", 12, departLane=1)
    beside = stream("b", "wc ce", [4.0 + headway * k for k in range(14)], departLane=0)
    run = driven(tmp_path, cross(arm=180, numLanes=2), turners(2), oncoming(1.8), ego, beside, until=140)
    assert run.complaints() == []


def test_who_turns_himself_stays_behind_those_who_turn(tmp_path):
    ego = car("ego", "wc cn", 10, departLane=1)
    run = driven(tmp_path, cross(arm=180, numLanes=2), turners(2), oncoming(1.8), ego, until=160)
    assert run.complaints() == []
    assert lanes(run) == ["wc_1"]


@pytest.mark.parametrize("other", [2, 3, 4])
def test_queues_at_a_red_light_that_are_about_as_long_are_not_exchanged(tmp_path, other):
    green, red = "GGggGGggGGggGGgg", "rrrrrrrrrrrrrrrr"
    net = cross("traffic_light", arm=180, numLanes=2)
    own = "".join(car(f"a{k}", "wc ce", 2.0 * k, departLane=1) for k in range(3))
    beside = "".join(car(f"b{k}", "wc ce", 2.0 * k, departLane=0) for k in range(other))
    light = program("c", (35, red), (60, green))
    run = driven(tmp_path, net, own, beside, car("ego", "wc ce", 10, departLane=1), extra=light, until=140)
    assert run.complaints() == []
    assert lanes(run) == ["wc_1"]


@pytest.mark.parametrize("count", [0, 3])
@pytest.mark.parametrize("depart", [14, 40])
def test_a_queue_that_does_not_move_on_the_open_road_is_left(tmp_path, count, depart):
    sorts = sort("slow", lcSpeedGain=0, lcKeepRight=0) + sort("broken", maxSpeed=0.05, lcSpeedGain=0, lcKeepRight=0)
    head = car("x", "ab", departPos=330, departSpeed=0, type="broken")
    queue = "".join(car(f"q{k}", "ab", departPos=310 - 12 * k, departSpeed=0, type="slow") for k in range(count))
    net = road(500, numLanes=2)
    run = driven(tmp_path, net, car("ego", "ab", depart, departLane=0), head, queue, extra=sorts, until=200)
    assert run.complaints(slower=1.2) == []


@pytest.mark.parametrize("length", [45, 120])
@pytest.mark.parametrize("lane", [0, 1])
def test_a_queue_behind_a_breakdown_is_passed_and_the_lane_of_the_turn_is_taken_behind_it(tmp_path, length, lane):
    """The turn at c is made from the right lane; on the road before, that lane stands."""
    nodes = node("a", 0, 0) + node("b", 200, 0) + node("c", 205 + length, 0)
    nodes += node("e", 400, 0) + node("d", 205 + length, -150)
    rules = link("bc ce", "10") + link("bc cd", "00")
    net = Net(nodes, edge("ab", numLanes=2) + edge("bc", numLanes=2) + edge("ce") + edge("cd"), rules)
    broken = standing("x", "ab bc cd", "ab_0", 190, 150)
    still = {"departLane": 0, "departSpeed": 0, "type": "stuck"}
    queue = "".join(car(f"q{k}", "ab bc cd", departPos=182 - 8 * k, **still) for k in range(3))
    stuck = sort("stuck", lcStrategic=-1, lcSpeedGain=0, lcCooperative=-1, lcKeepRight=0)
    run = driven(tmp_path, net, stuck, broken, queue, car("ego", "ab bc cd", 2, departLane=lane), until=200)
    assert run.complaints() == []
    assert run.ego.duration < 60.0


@pytest.mark.parametrize("length", [20, 22])
def test_who_waits_aslant_after_a_change_on_a_short_road_is_seen_by_those_who_pass_on_the_lane_that_it_came_from(
    tmp_path, length
):
    """It turns right onto a road of some ten metres, and left from its other lane, where the light is red."""
    nodes = node("a", -150, 0) + node("b", 0, 0) + node("c", length, 0, type="traffic_light") + node("d", length + 150, 0)
    nodes += node("s", 0, -120) + node("n", length, 120)
    ways = edge("ab") + edge("sb", priority=-2) + edge("bc", numLanes=2) + edge("cd") + edge("cn")
    links = link("ab bc") + link("sb bc") + link("bc cd") + link("bc cn", "10")
    light = program("c", (40, "Gr"), (3, "yr"), (20, "rG"))
    beside = stream("x", "ab bc cd", [9, 14, 16.5, 19, 21.5, 24])
    net = Net(nodes, ways, links)
    run = driven(tmp_path, net, car("ego", "sb bc cn"), beside, extra=light, step=0.5)
    assert run.complaints() == []
