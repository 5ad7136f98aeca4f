"""Kinds of missed turns: the lane that the route needs is never free, so the ego must come to its goal another way."""

from __future__ import annotations

import libsumo
import pytest
from kinds import Net, Witness, car, edge, link, node, situation, standing, stream

from sumo_reactive.lab.recorder import Recorder
from sumo_reactive.lab.simulation import run_trial
from sumo_reactive.show.explain import story
from sumo_reactive.show.recording import read_run

NODES = node("a", 0, 0) + node("b", 180, 0) + node("d", 280, 0) + node("e", 280, 100) + node("n", 180, 100)
NODES += node("x", 80, 100)
EDGES = edge("ab", numLanes=2) + edge("bd") + edge("de") + edge("en") + edge("bn") + edge("nx")
RULES = link("ab bd", "00") + link("ab bn", "10")
AROUND = Net(NODES, EDGES, RULES)


def queue(until: float) -> str:
    """Return cars that stand on the whole of the left lane until a time, s."""
    return "".join(standing(f"q{i}", "ab bn nx", "ab_1", 8 + 7.5 * i, until) for i in range(23))


def test_a_turn_that_nobody_lets_the_ego_reach_is_made_up_for_by_another_way(tmp_path):
    scenario = situation(tmp_path, AROUND, car("ego", "ab bn nx", 10, departLane=0), queue(until=500), until=250)
    witness, recorder = Witness(), Recorder(tmp_path / "record")
    result = run_trial(scenario, observer=lambda scene: (witness(), recorder.see(scene)))
    recorder.write(result)
    driven = [moment.lane.rpartition("_")[0] for moment in witness.moments if not moment.lane.startswith(":")]
    assert result.verdict == "arrived without a violation"
    assert list(dict.fromkeys(driven)) == ["ab", "bd", "de", "en", "nx"]
    assert witness.touched == {}
    assert any("the turn to the edge named was missed (bn)" in line for line in story(read_run(tmp_path / "record")))


@pytest.mark.parametrize(("left", "way"), [(2, ["ab", "bd", "de", "en", "nx"]), (40, ["ab", "bn", "nx"])])
def test_a_turn_from_a_lane_that_is_out_of_reach_is_made_up_for_at_once(tmp_path, left, way):
    ego = car("ego", "ab bn nx", 2, departLane=0, departPos=-left, departSpeed=0)
    routes, witness = set(), Witness()
    scenario = situation(tmp_path, AROUND, ego, until=120)
    result = run_trial(scenario, observer=lambda _: (witness(), routes.add(libsumo.vehicle.getRoute("ego"))))
    driven = [moment.lane.rpartition("_")[0] for moment in witness.moments if not moment.lane.startswith(":")]
    assert result.verdict == "arrived without a violation"
    assert list(dict.fromkeys(driven)) == way
    assert routes == {tuple(way)}, "SUMO knows the way from the first step on"


def test_a_turn_is_not_given_up_while_the_wait_is_short(tmp_path):
    scenario = situation(tmp_path, AROUND, car("ego", "ab bn nx", 10, departLane=0), queue(until=25), until=200)
    witness = Witness()
    result = run_trial(scenario, observer=witness)
    assert result.verdict == "arrived without a violation"
    assert any(moment.lane.startswith("bn") for moment in witness.moments)


def test_without_another_way_the_ego_waits_on(tmp_path):
    net = Net(NODES, EDGES.replace(edge("de"), edge("ed")), RULES)
    scenario = situation(tmp_path, net, car("ego", "ab bn nx", 10, departLane=0), queue(until=90), until=250)
    witness = Witness()
    result = run_trial(scenario, observer=witness)
    assert result.verdict == "arrived without a violation"
    assert any(moment.lane.startswith("bn") for moment in witness.moments)


@pytest.mark.parametrize("headway", [1.2, 1.5])
def test_a_stream_without_gaps_is_not_waited_for_either(tmp_path, headway):
    dense = stream("l", "ab bn nx", [headway * i for i in range(160)], departLane=1, type="calm")
    scenario = situation(tmp_path, AROUND, car("ego", "ab bn nx", 8, departLane=0), dense, until=200)
    witness = Witness()
    result = run_trial(scenario, observer=witness)
    assert result.arrived
    assert witness.touched == {}
