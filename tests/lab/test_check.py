"""Scenario files as tests: which files are some, which cases they hold, and how verdicts are written."""

from pathlib import Path

import pytest
from helpers.results import result
from junitparser import Error, Failure, JUnitXml

from sumo_reactive.errors import ScenarioError
from sumo_reactive.lab.check import cases_of, verdict_on, write_junit
from sumo_reactive.lab.discovery import is_scenario_file, scenario_files
from sumo_reactive.lab.task import Ending, Outcome

ROOT = Path(__file__).parents[2]
CONFIG = (ROOT / "networks" / "roundabout" / "roundabout.sumocfg").as_posix()
SCENARIO = f'[scenario]\nconfig = "{CONFIG}"\nseeds = [3, 1]\n'


def _file(folder, name, text=SCENARIO):
    path = folder / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (SCENARIO, True),
        ("[scenario]\nconfig = \n", True),
        ("scenario = 3\n", False),
        ("[[scenario]]\nconfig = 'a'\n", False),
        ("[tool.x]\nabout = 'the scenario'\n", False),
        ("about = scenario\n", False),
        ("", False),
    ],
)
def test_a_file_with_a_table_scenario_is_one_even_if_it_is_broken(tmp_path, text, expected):
    assert is_scenario_file(_file(tmp_path, "a.toml", text)) is expected


def test_folders_are_searched_and_each_file_counts_once(tmp_path):
    second, first = _file(tmp_path, "b/two.toml"), _file(tmp_path, "a.toml")
    for name in (".hidden/c.toml", "b/__pycache__/d.toml", "b/e.txt"):
        _file(tmp_path, name)
    _file(tmp_path, "pyproject.toml", "[project]\nname = 'scenario'\n")
    assert scenario_files([tmp_path, second, tmp_path / "b" / ".." / "a.toml"]) == [first, second]


@pytest.mark.parametrize(
    ("name", "reason"), [("empty", "no scenario file"), ("gone", "no such file"), ("a.txt", "not a scenario")]
)
def test_a_path_without_a_scenario_gets_one_line(tmp_path, name, reason):
    (tmp_path / "empty").mkdir()
    _file(tmp_path, "a.txt")
    with pytest.raises(ScenarioError, match=f"{name}: {reason}"):
        scenario_files([tmp_path / name])


def test_a_case_a_seed_with_the_command_that_replays_it(tmp_path):
    file = _file(tmp_path, "with space.toml")
    cases = cases_of(file)
    assert [case.scenario.seed for case in cases] == [3, 1]
    assert cases[1].replay == f"sumo-reactive run '{file}' --seed 1"
    assert cases[0].task.scenario == cases[0].scenario


def test_a_trial_that_did_not_end_is_not_met(tmp_path):
    (case, _) = cases_of(_file(tmp_path, "a.toml"))
    verdict = verdict_on(case, Outcome(task=case.task, ending=Ending.TIMEOUT, reason="not done after 5 s"))
    assert (verdict.is_met, verdict.reasons) == (False, ("timeout: not done after 5 s",))


def test_verdicts_are_written_for_any_ci_system(tmp_path):
    (case, other) = cases_of(_file(tmp_path, "a.toml"))
    met = verdict_on(case, Outcome(task=case.task, ending=Ending.DONE, result=result(), wall_s=1.5))
    late = verdict_on(case, Outcome(task=case.task, ending=Ending.DONE, result=result(arrived=False, ended="until 9 s")))
    crashed = verdict_on(other, Outcome(task=other.task, ending=Ending.CRASHED, reason="killed by SIGSEGV"))
    path = tmp_path / "new" / "out.xml"
    write_junit(path, [(met, ""), (late, "did <not> arrive\n\x1bmore"), (crashed, "why")])
    (suite,) = JUnitXml.fromfile(str(path))
    assert (suite.tests, suite.failures, suite.errors) == (3, 1, 1)
    one, two, three = suite
    assert (one.name, one.time, one.is_passed) == ("seed 3", 1.5, True)
    assert isinstance(two.result[0], Failure) and two.result[0].message == "did not arrive (until 9 s)"
    assert "did <not> arrive" in two.result[0].text
    assert isinstance(three.result[0], Error) and "SIGSEGV" in three.result[0].message
