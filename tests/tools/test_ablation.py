"""What driving loses without a mechanism: a small case for real, and the sign of what is lost; the counting by hand."""

import pytest
from helpers.programs import TOOLS, run_tool
from helpers.tools import tool

from sumo_reactive.driver.parameters import Parameters


@pytest.fixture(scope="module")
def told(tmp_path_factory):
    file = tmp_path_factory.mktemp("ablation") / "table.md"
    mechanisms = ("u3", "graph", "rear", "events")
    return run_tool("ablation", "--only", "four_way", "--without", *mechanisms, "--write", file), file


@pytest.fixture
def ablation(monkeypatch):
    monkeypatch.syspath_prepend(str(TOOLS))
    return tool("ablation")


def cells(text, title):
    """Return the losses of a row by the title of their column."""
    rows = [[cell.strip(" *") for cell in line.split("|")[1:-1]] for line in text.splitlines() if line.startswith("|")]
    row = next(row for row in rows if row[0].startswith(title))
    return dict(zip(rows[0][1:], map(float, row[1:]), strict=True))


def test_without_a_desired_speed_the_ego_does_not_arrive(told):
    answer, _ = told
    assert answer.returncode == 0, answer.stderr
    lost = cells(answer.stdout, "U₃")
    assert lost["arrivals"] == 1 and lost["time (s)"] > 1.0


def test_without_the_regions_ahead_the_ego_yields_to_nobody(told):
    lost = cells(told[0].stdout, "labelled graph")
    assert lost["violations"] + lost["contacts"] > 0 > lost["standstill (s)"]


def test_without_events_the_pilot_runs_more_often(told):
    assert cells(told[0].stdout, "events")["pilot runs (×)"] > 2.0


def test_without_u2_or_the_static_obstacles_somebody_is_passed_nearer():
    answer = run_tool("ablation", "--only", " be", "--without", "u2", "beta")
    assert answer.returncode == 0, answer.stderr
    assert cells(answer.stdout, "U₂")["clearance (m)"] > 0.2
    assert cells(answer.stdout, "β")["clearance (m)"] > 0.05


def test_a_mechanism_that_is_not_there_loses_nothing(told):
    lost = cells(told[0].stdout, "rear control point")
    assert lost.pop("pilot runs (×)") == 1.0 and set(lost.values()) == {0.0}
    assert "**rear control point R (§3.3.1)**: carries no weight yet." in told[0].stdout


def test_the_last_line_counts_and_the_file_holds_the_table(told):
    answer, file = told
    assert answer.stdout.splitlines()[-1] == "3 of 4 mechanisms carry weight"
    assert file.read_text(encoding="utf-8").endswith(answer.stdout)


def test_a_loss_up_to_its_threshold_is_not_missed(ablation):
    whole = {"a": dict(ablation.NOTHING, arrived=1.0, duration_s=30.0, clearance_m=0.8)}
    slower = {"a": whole["a"] | {"duration_s": 31.0}}
    assert ablation.missed(ablation.losses(whole, slower)) == []
    worse = {"a": whole["a"] | {"duration_s": 31.5, "clearance_m": 0.7, "collisions": 1.0}}
    assert ablation.missed(ablation.losses(whole, worse)) == ["1 more contacts", "1.5 s more", "passes 0.10 m nearer"]


def test_every_mechanism_of_the_driver_is_taken_out_by_one_row_and_every_value_exists(ablation):
    asked = [one.parameters for one in ablation.ABLATIONS if one.parameters]
    left_out = [Parameters.of(one).without for one in asked]
    assert sorted(one for one in left_out if one) == sorted(set(ablation.Mechanism) - {ablation.Mechanism.NONE})


def test_an_unknown_run_or_mechanism_is_named():
    answer = run_tool("ablation", "--only", "atlantis")
    assert (answer.returncode, answer.stdout) == (2, "")
    assert "no run whose name holds 'atlantis'" in answer.stderr
    answer = run_tool("ablation", "--without", "luck")
    assert (answer.returncode, answer.stdout) == (2, "")
    assert "luck" in answer.stderr
