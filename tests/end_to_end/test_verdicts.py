"""Scenario files as tests: `check` and `pytest` say the same, a failure is readable, and what it names replays it."""

import shlex
import subprocess
import sys
from pathlib import Path

import pytest
from junitparser import JUnitXml

from sumo_reactive.lab.metric_names import METRICS
from sumo_reactive.lab.scenario import load_scenario
from sumo_reactive.lab.simulation import run_trial

ROOT = Path(__file__).resolve().parents[2]
CONFIG = (ROOT / "networks" / "four_way_priority" / "four_way_priority.sumocfg").as_posix()
HEAD = f'[scenario]\nconfig = "{CONFIG}"\nego = "ego"\nuntil_s = 120.0\n'
FILES = {
    "clean.toml": f"{HEAD}seeds = [42, 1]\n",
    "deep/impossible.toml": f"{HEAD}[expect.metrics]\nduration_s = {{ max = 5 }}\n",
    "impatient.toml": f"{HEAD}parameters = {{ STUCK_S = 1 }}\n",
    "nobody.toml": HEAD.replace('ego = "ego"', 'ego = "nobody"'),
    "pyproject.toml": "[tool.other]\nabout = 'a scenario'\n",
}
FAILED = {"impossible", "impatient", "nobody"}


def run(folder, *command):
    whole = [sys.executable, "-m", *map(str, command)]
    return subprocess.run(whole, cwd=folder, capture_output=True, text=True, encoding="utf-8", timeout=300, check=False)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder with scenarios of every kind, checked once."""
    place = tmp_path_factory.mktemp("scenarios")
    for name, text in FILES.items():
        (place / name).parent.mkdir(exist_ok=True)
        (place / name).write_text(text, encoding="utf-8")
    return place


@pytest.fixture(scope="module")
def checked(folder):
    return run(folder, "sumo_reactive", "check", ".", "--junit", "out/check.xml")


@pytest.fixture(scope="module")
def tested(folder):
    return run(folder, "pytest", ".", "-p", "no:cacheprovider", "--junitxml", "out/pytest.xml")


def verdicts(file):
    """Return whether each case of a JUnit file passed, by the last part of its class and its name."""
    cases = [case for suite in JUnitXml.fromfile(str(file)) for case in suite]
    return {(case.classname.removesuffix(".toml").split(".")[-1], case.name): case.is_passed for case in cases}


def test_both_give_the_same_verdicts(folder, checked, tested):
    assert (checked.returncode, tested.returncode) == (1, 1), checked.stdout + checked.stderr + tested.stdout
    found = verdicts(folder / "out" / "check.xml")
    assert found == verdicts(folder / "out" / "pytest.xml")
    assert found == {(Path(name).stem, "seed 42"): Path(name).stem not in FAILED for name in list(FILES)[:4]} | {
        ("clean", "seed 1"): True
    }


@pytest.mark.parametrize(
    "line",
    [
        "duration_s is 3",
        "expected at most 5",
        "did not arrive (stood still for 1 s",
        "has priority",
        "nobody",
        "replay: sumo-reactive run deep/impossible.toml --seed 42",
    ],
)
def test_a_failure_tells_reason_trace_and_replay_not_a_stack(checked, tested, line):
    for answer in (checked, tested):
        assert line in answer.stdout
        assert "Traceback" not in answer.stdout + answer.stderr and ".py:" not in answer.stdout + answer.stderr


def test_the_replay_meets_the_same_fate(folder, checked):
    (command,) = {line.strip() for line in checked.stdout.splitlines() if "run impatient.toml" in line}
    program, *arguments = shlex.split(command.removeprefix("replay: "))
    answer = run(folder, program.replace("-", "_"), *arguments, "--quiet")
    assert (answer.returncode, "stood still for 1 s" in answer.stdout) == (1, True)


def test_cases_can_be_chosen_and_shared_out(folder):
    chosen = run(folder, "pytest", ".", "-p", "no:cacheprovider", "-n", "2", "-k", "clean or (impossible and 42)")
    assert "1 failed, 2 passed" in chosen.stdout


def test_a_scenario_that_cannot_be_run_is_one_line(tmp_path):
    (tmp_path / "bad.toml").write_text(f"{HEAD}sped = 3\n", encoding="utf-8")
    (tmp_path / "good.toml").write_text(HEAD, encoding="utf-8")
    checked, tested = (run(tmp_path, *command) for command in (("sumo_reactive", "check", "."), ("pytest", ".")))
    line = "bad.toml:5: unknown key 'scenario.sped'; near it: seed"
    assert (checked.returncode, checked.stderr) == (2, f"sumo-reactive: {line}, seeds\n")
    assert tested.returncode == 2 and line in tested.stdout
    assert "Traceback" not in tested.stdout


def test_the_plugin_loads_nothing_heavy_and_leaves_other_files_alone(tmp_path):
    (tmp_path / "pyproject.toml").write_text("[tool.other]\nscenario = 3\n", encoding="utf-8")
    heavy = "{'numpy', 'numba', 'pydantic', 'libsumo', 'typer'}"
    test = f"import sys\n\n\ndef test_it():\n    assert {heavy} & set(sys.modules) == set()\n"
    (tmp_path / "test_it.py").write_text(test, encoding="utf-8")
    answer = run(tmp_path, "pytest", ".", "-p", "no:cacheprovider", "-p", "no:hypothesispytest", "-p", "no:benchmark")
    assert (answer.returncode, "1 passed" in answer.stdout) == (0, True), answer.stdout


def test_a_trial_has_the_metrics_that_can_be_named():
    result = run_trial(load_scenario(ROOT / "scenarios" / "four_way_priority.toml"))
    assert set(result.metrics) == set(METRICS)
