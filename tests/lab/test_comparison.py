"""Comparisons: which pairs count for which metric, what is written, and a small one for real."""

from __future__ import annotations

import csv
import json
from dataclasses import replace
from io import StringIO
from pathlib import Path

import pytest

from sumo_reactive.driver.parameters import Parameters
from sumo_reactive.errors import ScenarioError
from sumo_reactive.lab.comparison.comparison import EGO_METRICS, OTHERS_METRICS, Comparison, Pair, Side, compare
from sumo_reactive.lab.comparison.network_effects import Arrival, NetworkEffects
from sumo_reactive.lab.comparison.record import (
    CSV_FILE,
    JSON_FILE,
    comparison_rows,
    csv_of,
    data_of,
    notes_of,
    require_usable,
    write,
)
from sumo_reactive.lab.drivers.choice import REACTIVE, SUMO, DriverChoice
from sumo_reactive.lab.fault import COLLISION, Fault
from sumo_reactive.lab.result import TrialResult
from sumo_reactive.lab.scenario import Scenario, load_scenario
from sumo_reactive.lab.simulation import run_sumo_driver, run_trial
from sumo_reactive.lab.task import Ending, Outcome, Task

ROOT = Path(__file__).resolve().parents[2]
FOUR_WAY = ROOT / "scenarios" / "four_way_priority.toml"
CONFIG = ROOT / "networks" / "four_way_priority" / "four_way_priority.sumocfg"


def side(driver: DriverChoice, duration: float, arrived: bool = True, loss: float = 10.0, collisions: int = 0) -> Side:
    """A run of `duration` s; the others lost `loss` s."""
    touched = tuple(Fault(1.0, COLLISION, "a", "lane") for _ in range(collisions))
    result = TrialResult(
        scenario="a.sumocfg", ego="ego", chosen="as named", seed=42, step_length_s=0.1, profile="default", arrived=arrived,
        ended="arrived" if arrived else "until 600 s", begin_s=0.0, departure_s=5.0,
        end_s=5.0 + duration, time_loss_s=1.0, distance_m=100.0, figures={
            "collisions": collisions
        }, faults=touched, length_m=4.7, width_m=1.8,
    )  # fmt: skip
    effects = NetworkEffects({"others_time_loss_s": loss, "others_stops": 2}, {"a": Arrival(loss, 1.0)})
    return Side(Outcome(task=Task(replace(SCENARIO, driver=driver)), ending=Ending.DONE, result=result), effects)


SCENARIO = Scenario(config=CONFIG, ego="ego", source=CONFIG)
LATER = Task(replace(SCENARIO, seed=43))
CRASHED = Side(Outcome(task=LATER, ending=Ending.CRASHED, reason="the process was killed by SIGSEGV"), None)


def pair(sumo: Side, reactive: Side, seed: int = 42) -> Pair:
    """A trip of the ego."""
    return Pair(replace(SCENARIO, seed=seed), sumo, reactive)


GOOD = pair(side(SUMO, 30.0, loss=10.0), side(REACTIVE, 33.0, loss=12.0))


def test_a_difference_is_ours_minus_sumos_own_over_all_pairs():
    other = pair(side(SUMO, 40.0, loss=10.0), side(REACTIVE, 41.0, loss=6.0), seed=43)
    found = Comparison((GOOD, other), 600.0).differences
    assert (found["duration_s"].n, found["duration_s"].difference) == (2, 2.0)
    assert found["others_time_loss_s"].difference == -1.0
    assert found["others_mean_duration_s"].difference == -1.0


def test_a_trip_is_compared_only_where_both_have_arrived_but_arrivals_collisions_and_others_always():
    late = pair(side(SUMO, 40.0), side(REACTIVE, 595.0, arrived=False, collisions=1, loss=90.0), seed=43)
    found = Comparison((GOOD, late), 600.0).differences
    assert (found["duration_s"].n, found["duration_s"].difference) == (1, 3.0)
    assert (found["arrived"].n, found["arrived"].difference) == (2, -0.5)
    assert (found["collisions"].n, found["collisions"].difference) == (2, 0.5)
    assert (found["others_time_loss_s"].n, found["others_time_loss_s"].difference) == (2, 41.0)


def test_a_run_that_got_to_no_end_leaves_its_pair_out_and_is_told_with_the_command_that_drives_it_again():
    comparison = Comparison((GOOD, pair(side(SUMO, 40.0), CRASHED, seed=43)), 600.0)
    assert comparison.exit_code == 1 and Comparison((GOOD,), 600.0).exit_code == 0
    assert {found.n for found in comparison.differences.values()} == {1}
    told = "\n".join(notes_of(comparison))
    assert "ego seed 43, this driver: crashed: the process was killed by SIGSEGV" in told
    assert f"sumo-reactive run {CONFIG} --ego ego --seed 43" in told


def test_one_pair_says_that_it_has_no_interval_and_few_pairs_that_theirs_are_narrow():
    one = Comparison((GOOD,), 600.0)
    assert {row[-1] for row in comparison_rows(one)} == {"none: n = 1"}
    assert notes_of(one) == ["One pair has no interval: give several egos or seeds."]
    two = Comparison((GOOD, pair(side(SUMO, 40.0), side(REACTIVE, 41.0), seed=43)), 600.0)
    assert "Fewer than 10 pairs" in "\n".join(notes_of(two))
    (row,) = (row for row in comparison_rows(two) if row[0] == "duration (s)")
    assert row == ("duration (s)", "2", "35", "37", "+2", "+1 … +3")


def test_the_files_hold_every_value_of_every_pair_and_are_replaced_only_if_asked_for(tmp_path):
    comparison, folder = Comparison((GOOD, pair(CRASHED, CRASHED, seed=43)), 600.0), tmp_path / "new" / "out"
    require_usable(folder, False)
    write(comparison, folder)
    assert sorted(file.name for file in folder.iterdir()) == [CSV_FILE, JSON_FILE]
    lines = list(csv.DictReader(StringIO((folder / CSV_FILE).read_text(encoding="utf-8"))))
    (line,) = (one for one in lines if (one["seed"], one["metric"]) == ("42", "duration_s"))
    assert (line["sumo"], line["reactive"], line["compared"]) == ("30.0", "33.0", "1")
    assert {one["compared"] for one in lines if one["seed"] == "43"} == {"0"}
    data = json.loads((folder / JSON_FILE).read_text(encoding="utf-8"))
    assert data == json.loads(json.dumps(data_of(comparison)))
    assert data["metrics"]["duration_s"] == {
        "n": 1, "sumo": 30.0, "reactive": 33.0, "difference": 3.0, "low": None, "high": None, "method": None,
    }  # fmt: skip
    with pytest.raises(ScenarioError, match=r"holds another comparison \(comparison\.json, comparison\.csv\)"):
        require_usable(folder, False)
    require_usable(folder, True)


def test_an_output_for_several_runs_and_an_ego_that_nobody_knows_are_refused():
    scenario = load_scenario(FOUR_WAY)
    for options in (("--summary", "s.xml"), ("--tripinfo-output=t.xml",), ("--device.emissions.probability", "0")):
        with pytest.raises(ScenarioError, match="cannot be given: a comparison makes several runs"):
            compare([replace(scenario, sumo_options=options)], horizon_s=60.0, jobs=1, wall_limit_s=60.0)
    with pytest.raises(ScenarioError, match="unknown ego 'nobody'"):
        compare([replace(scenario, ego="nobody")], horizon_s=60.0, jobs=1, wall_limit_s=300.0)


@pytest.fixture(scope="module")
def small() -> Comparison:
    """Two seeds of a short scenario under both drivers."""
    scenario = load_scenario(FOUR_WAY)
    return compare([replace(scenario, seed=seed) for seed in (1, 2)], horizon_s=90.0, jobs=2, wall_limit_s=300.0)[0]


def test_the_runs_of_a_comparison_are_the_trials_of_the_scenario(small):
    assert not small.failed
    for pair_ in small.pairs:
        assert pair_.sumo.result is not None and pair_.driven.result is not None
        assert pair_.sumo.result.metrics == run_sumo_driver(pair_.scenario).metrics
        assert pair_.driven.result.metrics == run_trial(pair_.scenario).metrics


def test_both_runs_play_the_same_traffic_to_the_same_time(small):
    for pair_ in small.pairs:
        theirs, ours = pair_.metrics["others_vehicles"]
        assert theirs == ours and theirs is not None and theirs > 10
        assert pair_.sumo.effects is not None
        assert "ego" not in pair_.sumo.effects.arrivals
    assert small.differences["others_co2_kg"].n == 2
    assert csv_of(small).count("\n") == 1 + 2 * len(EGO_METRICS + OTHERS_METRICS)


def test_a_run_whose_ego_is_still_under_way_at_the_horizon_ends_when_the_other_does(tmp_path):
    slow = replace(load_scenario(FOUR_WAY), parameters=Parameters(gap_before_s=6.0))  # waits; SUMO's own takes 33.5 s
    ends, scenario = [], replace(slow, until_end=True, horizon_s=33.6)
    for run in (run_sumo_driver, run_trial):
        totals = tmp_path / f"{run.__name__}.xml"
        result = run(replace(scenario, sumo_options=("--statistic-output", str(totals))))
        ends.append((result.arrived, totals.read_text(encoding="utf-8").partition(' end="')[2].partition('"')[0]))
    assert ends == [(True, "45.60"), (False, "45.60")]
