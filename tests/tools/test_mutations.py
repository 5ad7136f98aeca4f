"""The mutation run on a project of three functions: what its tests notice is known."""

from __future__ import annotations

import importlib.util
import re
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

TOOL = Path(__file__).resolve().parents[2] / "tools" / "mutations.py"
COMPILATION = """
def kernel(function):
    raise RuntimeError("compiled")
"""
SOURCE = """
from sumo_reactive.driver.compilation import kernel

@kernel
def difference(a, b):
    return a - b

def larger(a, b):
    return a if a > b else b

def forgotten(a):
    return a + 1
"""
TESTS = """
from sumo_reactive.driver.pilot.maths import difference, larger

def test_a_difference_is_computed():
    assert difference(5, 3) == 2

def test_the_larger_of_two_is_found():
    assert [larger(1, 2), larger(2, 1), larger(2, 2)] == [2, 2, 2]
"""


def _load() -> ModuleType:
    spec = importlib.util.spec_from_file_location("mutations", TOOL)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """A project with one room of three functions, one of them without a test."""
    for folder in ("sumo_reactive/driver/pilot", "tests/driver/pilot"):
        (tmp_path / folder).mkdir(parents=True)
    for folder in ("sumo_reactive", "sumo_reactive/driver", "sumo_reactive/driver/pilot"):
        (tmp_path / folder / "__init__.py").touch()
    (tmp_path / "sumo_reactive" / "pytest_plugin.py").touch()  # the installed package's entry point names it
    (tmp_path / "sumo_reactive" / "driver" / "compilation.py").write_text(COMPILATION, encoding="utf-8")
    (tmp_path / "sumo_reactive" / "driver" / "pilot" / "maths.py").write_text(SOURCE, encoding="utf-8")
    (tmp_path / "tests" / "driver" / "pilot" / "test_maths.py").write_text(TESTS, encoding="utf-8")
    return tmp_path


def test_what_the_tests_of_a_room_do_not_notice_is_shown_and_counted(project: Path) -> None:
    """Of a > b nobody notices that it is a >= b: the numbers are the same. A sum for the difference is noticed."""
    before = sorted(path.name for path in project.rglob("*"))
    command = [sys.executable, str(TOOL), "--root", str(project), "--room", "driver/pilot", "--count", "100"]
    answer = subprocess.run(command, capture_output=True, encoding="utf-8", timeout=240, check=False)
    assert (answer.returncode, answer.stderr) == (0, "")
    shown = answer.stdout.splitlines()
    assert "-    return a if a > b else b" in shown and "+    return a if a >= b else b" in shown
    assert "+    return a - 1" in shown and "+    return a + 2" in shown
    survivors = [line.rpartition(": ")[2] for line in shown if line.startswith("# sumo_reactive.driver.pilot.maths.")]
    assert sorted(survivors) == ["no tests", "no tests", "survived"]
    score = re.fullmatch(r"driver/pilot +(\d+) of (\d+): (\d+)%", shown[-1])
    assert score is not None
    noticed, of_all, share = (int(number) for number in score.groups())
    assert noticed == of_all - len(survivors) > 0 and share == round(100 * noticed / of_all)
    assert sorted(path.name for path in project.rglob("*")) == before


def test_a_project_whose_tests_fail_is_told(project: Path) -> None:
    tests = project / "tests" / "driver" / "pilot" / "test_maths.py"
    tests.write_text(TESTS.replace("[2, 2, 2]", "[1, 2, 2]"), encoding="utf-8")
    command = [sys.executable, str(TOOL), "--root", str(project), "--room", "driver/pilot"]
    answer = subprocess.run(command, capture_output=True, encoding="utf-8", timeout=240, check=False)
    assert (answer.returncode, answer.stdout) == (1, "")
    assert answer.stderr.startswith("mutmut run failed:")


def test_a_sample_is_spread_over_the_rooms_and_the_same_for_the_same_seed() -> None:
    sampled = _load().sampled
    mutants = {"pilot": [f"p{k}" for k in range(300)], "driver/field": [f"e{k}" for k in range(100)], "sumo": []}
    drawn = sampled(mutants, 40, 1)
    assert {room: len(set(names)) for room, names in drawn.items()} == {"pilot": 30, "driver/field": 10}
    assert drawn == sampled(mutants, 40, 1) != sampled(mutants, 40, 2)
    assert {room: len(names) for room, names in sampled(mutants, 1000, 1).items()} == {"pilot": 300, "driver/field": 100}
