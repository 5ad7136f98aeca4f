"""Metrics of the user's own: named in files, measured in runs, told where they fail."""

import json
from importlib.metadata import EntryPoint, EntryPoints

import duckdb
import numpy as np
import pytest
from helpers.programs import ROOT, sumo_reactive
from helpers.results import result
from scenes import drive, record, user

from sumo_reactive.errors import ScenarioError
from sumo_reactive.lab import own_metrics
from sumo_reactive.lab.batch.experiment import load_experiment
from sumo_reactive.lab.batch.store_file import StoreFile
from sumo_reactive.lab.batch.trials import key_of, trials_of
from sumo_reactive.lab.check import unmet
from sumo_reactive.lab.fault import MetricFailure
from sumo_reactive.lab.metrics.jury import Jury
from sumo_reactive.lab.own_metrics import GROUP, TAKEN, function_of, measured, merged, metric_source
from sumo_reactive.lab.result import rows_of, summary_of
from sumo_reactive.lab.scenario import Expectation, load_scenario, load_scenario_file
from sumo_reactive.lab.task import Task

FOUR_WAY = ROOT / "networks" / "four_way_priority" / "four_way_priority.sumocfg"
MODULE = """
from __future__ import annotations
from dataclasses import dataclass
import numpy as np

LIMIT = 3

def fastest_m_s(trajectory, encounters):
    return np.max(trajectory["speed_m_s"])

@dataclass
class Peak:
    value: float

def is_fast(trajectory, encounters):
    return (Peak(trajectory["speed_m_s"]).value > 1.0).all()

def nobody(trajectory, encounters):
    return None

def breaks_in_numpy(trajectory, encounters):
    return np.max(encounters["time_s"][:0])

def breaks(trajectory, encounters):
    return len(encounters["no such column"])

def gives_text(trajectory, encounters):
    return "fast"

def fails_at_length(trajectory, encounters):
    raise ValueError("no " * 10_000)

def gives_nan(trajectory, encounters):
    return float("nan")

def spoils(trajectory, encounters):
    trajectory["speed_m_s"][:] = 0.0
    return 0

def near(trajectory, encounters):
    return len(encounters["time_s"])

def duration_s(trajectory, encounters):
    return 0
"""
HEAD = f'[scenario]\nconfig = "{FOUR_WAY}"\nego = "ego"\n'


@pytest.fixture
def folder(tmp_path):
    """A folder with a module of metrics."""
    (tmp_path / "mine.py").write_text(MODULE, encoding="utf-8")
    return tmp_path


def scenario(folder, *names, expect=""):
    """Write a scenario that names metrics; return its file."""
    file = folder / "a.toml"
    listed = ", ".join(f'"{name}"' for name in names)
    file.write_text(f"{HEAD}metrics = [{listed}]\n{expect}", encoding="utf-8")
    return file


def figures_of(folder, *names):
    """Return the figures and failures of a drive at 5 to 6 m/s behind another."""
    sources = [metric_source(f"mine:{name}", folder) for name in names]
    jury = Jury(5.0, 1.8, 3.0, sources)
    drive(jury, lambda t: record(t, x=5.0 * t, speed=5.0 + t), lambda t: [user(x=30.0, speed=5.0)], 11)
    return jury.own_figures()


def test_a_metric_gets_the_trajectory_and_the_encounters_as_columns(folder):
    figures, failures = figures_of(folder, "fastest_m_s", "near", "nobody", "is_fast")
    assert figures == {"fastest_m_s": pytest.approx(6.0), "near": 11, "nobody": None, "is_fast": 1.0}
    assert failures == ()


def test_a_metric_that_spoils_its_columns_spoils_no_others(folder):
    assert figures_of(folder, "spoils", "fastest_m_s")[0]["fastest_m_s"] == pytest.approx(6.0)


@pytest.mark.parametrize(
    ("name", "why"),
    [
        ("breaks", "KeyError: 'no such column' (mine.py:25)"),
        ("breaks_in_numpy", "ValueError: zero-size array to reduction operation maximum which has no identity (mine.py:22)"),
        ("gives_text", "ValueError: gave 'fast', which is no number up to 1e+12"),
        ("gives_nan", "ValueError: gave nan, which is no number up to 1e+12"),
    ],
)
def test_a_metric_that_fails_is_told_with_its_own_traceback_and_the_others_are_there(folder, name, why):
    figures, (failure,) = figures_of(folder, name, "fastest_m_s")
    assert (figures[name], figures["fastest_m_s"]) == (None, pytest.approx(6.0))
    assert (failure.name, failure.why) == (name, why)
    assert str(failure) == f"metric '{name}' failed: {why}"
    assert failure.traceback[-1] == why.partition(" (mine")[0]
    assert not any("own_metrics.py" in line for line in failure.traceback)


def test_of_a_long_story_of_a_failure_the_begin_is_told(folder):
    (failure,) = figures_of(folder, "fails_at_length")[1]
    assert failure.why.startswith("ValueError: no no ") and failure.why.endswith("(mine.py:31)") and len(failure.why) < 400


def test_a_failed_metric_is_a_verdict_and_no_fault_of_the_driver():
    failed = result(metric_failures=(MetricFailure("mine", "KeyError: 'a' (mine.py:3)"),))
    assert failed.exit_code == 1
    assert failed.verdict == "arrived without a violation; metric 'mine' failed: KeyError: 'a' (mine.py:3)"
    assert tuple(unmet(Expectation(), failed)) == ("metric 'mine' failed: KeyError: 'a' (mine.py:3)",)
    assert summary_of(failed)["metric_failures"] == [{"name": "mine", "why": "KeyError: 'a' (mine.py:3)", "traceback": ()}]


def test_an_own_metric_is_told_by_its_name_with_the_unit_that_its_name_ends_in():
    rows = dict(rows_of(result(figures={"jerk_at_stops_m_s3": 1.5})))
    assert rows["jerk_at_stops_m_s3 (m/s³)"] == "1.500 m/s³"


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        ("mine:fastest", "mine.py has no function 'fastest'; near it: fastest_m_s"),
        ("mine:LIMIT", "'LIMIT' of mine.py is no function"),
        ("mine:duration_s", "cannot be called 'duration_s': there is one already"),
        ("mine:seed", "cannot be called 'seed': there is one already"),
        ("mine:" + "x" * 65, "letters, digits and underscores, 64 at most"),
        ("yours:fastest", "no module 'yours' beside the file or on Python's path"),
        ("../mine:fastest_m_s", "'../mine:fastest_m_s' is not 'module:function'"),
        ("mine:", "'mine:' is not 'module:function'"),
        ("sys:exit", "module 'sys' has no source of its own"),
        ("durations", "unknown metric 'durations'; near it: duration_s"),
    ],
)
def test_what_cannot_be_a_metric_is_told_with_its_line(folder, asked, said):
    file = scenario(folder, "mine:near", asked)
    with pytest.raises(ScenarioError) as raised:
        load_scenario(file)
    assert str(raised.value).startswith(f"{file}:4: key 'scenario.metrics.1': ")
    assert said in str(raised.value) and "\n" not in str(raised.value)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("import no_such_module\n", "ModuleNotFoundError: No module named 'no_such_module' (broken.py:1)"),
        ("def f(:\n", "SyntaxError: "),
        ("raise SystemExit(3)\n", "SystemExit: 3 (broken.py:1)"),
        ("import math\nmath.nothing\n", "AttributeError: module 'math' has no attribute 'nothing' (broken.py:2)"),
    ],
)
def test_a_module_that_cannot_be_loaded_is_one_line(folder, text, said):
    (folder / "broken.py").write_text(text, encoding="utf-8")
    with pytest.raises(ScenarioError) as raised:
        load_scenario(scenario(folder, "broken:f"))
    assert f"broken cannot be loaded: {said}" in str(raised.value) and "\n" not in str(raised.value)


def test_without_the_key_no_code_beside_a_file_is_run(folder):
    (folder / "mine.py").write_text("raise SystemExit(3)\n", encoding="utf-8")
    (folder / "a.toml").write_text(HEAD, encoding="utf-8")
    assert load_scenario(folder / "a.toml").metrics == ()


def test_a_module_may_import_what_lies_beside_it_and_two_folders_may_have_one_of_the_same_name(tmp_path):
    found = []
    for k in (1, 2):
        own = tmp_path / str(k)
        own.mkdir()
        (own / f"helper_{k}.py").write_text(f"VALUE = {k}\n", encoding="utf-8")
        (own / "same.py").write_text(f"from helper_{k} import VALUE\ndef f(*_):\n    return VALUE\n", encoding="utf-8")
        found.append(metric_source("same:f", own))
    assert [measured([one], [], {})[0] for one in found] == [{"f": 1.0}, {"f": 2.0}]
    with pytest.raises(ScenarioError, match="two metrics are called 'f'"):
        merged(found)


def test_a_module_that_has_changed_since_is_not_run(folder):
    source = metric_source("mine:near", folder)
    (folder / "mine.py").write_text(MODULE + "\n", encoding="utf-8")
    function_of.cache_clear()
    with pytest.raises(ScenarioError, match="has changed since"):
        function_of(source)


def test_a_metric_of_an_installed_package_is_named_without_a_module(folder, monkeypatch):
    entry = EntryPoint("largest_gap_m", "sumo_reactive.lab.own_metrics:own_metrics", GROUP)
    monkeypatch.setattr(own_metrics, "entry_points", lambda **asked: EntryPoints([entry]).select(**asked))
    (source,) = load_scenario(scenario(folder, "largest_gap_m")).metrics
    assert (source.name, source.module, source.folder) == ("largest_gap_m", "sumo_reactive.lab.own_metrics", None)
    with pytest.raises(ScenarioError, match=r"unknown metric 'largest_gap'; near it: largest_gap_m"):
        load_scenario(scenario(folder, "largest_gap"))


def test_an_expectation_may_name_an_own_metric_and_no_unknown_one(folder):
    file = scenario(folder, "mine:near", expect="[expect.metrics]\nnear = { max = 3 }\n")
    assert load_scenario_file(file).expectation.metrics["near"].max == 3
    file = scenario(folder, "mine:near", expect="[expect.metrics]\nneat = { max = 3 }\n")
    with pytest.raises(ScenarioError, match=r"a.toml:6: key 'expect.metrics.neat': unknown metric 'neat'; near it: near"):
        load_scenario_file(file)


def test_an_experiment_measures_its_own_metrics_in_every_scenario(folder):
    scenario(folder, "mine:near")
    (folder / "e.toml").write_text('[experiment]\nscenarios = ["a.toml"]\nmetrics = ["arrived", "mine:nobody", "near"]\n')
    experiment = load_experiment(folder / "e.toml")
    assert experiment.keys.metrics == ["arrived", "nobody", "near"]
    assert [source.name for source in experiment.choices[0].scenario.metrics] == ["near", "nobody"]


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ('metrics = ["mine:far"]\n', "key 'experiment.metrics.0': mine.py has no function 'far'; near it: near"),
        ('metrics = ["mine:near"]\n[egos]\nshare = [0.5]\n', "there is none with a 'share'"),
    ],
)
def test_an_own_metric_that_an_experiment_cannot_have_is_told(folder, more, said):
    scenario(folder)
    (folder / "e.toml").write_text(f'[experiment]\nscenarios = ["a.toml"]\n{more}')
    with pytest.raises(ScenarioError) as raised:
        load_experiment(folder / "e.toml")
    assert said in str(raised.value)


def test_the_source_of_a_metric_is_in_the_key_of_a_trial(folder):
    keys = []
    for text in (MODULE, MODULE, MODULE + "\n"):
        (folder / "mine.py").write_text(text, encoding="utf-8")
        keys.append(key_of(Task(load_scenario(scenario(folder, "mine:near")))))
    keys.append(key_of(Task(load_scenario(scenario(folder)))))
    assert keys[0] == keys[1] and len(set(keys)) == 3


def test_a_run_with_a_share_of_egos_measures_no_own_metrics(folder):
    scenario(folder, "mine:near")
    (folder / "e.toml").write_text('[experiment]\nscenarios = ["a.toml"]\n[egos]\nshare = [0.5]\n', encoding="utf-8")
    trials = trials_of(load_experiment(folder / "e.toml"), lambda _: [])
    assert [one.task.scenario.metrics for one in trials] == [()] * len(trials) != []


def test_no_own_metric_is_called_as_a_column_of_a_trial(tmp_path):
    with StoreFile(tmp_path / "s.duckdb", read_only=False) as store:
        columns = {name for (name,) in store.rows("SELECT column_name FROM duckdb_columns() WHERE table_name = 'trials'")}
    assert columns <= TAKEN


def test_an_own_metric_is_expected_by_check_and_its_failure_is_no_pass(folder):
    expect = "[expect.metrics]\nfastest_m_s = { max = 1.0 }\n"
    answer = sumo_reactive("check", scenario(folder, "mine:fastest_m_s", "mine:breaks", expect=expect))
    assert answer.returncode == 1
    assert "metric 'breaks' failed: KeyError: 'no such column' (mine.py:25); fastest_m_s is " in answer.stdout
    assert "expected at most 1" in answer.stdout
    assert 'return len(encounters["no such column"])' in answer.stdout


def test_an_own_metric_is_a_column_of_a_batch_for_both_drivers_and_on_its_page(folder):
    scenario(folder)
    (folder / "e.toml").write_text('[experiment]\nscenarios = ["a.toml"]\nmetrics = ["arrived", "mine:fastest_m_s"]\n')
    answer = sumo_reactive("batch", folder / "e.toml")
    assert answer.returncode == 0, answer.stdout + answer.stderr
    with duckdb.connect(str(folder / "e.duckdb"), read_only=True) as database:
        values = dict(database.execute(
            "SELECT driver, value FROM metrics JOIN trials USING (key) WHERE name = 'fastest_m_s'"
        ).fetchall())  # fmt: skip
    assert sorted(values) == ["reactive", "sumo"] and min(values.values()) > 5.0
    assert "fastest_m_s" in sumo_reactive("results", folder / "e.duckdb").stdout
    assert r"fastest\_m\_s (m/s)" in sumo_reactive("table", folder / "e.duckdb").stdout
    assert sumo_reactive("report", folder / "e.duckdb").returncode == 0
    assert "fastest_m_s (m/s)" in (folder / "e.html").read_text(encoding="utf-8")


def test_a_run_tells_the_traceback_of_a_metric_that_failed_and_ends_with_1(folder):
    file = scenario(folder, "mine:breaks")
    for more in ((), ("--quiet",), ("--ego", "ego", "--ego", "west_east.0", "--until", "30")):
        answer = sumo_reactive("run", file, *more)
        assert answer.returncode == 1
        assert answer.stderr.count("Traceback") == answer.stderr.count("KeyError: 'no such column'") == 1
        assert "metric 'breaks' failed: KeyError" in answer.stdout


def test_a_run_tells_an_own_metric_and_records_the_encounters(folder):
    answer = sumo_reactive("run", scenario(folder, "mine:near"), "--out", folder / "out")
    assert answer.returncode == 0, answer.stderr
    summary = json.loads((folder / "out" / "summary.json").read_text(encoding="utf-8"))
    (rows,) = duckdb.sql(f"SELECT count(*) FROM '{folder / 'out' / 'encounters.parquet'}'").fetchall()[0]
    assert summary["figures"]["near"] == rows > 0
    assert np.isfinite(summary["figures"]["max_drac_m_s2"])
