"""Kinds of cars that have been passed: they must see the ego before them."""

from __future__ import annotations

import pytest
from kinds import Net, Witness, car, edge, node, program, situation, sort

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
