"""The README is true: its commands and examples run, and its tables name what the tree holds."""

from __future__ import annotations

import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from sumo_reactive.driver.vehicle.limits import VehicleLimits
from sumo_reactive.lab.columns import COLUMNS
from sumo_reactive.sumo.launch import OVERRIDES

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "sumo_reactive"
README = (ROOT / "README.md").read_text(encoding="utf-8")
EXAMPLE_LINES = 20
EXAMPLE_SECONDS = 240


def blocks(language: str) -> list[str]:
    """Return the code blocks of a language, in order."""
    return re.findall(rf"^```{language}\n(.*?)^```$", README, re.DOTALL | re.MULTILINE)


def rooms() -> list[str]:
    """Return the folders of the package that hold modules, from its root."""
    inits = sorted(PACKAGE.rglob("__init__.py"))
    return [str(init.parent.relative_to(PACKAGE).as_posix()) for init in inits if init.parent != PACKAGE]


def modules_of(room: str) -> set[str]:
    """Return the names of a room's modules."""
    return {file.stem for file in (PACKAGE / room).glob("*.py")} - {"__init__"}


def told_of(room: str) -> set[str]:
    """Return the modules that the README's table of rooms names: the last cell of the room's row."""
    row = re.search(rf"^\|.*\| `{re.escape(room)}/` \|.*\| (.*) \|$", README, re.MULTILINE)
    return set(row[1].split(" · ")) if row else set()


def test_the_first_command_sets_up_its_own_environment_and_drives_a_scenario_of_this_repository():
    (line,) = blocks("sh")[0].splitlines()
    setup, install, run = line.split(" && ")
    assert (setup, install) == ("python3 -m venv .venv", ".venv/bin/pip install -q .")
    program, command, scenario = run.split()
    assert (program, command) == (".venv/bin/sumo-reactive", "run")
    assert (ROOT / scenario).is_file()


def test_the_continuous_integration_runs_the_second_command():
    (line,) = blocks("sh")[1].splitlines()
    script = (ROOT / ".ci" / "run").read_text(encoding="utf-8")
    assert script.splitlines()[-1] == line
    assert (ROOT / ".ci" / "run").stat().st_mode & 0o111


@pytest.mark.parametrize("number", range(len(blocks("python"))))
def test_an_example_runs_as_it_is_printed_and_prints_something(number):
    example = blocks("python")[number]
    assert len([line for line in example.splitlines() if line.strip()]) <= EXAMPLE_LINES
    command = [sys.executable, "-c", example]
    answer = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=EXAMPLE_SECONDS, check=False)
    assert (answer.returncode, answer.stderr) == (0, "")
    assert answer.stdout.strip()


@pytest.mark.parametrize("room", rooms())
def test_the_picture_of_the_house_names_every_file_of_a_room(room):
    assert told_of(room) == modules_of(room)


@pytest.mark.parametrize("name", sorted(modules_of(".") - {"__main__"}))
def test_the_picture_of_the_house_names_every_file_above_the_rooms(name):
    assert re.search(rf"^\|.*`{name}\.py`", README, re.MULTILINE)


def test_every_dependency_is_named_with_its_reason():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    wanted = [*project["dependencies"], *(one for extra in project["optional-dependencies"].values() for one in extra)]
    names = {re.match(r"[\w-]+", one)[0] for one in wanted} - {project["name"]}
    assert [name for name in names if not re.search(rf"^\| `{name}` \| \S", README, re.MULTILINE)] == []


def test_every_column_override_and_vehicle_parameter_is_named():
    names = [*COLUMNS.values(), *OVERRIDES, *VehicleLimits.__dataclass_fields__]
    assert [name for name in names if f"`{name}`" not in README] == []


def test_every_link_leads_to_a_file():
    targets = re.findall(r"\]\((?!https?:|#)([^)#]+)", README)
    assert [target for target in targets if not (ROOT / target).exists()] == []


def test_the_measured_figures_have_their_place():
    assert README.count("<!-- measured -->") == README.count("<!-- /measured -->") == 1
    assert README.index("## Measured") < README.index("<!-- measured -->") < README.index("<!-- /measured -->")
