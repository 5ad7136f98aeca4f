"""The comparison of the profiles: a small case for real, its table and its file."""

import json

import pytest
from helpers.programs import numbers_in, run_tool

from sumo_reactive.lab.metric_names import METRICS


@pytest.fixture(scope="module")
def compared(tmp_path_factory):
    file = tmp_path_factory.mktemp("profiles") / "figures.json"
    return run_tool("compare_profiles", "right_before_left", "--json", file), file


def test_a_scenario_is_driven_with_both_profiles_and_told_in_a_table(compared):
    answer, _ = compared
    assert answer.returncode == 0, answer.stderr
    assert answer.stdout.startswith("default: 42 commands, δt = 0.1 s, exact distances; paper: 9 commands, δt = 0.5 s")
    head, _, row = (line for line in answer.stdout.splitlines()[2:5])
    titles = [METRICS[key].title for key in ("rms_jerk_m_s3", "max_braking_m_s2", "duration_s", "emergencies")]
    assert all(f"| {title} |" in head for title in titles)
    assert row.startswith("| right_before_left | ") and row.count("|") == head.count("|")
    times = answer.stdout.splitlines()[-1]
    assert times.startswith("| right_before_left | ") and min(numbers_in(times)) > 0.0


def test_the_file_holds_the_figures_of_the_table(compared):
    answer, file = compared
    found = json.loads(file.read_text(encoding="utf-8"))["scenarios"]["right_before_left"]
    assert {one["verdict"] for one in found.values()} == {"arrived without a violation"}
    assert f"| {found['default']['duration_s']:.1f} / {found['paper']['duration_s']:.1f} |" in answer.stdout
    assert found["default"]["rms_jerk_m_s3"] < found["paper"]["rms_jerk_m_s3"]


def test_a_scenario_that_is_not_there_is_named():
    answer = run_tool("compare_profiles", "atlantis")
    assert (answer.returncode, answer.stdout) == (2, "")
    assert "no scenario named atlantis" in answer.stderr
