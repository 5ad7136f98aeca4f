"""Kinds of turns back on the road that the ego came on, which SUMO's own driver makes on the spot."""

from __future__ import annotations

import libsumo
import pytest
from kinds import Net, Run, car, cross, driven, edge, link, node, situation, standing, stream

from sumo_reactive.driver.nouns.decision import Behaviour
from sumo_reactive.lab.simulation import run_trial

TURN_S = 11.0
"""What a turn in three moves may cost beside one on the spot, braking before it and gaining speed behind it included, s."""


def tee() -> Net:
    """Return a road from a to b, which a main road from n to s meets there."""
    nodes = node("a", 0, 0) + node("b", 120, 0) + node("n", 120, 100) + node("s", 120, -100)
    roads = "".join(edge(ends, priority=5) for ends in ("nb", "bs", "sb", "bn")) + edge("ab") + edge("ba")
    return Net(nodes, roads, options=())


def corner() -> Net:
    """Return two roads that meet at right angles, c, where one may turn round."""
    nodes = node("c", 0, 0) + node("e", 150, 0) + node("n", 0, 150)
    return Net(nodes, "".join(map(edge, ("ec", "ce", "cn", "nc"))), options=("--no-turnarounds.geometry", "false"))


def small() -> Net:
    """Return a crossing without room to spare, where one may turn round."""
    drawn = cross()
    return Net(drawn.nodes, drawn.edges, options=("--default.junctions.radius", "1.5"))


def twin(apart: float) -> Net:
    """Return two one-way roads, `apart` m from each other, that a to b and c to d, with hardly any road from b to c."""
    places = {"a": (0, 0), "b": (120, 0), "e": (240, 0), "d": (0, apart), "c": (120, apart), "f": (240, apart)}
    nodes = "".join(node(name, *place) for name, place in places.items())
    return Net(nodes, "".join(edge(ends, spreadType="center") for ends in ("ab", "be", "bc", "cd", "fc")))


def stub(length: float) -> Net:
    """Return a road along w, a, b, e with a side road at a and at b, these `length` m from each other."""
    places = {"w": (-80, 0), "a": (0, 0), "b": (length, 0), "e": (length + 80, 0), "n": (0, 80), "s": (length, -80)}
    roads = ("wa", "aw", "ab", "ba", "be", "eb", "an", "na", "bs", "sb")
    return Net("".join(node(name, *place) for name, place in places.items()), "".join(map(edge, roads)), options=())


def wide() -> Net:
    """Return a road of two lanes from w to e, back from its middle c, and off to v from its right lane."""
    nodes = node("v", -150, -60) + node("w", -100, 0) + node("c", 0, 0, radius=2) + node("e", 100, 0)
    roads = "".join(edge(ends, numLanes=2) for ends in ("wc", "cw", "ce", "ec")) + edge("wv")
    ways = "".join(link(ends, lanes) for ends in ("wc ce", "ec cw") for lanes in ("00", "11"))
    return Net(nodes, roads, ways + link("wc cw", "11") + link("cw wv"))


def short_way_back() -> Net:
    """Return a road from a over c, 40 m before its end b, where a main road from n to s meets it."""
    nodes = node("a", 0, 0) + node("c", 80, 0) + node("b", 120, 0) + node("n", 120, 100) + node("s", 120, -100)
    roads = "".join(edge(ends, priority=5) for ends in ("nb", "bs", "sb", "bn"))
    return Net(nodes, roads + "".join(map(edge, ("ac", "ca", "cb", "bc"))), options=())


def lost(run: Run) -> float:
    """How much longer the ego takes than SUMO's own driver, s."""
    return run.ego.duration - run.own.duration


def test_a_turn_in_several_moves_takes_no_longer_than_it_must(tmp_path):
    run = driven(tmp_path, tee(), car("ego", "ab ba"))
    assert run.complaints(slower=9.0) == []
    assert lost(run) < TURN_S


def test_in_the_moves_of_a_turn_the_ego_does_not_fall_back_to_the_branch_of_c_that_it_came_on(tmp_path):
    places = []
    seen = situation(tmp_path, tee(), car("ego", "ab ba"))
    run_trial(seen, observer=lambda scene: places.append((scene.step.behaviour, scene.step.s)))
    turning = [s for behaviour, s in places if behaviour == Behaviour.TURNING_ROUND.value]
    assert len(turning) > 100
    assert turning == sorted(turning)


def test_who_finds_no_gap_for_all_the_moves_of_a_turn_takes_another_way(tmp_path):
    others = stream("x", "sb ba", [6 * k for k in range(66)])
    run = driven(tmp_path, tee(), car("ego", "ab ba"), others, until=500)
    assert run.complaints() == []
    assert any(moment.lane == "nb_0" for moment in run.ego.moments)
    assert run.ego.duration < 300.0


def test_from_the_first_move_on_somebody_is_seen_on_the_lane_turned_into(tmp_path):
    """SUMO has the ego in the junction for as long as it points across, its front on that lane: who is inserted there then
    would drive into it."""
    seen = []
    place = situation(tmp_path, corner(), car("ego", "ec ce"))
    run_trial(place, observer=lambda _: seen.append(bool(libsumo.lane.getLastStepVehicleIDs("ce_0"))))
    first = seen.index(True)
    assert sum(seen[first:]) > 150
    assert all(seen[first:-1])


@pytest.mark.parametrize("apart", [2.5, 3.2, 4.0])
def test_a_turn_back_over_two_junctions_with_hardly_any_road_in_between_stays_on_the_road(tmp_path, apart):
    run = driven(tmp_path, twin(apart), car("ego", "ab bc cd"))
    assert run.complaints(slower=9.0) == []
    assert run.result.metrics["off_road_s"] == 0.0


@pytest.mark.parametrize(("length", "speed"), [(18, 0), (20, 0), (22, 0), (22, 3)])
def test_who_departs_on_a_road_hardly_longer_than_the_car_turns_round_on_the_road(tmp_path, length, speed):
    run = driven(tmp_path, stub(length), car("ego", "ab ba an", departSpeed=speed))
    assert run.complaints(slower=9.0) == []
    assert run.result.metrics["off_road_s"] == 0.0


@pytest.mark.parametrize("late", [0.0, 0.4, 0.8, 1.2, 1.6])
def test_the_ego_does_not_begin_to_turn_before_who_is_in_the_way_has_left(tmp_path, late):
    crossing = stream("x", "sb ba", [2.0 + late + 4.0 * k for k in range(3)])
    run = driven(tmp_path, tee(), car("ego", "ab ba"), crossing, until=90)
    assert run.complaints(slower=9.0) == []


@pytest.mark.parametrize("late", [-0.5, 0.0, 0.5, 1.0, 1.5, 2.0, 2.5])
def test_who_turns_round_and_waits_in_the_middle_is_let_go_before_the_ego_turns_into_his_lane(tmp_path, late):
    run = driven(tmp_path, small(), car("ego", "nc ce", 1), car("x", "ec ce", 1 + late))
    assert run.complaints(slower=3.0) == []


@pytest.mark.parametrize("late", [-1.0, 0.0, 1.0])
def test_an_oncoming_left_turner_who_brakes_for_his_place_to_wait_is_not_braked_for(tmp_path, late):
    run = driven(tmp_path, cross(), car("ego", "wc ce", 2), car("x", "ec cs", 2 + late))
    assert run.complaints(slower=1.2) == []
    assert run.ego.slowest("wc") > 11.0


@pytest.mark.parametrize("late", [-1.0, -0.5, 0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0])
def test_two_who_turn_left_towards_each_other_do_not_meet(tmp_path, late):
    through = stream("y", "ec cw", [0.0, 1.5])
    run = driven(tmp_path, small(), car("ego", "wc cn", 0), through, car("x", "ec cs", 3.0 + late))
    assert run.complaints(slower=3.0) == []


@pytest.mark.parametrize("first", [0, 3, 4])
def test_who_swings_out_for_a_turn_over_the_lane_beside_lets_those_pass_who_would_brake_hard_for_it(tmp_path, first):
    """They see the ego on their lane two seconds before it is there, unless that would force them."""
    others = stream("x", "wc ce", [first + 6 * k for k in range(6)], departLane=0)
    run = driven(tmp_path, wide(), car("ego", "wc cw wv", 2, departLane=1), others, until=90)
    assert run.complaints() == []


@pytest.mark.parametrize("queued", [1, 2, 3])
@pytest.mark.parametrize("late", [0.0, 2.0])
def test_a_turn_waits_for_a_queue_where_it_ends_and_is_seen_from_its_first_move_on_from_behind(tmp_path, queued, late):
    head = standing("x", "bc ca", "bc_0", 22.0, 60.0)
    queue = stream("q", "nb bc ca", [1.0 + 2.0 * k for k in range(queued)])
    ego, behind = car("ego", "ac cb bc ca", 8.0 + late), car("y", "ac cb bn", 10.0 + late)
    run = driven(tmp_path, short_way_back(), ego, behind, head, queue, until=200.0)
    assert run.complaints() == []
    assert lost(run) < TURN_S


@pytest.mark.parametrize("late", [0.0, 3.0])
def test_a_bus_that_backs_up_in_a_turn_is_seen_on_each_lane_that_it_lies_over(tmp_path, late):
    nodes = node("a", 0, 0) + node("b", 180, 0)
    roads = edge("ab", numLanes=2) + edge("ba", numLanes=2)
    net = Net(nodes, roads, link("ab ba", "11"), options=())
    beside = stream("x", "ab", [20.0 + late, 24.5 + late], departLane=0, type="bus")
    run = driven(tmp_path, net, car("ego", "ab ba", 2, type="bus", departLane=1), beside, until=120.0)
    assert run.complaints(slower=3.0) == []
