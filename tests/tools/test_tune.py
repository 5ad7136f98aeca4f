"""Coefficients: a search keeps what costs less, and judges it on roads that it has not seen."""

from __future__ import annotations

import sys
from types import SimpleNamespace

import pytest
from helpers.programs import TOOLS, run_tool
from helpers.tools import tool

from sumo_reactive.driver.nouns.decision import INSTRUCTION_NUMBERS, Instruction
from sumo_reactive.driver.parameters import USUAL

sys.path.insert(0, str(TOOLS))

from roads.trips import Run


@pytest.fixture(scope="module")
def tune():
    return tool("tune")


def test_a_contact_costs_more_than_violations_these_more_than_time_and_jerk_least(tune):
    fine = Run(arrived=True, duration_s=60.0, jerk=1.0)
    costs = [
        tune.cost_of(run, 60.0)
        for run in (
            fine, fine._replace(jerk=2.0), fine._replace(duration_s=90.0), fine._replace(red=(3.0,)),
            fine._replace(hard_braking=2), fine._replace(contacts=((1.0, "x"),)),
        )
    ]  # fmt: skip
    assert costs == sorted(costs) and len(set(costs)) == len(costs)


def test_a_search_varies_its_coefficients_about_their_values_and_for_its_instruction_alone(tune):
    every = tune.Search(None, tune.COEFFICIENTS).parameters([1.0, 0.0, -1.0, 0.0, 2.0])
    assert every.varied == {
        "valley_share": 2.0, "valley_attraction": 0.5 * USUAL.valley_attraction, "shadow_scale": 4.0 * USUAL.shadow_scale
    }  # fmt: skip
    one = tune.Search(Instruction.STOP, tune.WEIGHTS).parameters([0.0, 1.0])
    assert one.varied == {"shadow_share": 2.0, "shares_of": INSTRUCTION_NUMBERS[Instruction.STOP]}


def test_the_least_cost_is_found_within_the_bounds(tune, monkeypatch):
    wanted = tune.Search(None, tune.WEIGHTS).parameters([1.0, -9.0])
    monkeypatch.setattr(
        tune, "cost", lambda _, tried, __: abs(tried.valley_share - wanted.valley_share) + tried.shadow_share
    )
    powers = tune.searched(tune.Search(None, tune.WEIGHTS), 2.0, [], 80, SimpleNamespace())
    assert powers == pytest.approx((1.0, -tune.FARTHEST), abs=0.2)


def test_a_small_search_is_told_row_by_row(tmp_path):
    file = tmp_path / "tuning.md"
    done = run_tool("tune", "3", "1", "--egos", "1", "--evaluations", "1", "--only", "stop", "--write", str(file))
    assert done.returncode == 0, done.stderr
    header, row = done.stdout.splitlines()[2], done.stdout.splitlines()[4]
    assert header.startswith("| instruction |")
    assert row.startswith("| stop at the place named | w₁ × 1.00, w₂ × 1.00 |") and row.endswith("| no |")
    assert done.stdout.strip() in file.read_text(encoding="utf-8")
    assert "stop at the place named: w₁ × 1.00" in done.stderr
