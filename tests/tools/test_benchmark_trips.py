"""The benchmark over a list of trips: its list, its figures, its ranking, and a small benchmark for real."""

from __future__ import annotations

import importlib.util
import json
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from helpers.programs import ROOT, TOOLS, run_tool

from sumo_reactive.errors import ScenarioError

TOOL = TOOLS / "benchmark_trips.py"
CONFIG = "four_way_priority/four_way_priority.sumocfg"


def _load() -> ModuleType:
    spec = importlib.util.spec_from_file_location("benchmark_trips", TOOL)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


bench = _load()
ORDER = bench.Order("a.sumocfg", "ego", 42, None, "records/a__ego__42")
CLEAN = {"collisions": 0, "red_lights_run": 0, "right_of_way_violations": 0}


def outcome(duration: float = 10.0, arrived: bool = True, **figures: float) -> Any:
    """A run that arrived without a fault unless told otherwise."""
    return bench.Outcome(arrived, 0 if arrived else 1, "told", duration, CLEAN | figures, [100.0, 300.0])


def pair(name: str, ours: Any, sumo: Any = None) -> Any:
    """A trip of scenario `name`."""
    return bench.Pair(name, ORDER, ours, sumo)


def trips_in(tmp_path: Path, text: str, only: str = "") -> tuple[Any, ...]:
    """What is chosen of a list with this text; the corpus holds `a.sumocfg`."""
    (tmp_path / "a.sumocfg").touch()
    path = tmp_path / "trips.csv"
    path.write_text(text, encoding="utf-8")
    return tuple(bench.chosen_trips(path, tmp_path, only))


def test_a_percentile_lies_between_its_neighbours_and_nothing_has_none():
    assert bench.percentile([4.0, 1.0, 3.0, 2.0], 50.0) == pytest.approx(2.5)
    assert bench.percentile([1.0, 2.0], 95.0) == pytest.approx(1.95)
    assert bench.percentile([7.0], 99.0) == 7.0
    assert bench.percentile([], 50.0) is None


def test_jerk_over_several_trips_counts_each_second_alike():
    runs = [outcome(30.0, rms_jerk_m_s3=2.0), outcome(10.0, rms_jerk_m_s3=4.0), bench.failure("broken", 70)]
    assert bench.rms_jerk(runs) == pytest.approx(((30.0 * 4.0 + 10.0 * 16.0) / 40.0) ** 0.5)
    assert bench.rms_jerk([bench.failure("broken", 70)]) is None


def test_durations_are_compared_only_where_both_drivers_arrived():
    assert pair("a", outcome(15.0), outcome(10.0)).ratio == pytest.approx(1.5)
    assert pair("a", outcome(15.0), outcome(10.0, arrived=False)).ratio is None
    assert pair("a", outcome(15.0, arrived=False), outcome(10.0)).ratio is None
    assert pair("a", outcome(15.0)).ratio is None


def test_the_worst_did_not_arrive_then_collided_then_broke_rules_then_were_slow():
    ranked = [
        pair("failed", bench.failure("broken", 70)),
        pair("stood", outcome(arrived=False)),
        pair("collided twice", outcome(collisions=2)),
        pair("collided", outcome(collisions=1, red_lights_run=3)),
        pair("broke two rules", outcome(red_lights_run=1, right_of_way_violations=1)),
        pair("broke a rule", outcome(right_of_way_violations=1), outcome(1.0)),
        pair("slow", outcome(20.0), outcome(10.0)),
        pair("quick", outcome(9.0), outcome(10.0)),
    ]
    assert bench.worst(ranked[::-1], len(ranked)) == ranked
    assert len(bench.worst(ranked)) == 5


def test_the_table_has_a_row_of_pairs_and_holds_failed_trips_too():
    row = bench.cells([pair("a", outcome(15.0, collisions=1), outcome(10.0)), pair("a", bench.failure("broken", 70))])
    assert (row["trips"], row["arrived"], row["collisions"]) == ("2", "1 / 1", "1 / 0")
    assert (row["duration / SUMO's p50, p95"], row["step mean µs"]) == ("1.50, 1.50", "200")
    assert row["exit codes"] == "0 ×1, 70 ×1"
    assert bench.cells([pair("a", bench.failure("broken", 70))])["RMS jerk m/s³"] == "–"


def test_every_line_of_the_markdown_table_has_the_same_number_of_cells():
    lines = bench.markdown({"a": bench.cells([pair("a", outcome())])}).replace(r"\|", "").splitlines()
    assert len(lines) == 3
    assert len({line.count("|") for line in lines}) == 1


def test_the_commands_that_replay_a_trip_survive_a_shell():
    order = bench.Order("my corpus/a.sumocfg", "veh#1", 7, 0.05, "out/x")
    told = bench.told(bench.Pair("a", order, outcome(), None))
    replay = "sumo-reactive run 'my corpus/a.sumocfg' --ego 'veh#1' --seed 7 --step-length 0.05 --out out/x --overwrite"
    assert told.splitlines() == ["a veh#1 seed 7: told", f"   {replay}", "   sumo-reactive explain out/x"]


def test_a_trip_that_failed_has_no_record_to_explain():
    assert "explain" not in bench.told(pair("a", bench.failure("two\nlines", 70)))
    assert "a ego seed 42: failed: two lines\n" in bench.told(pair("a", bench.failure("two\nlines", 70)))


def test_the_list_may_hold_more_columns_and_is_filtered_by_scenario_or_ego(tmp_path):
    text = "\ufeffego,scenario,depart_s,config\nx,town,3,a.sumocfg\ny,road,4,a.sumocfg\nz,road,5,gone.sumocfg\n"
    assert trips_in(tmp_path, text, "town") == (bench.Trip("town", "a.sumocfg", "x"),)
    assert trips_in(tmp_path, text, "y") == (bench.Trip("road", "a.sumocfg", "y"),)


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("", "trips.csv: no column 'scenario'; a list of trips has scenario, config, ego"),
        ("scenario,config\ntown,a.sumocfg\n", "trips.csv: no column 'ego'; a list of trips has scenario, config, ego"),
        ("scenario,config,ego\n", "trips.csv: no trip"),
        ("scenario,config,ego\ntown,a.sumocfg,x\ntown,a.sumocfg\n", "trips.csv:3: column 'ego': empty"),
        ("scenario,config,ego\ntown, ,x\n", "trips.csv:2: column 'config': empty"),
        ("scenario,config,ego\ntown,a.sumocfg,x\ntown,a.sumocfg,x\n", "trips.csv:3: column 'ego': the trip of 'x' is"),
        ("scenario,config,ego\ntown,b.sumocfg,x\n", "b.sumocfg: no such file"),
    ],
)  # fmt: skip
def test_a_bad_list_is_refused_in_one_line_that_names_the_place(tmp_path, text, complaint):
    with pytest.raises(ScenarioError) as refusal:
        trips_in(tmp_path, text)
    assert complaint in str(refusal.value)
    assert "\n" not in str(refusal.value)


def test_a_list_that_cannot_be_read_or_holds_no_such_trip_is_refused(tmp_path):
    with pytest.raises(ScenarioError, match=r"none\.csv: cannot be read: No such file"):
        bench.chosen_trips(tmp_path / "none.csv", tmp_path)
    with pytest.raises(ScenarioError, match="no trip whose scenario or ego holds 'moon'"):
        trips_in(tmp_path, "scenario,config,ego\ntown,a.sumocfg,x\n", "moon")
    (tmp_path / "trips.csv").write_bytes(b"scenario,config,ego\n\xff,a,b\n")
    with pytest.raises(ScenarioError, match=r"trips\.csv: cannot be read"):
        bench.chosen_trips(tmp_path / "trips.csv", tmp_path)


def test_ids_that_no_folder_may_be_called_still_get_a_record():
    assert bench.folder_of(bench.Trip("town", "a.sumocfg", "a/b c#1"), 42) == "town__a_b_c#1__42"


def test_a_process_that_hangs_dies_or_fails_is_an_outcome_with_its_error(tmp_path, monkeypatch):
    program = tmp_path / "program.py"
    monkeypatch.setattr(bench, "__file__", str(program))
    ends = {
        "import time; time.sleep(60)": ("took longer than 2 s", 124),
        "import os; os.kill(os.getpid(), 9)": ("the process died of SIGKILL", 137),
        "raise KeyError('x')": ("internal error: KeyError: 'x'", 70),
    }
    for text, (error, exit_code) in ends.items():
        program.write_text(text, encoding="utf-8")
        run = bench.apart(ORDER, 2.0)
        assert (run.error, run.exit_code, run.arrived) == (error, exit_code, False)


def test_wrong_input_ends_with_exit_code_2_and_one_line(tmp_path):
    (tmp_path / "trips.csv").write_text("scenario,ego\n", encoding="utf-8")
    answer = run_tool("benchmark_trips", tmp_path / "trips.csv", tmp_path)
    assert (answer.returncode, answer.stdout) == (2, "")
    assert answer.stderr.startswith(f"benchmark_trips: {tmp_path / 'trips.csv'}: no column 'config'")
    assert answer.stderr.count("\n") == 1


def test_a_small_benchmark_drives_compares_and_survives_a_trip_that_cannot_run(tmp_path):
    trips, figures = tmp_path / "trips.csv", tmp_path / "figures.json"
    trips.write_text(f"scenario,config,ego\ncross,{CONFIG},ego\nghost,{CONFIG},nobody\n", encoding="utf-8")
    asked = (trips, ROOT / "networks", "--out", tmp_path / "records", "--json", figures, "--jobs", 2)
    answer = run_tool("benchmark_trips", *asked)
    assert answer.returncode == 1, answer.stderr
    assert "| cross | 1 | 1 / 1 | 0 / 0 | 0 |" in answer.stdout
    assert "1. ghost nobody seed 42: failed: " in answer.stdout
    assert f"sumo-reactive explain {tmp_path / 'records' / 'cross__ego__42'}" in answer.stdout
    assert (tmp_path / "records" / "cross__ego__42" / "summary.json").is_file()
    assert "[4/4] " in answer.stderr
    _hold_both_drivers(json.loads(figures.read_text(encoding="utf-8")))


def _hold_both_drivers(data: dict[str, Any]) -> None:
    cross, ghost = data["trips"]
    assert cross["ours"]["verdict"] == "arrived without a violation"
    assert cross["duration_ratio"] == pytest.approx(cross["ours"]["duration_s"] / cross["sumo"]["duration_s"], abs=1e-3)
    assert 0.0 < cross["sumo"]["figures"]["max_lateral_acceleration_m_s2"] < 20.0
    assert "unknown ego 'nobody'" in ghost["ours"]["error"]
    assert data["all"]["exit_codes"] == {"0": 1, "2": 1}
    assert data["scenarios"]["cross"]["control_step_mean_us"] > 0.0
