"""The README and its pages are true: commands and examples run, tables name what the tree holds, links lead somewhere."""

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
PAGES = {page: page.read_text(encoding="utf-8") for page in sorted((ROOT / "docs").glob("*.md"))}
HOUSE, PYTHON, MEASURED = (PAGES[ROOT / "docs" / f"{name}.md"] for name in ("house", "python", "measured"))
BOOK = "\n".join((README, *PAGES.values()))
MOST_README_BYTES = 10_000
EXAMPLE_LINES = 20
EXAMPLE_SECONDS = 240


def blocks(language: str, text: str = README) -> list[str]:
    """Return the code blocks of a language, in order."""
    return re.findall(rf"^```{language}\n(.*?)^```$", text, re.DOTALL | re.MULTILINE)


def rooms() -> list[str]:
    """Return the folders of the package that hold modules, from its root."""
    inits = sorted(PACKAGE.rglob("__init__.py"))
    return [str(init.parent.relative_to(PACKAGE).as_posix()) for init in inits if init.parent != PACKAGE]


def modules_of(room: str) -> set[str]:
    """Return the names of a room's modules."""
    return {file.stem for file in (PACKAGE / room).glob("*.py")} - {"__init__"}


def told_of(room: str) -> set[str]:
    """Return the modules that the table of rooms names: the last cell of the room's row."""
    row = re.search(rf"^\|.*\| `{re.escape(room)}/` \|.*\| (.*) \|$", HOUSE, re.MULTILINE)
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


@pytest.mark.parametrize("number", range(len(blocks("python", PYTHON))))
def test_an_example_runs_as_it_is_printed_and_prints_something(number):
    example = blocks("python", PYTHON)[number]
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
    assert re.search(rf"^\|.*`{name}\.py`", HOUSE, re.MULTILINE)


def test_every_dependency_is_named_with_its_reason():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    wanted = [*project["dependencies"], *(one for extra in project["optional-dependencies"].values() for one in extra)]
    names = {re.match(r"[\w-]+", one)[0] for one in wanted} - {project["name"]}
    assert [name for name in names if not re.search(rf"^\| `{name}` \| \S", BOOK, re.MULTILINE)] == []


def test_every_column_override_and_vehicle_parameter_is_named():
    names = [*COLUMNS.values(), *OVERRIDES, *VehicleLimits.__dataclass_fields__]
    assert [name for name in names if f"`{name}`" not in BOOK] == []


def headings(text: str) -> set[str]:
    """Return the anchors of a page's headings."""
    found = re.findall(r"^#+ (.*)$", re.sub(r"^```.*?^```$", "", text, flags=re.DOTALL | re.MULTILINE), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", one.lower()).replace(" ", "-") for one in found}


@pytest.mark.parametrize("page", [ROOT / "README.md", *PAGES], ids=lambda page: page.name)
def test_every_link_leads_to_a_file_and_to_a_heading_there(page):
    texts = {**PAGES, ROOT / "README.md": README}
    for target in re.findall(r"\]\((?!https?:)([^)\s]+)\)", texts[page]):
        name, _, anchor = target.partition("#")
        file = (page.parent / name).resolve() if name else page
        assert file.exists(), target
        assert not anchor or anchor in headings(texts[file]), target


def test_the_readme_is_short():
    assert len(README.encode()) <= MOST_README_BYTES


def test_the_measured_figures_have_their_place_and_the_readme_repeats_six_of_them():
    assert MEASURED.count("<!-- measured -->") == MEASURED.count("<!-- /measured -->") == 1
    cells = [[cell.strip() for cell in line.split("|")[1:-1]] for line in MEASURED.splitlines() if line.startswith("| ")]
    known = {row[0]: (row[1], row[3]) for row in cells if len(row) == 5}
    rows = re.findall(r"^\| ([^|]+) \| ([^|]+) \| ([^|]+) \|$", README.partition("## Measured")[2], re.MULTILINE)[1:]
    assert len(rows) == 6
    assert {name: (one, other) for name, one, other in rows}.items() <= known.items()
