"""The record of a run: complete or not there at all."""

import json
import math

import duckdb
import pytest
from scenes import record

from sumo_reactive.errors import ScenarioError
from sumo_reactive.experiment.recorder import Recorder, decision_lines
from sumo_reactive.experiment.result import Collision, TrialResult, Violation
from sumo_reactive.experiment.summary import rows_of
from sumo_reactive.experiment.trajectory import COLUMNS
from sumo_reactive.messages.decision import Behaviour, Decision, Reason
from sumo_reactive.messages.record import Scene, StepRecord


def result(**others):
    values = {
        "scenario": "a.sumocfg",
        "ego": "cab",
        "chosen": "as named",
        "seed": 42,
        "step_length_s": 0.1,
        "profile": "default",
        "arrived": True,
        "ended": "arrived",
        "begin_s": 0.0,
        "departure_s": 5.0,
        "end_s": 35.0,
        "time_loss_s": 3.0,
        "distance_m": 200.0,
        "figures": {"min_time_to_collision_s": math.inf, "collisions": 0},
    }
    return TrialResult(**(values | others))


def recorded(folder, **options):
    recorder = Recorder(folder, **options)
    for k in range(3):
        recorder.see(Scene(record(0.1 * k, x=float(k)), ()))
    recorder.write(result())


def test_the_exit_code_and_the_verdict_follow_from_what_happened():
    assert (result().exit_code, result().verdict) == (0, "arrived without a violation")
    hit = result(collisions=(Collision(41.3, "veh_12", "a_0"),))
    assert (hit.exit_code, hit.verdict) == (1, "collision with veh_12 at 41.3 s")
    assert result(violations=(Violation(3.0, "red light run", "a_0"),)).verdict == "red light run at 3.0 s"
    assert result(arrived=False, ended="until 60 s").verdict == "did not arrive (until 60 s)"


def test_the_rows_name_verdict_and_overrides():
    rows = dict(rows_of(result(overrides=(("random", "true", "false"),))))
    assert rows["ego"] == "cab (as named)"
    assert rows["override random"] == "true → false"


def test_a_record_has_three_files_and_nothing_beside_them(tmp_path):
    recorded(tmp_path / "deep" / "out")
    assert [path.name for path in (tmp_path / "deep").iterdir()] == ["out"]
    names = sorted(path.name for path in (tmp_path / "deep" / "out").iterdir())
    assert names == ["decisions.jsonl", "summary.json", "trajectory.parquet"]
    summary = json.loads((tmp_path / "deep" / "out" / "summary.json").read_text(encoding="utf-8"))
    assert (summary["exit_code"], summary["duration_s"]) == (0, 30.0)
    assert summary["figures"]["min_time_to_collision_s"] is None


def test_the_trajectory_has_a_row_a_step_and_a_column_a_field(tmp_path):
    assert set(COLUMNS) == set(StepRecord._fields) - {"decisions"}
    recorded(tmp_path / "it's")
    table = duckdb.read_parquet(str(tmp_path / "it's" / "trajectory.parquet"))
    assert table.columns == list(COLUMNS.values())
    assert table.select("time_s, x_m, lane_id, gap_m").fetchall()[1] == (0.1, 1.0, "road_0", None)


def test_a_run_without_steps_can_be_recorded(tmp_path):
    Recorder(tmp_path / "out").write(result(arrived=False))
    assert duckdb.read_parquet(str(tmp_path / "out" / "trajectory.parquet")).fetchall() == []


def test_another_run_is_kept_unless_overwriting_is_asked_for(tmp_path):
    recorded(tmp_path / "out")
    (tmp_path / "out" / "tripinfo.xml").touch()
    with pytest.raises(ScenarioError, match="holds another run"):
        recorded(tmp_path / "out")
    recorded(tmp_path / "out", overwrite=True)
    assert (tmp_path / "out" / "tripinfo.xml").exists()


def test_an_empty_folder_is_fine_and_a_file_is_not(tmp_path):
    (tmp_path / "empty").mkdir()
    recorded(tmp_path / "empty")
    (tmp_path / "file").touch()
    with pytest.raises(ScenarioError, match="a file, not a folder"):
        Recorder(tmp_path / "file")
    with pytest.raises(ScenarioError, match="cannot be written"):
        Recorder(tmp_path / "file" / "out")


def test_a_record_that_fails_leaves_nothing(tmp_path):
    recorder = Recorder(tmp_path / "out")
    with pytest.raises(TypeError):
        recorder.write(result(figures={"x": object()}))
    assert list(tmp_path.iterdir()) == []


def test_decisions_are_written_where_they_change_and_where_an_emergency_begins():
    red = Decision(Behaviour.CAUTIOUS, Reason.RED_LIGHT, "r", "tl", figures=(("gap_m", 10.0),))
    nearer = Decision(Behaviour.CAUTIOUS, Reason.RED_LIGHT, "r", "tl", figures=(("gap_m", 9.0),))
    steps = [
        record(0.0),
        record(0.1, decisions=(red,)),
        record(0.2, decisions=(nearer,)),
        record(0.3, decisions=(nearer,), emergency=True),
        record(0.4, decisions=(nearer,), emergency=True),
        record(0.5),
    ]
    lines = list(decision_lines(steps))
    assert [line["time_s"] for line in lines] == [0.0, 0.1, 0.3, 0.5]
    assert lines[1]["decisions"][0]["reason"] == "the light is red"
    assert lines[2]["emergency"] is True
