"""Those who judge the ego from outside see what there is to see: SUMO's own driver without manners."""

from __future__ import annotations

import pytest
from helpers.priority import Priority, Rules
from helpers.rude import ROOT, RUNS_RED, TAKES_IT, in_a_hurry
from helpers.witness import RED, Witness

from sumo_reactive.lab.simulation import run_sumo_driver


@pytest.mark.parametrize("rudeness", [{}, RUNS_RED], ids=["polite", "rude"])
def test_a_witness_sees_who_crosses_a_line_on_red(tmp_path, rudeness):
    witness = Witness()
    run_sumo_driver(in_a_hurry(tmp_path, "signalised_left_turns", **rudeness), observer=witness)
    assert [letters in RED for _, letters in witness.lights] == [bool(rudeness)]


@pytest.mark.parametrize("rudeness", [{}, TAKES_IT], ids=["polite", "rude"])
def test_a_witness_sees_whose_right_of_way_is_taken(tmp_path, rudeness):
    network = "four_way_priority"
    priority = Priority(Rules(ROOT / "networks" / network / f"{network}.net.xml"))
    run_sumo_driver(in_a_hurry(tmp_path, network, **rudeness), observer=priority)
    assert bool(priority.taken) is bool(rudeness)
