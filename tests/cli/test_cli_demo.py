"""`demo`: it runs anywhere from what the package brings along, and names what it has made."""

import shlex
import tomllib

import pytest
from helpers.programs import ROOT, sumo_reactive

from sumo_reactive.cli.demo import DEMO_CONFIG
from sumo_reactive.lab.recorder import FILES, PAGE, SAID
from sumo_reactive.sumo.config import read_config

FORBIDDEN = "import webbrowser; webbrowser.open = lambda where: print('opened', where) or {}"


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    return tmp_path_factory.mktemp("anywhere")


@pytest.fixture(scope="module")
def answer(place):
    return sumo_reactive("demo", cwd=place)


def test_the_demo_drives_without_a_fault_and_leaves_record_and_page(answer, place):
    assert (answer.returncode, answer.stderr) == (0, "")
    assert {path.name for path in (place / "sumo_reactive_demo").iterdir()} == {*FILES, PAGE} - {SAID}
    assert "arrived without a violation" in answer.stdout


def test_the_commands_that_it_names_work(answer, place):
    lines = [line.removeprefix("next").strip() for line in answer.stdout.splitlines()]
    named = [shlex.split(line)[1:] for line in lines if line.startswith("sumo-reactive")]
    assert [one[0] for one in named] == ["explain", "explain", "run"]
    for arguments in named[:-1]:
        assert sumo_reactive(*arguments, cwd=place).returncode == 0


def test_another_run_is_not_replaced_unless_it_is_asked_for(answer, place):
    again = sumo_reactive("demo", cwd=place)
    assert (again.returncode, again.stdout) == (2, "")
    assert "use --overwrite" in again.stderr
    assert sumo_reactive("demo", "--overwrite", "-q", cwd=place).stdout == f"sumo_reactive_demo/{PAGE}\n"


@pytest.mark.parametrize(
    ("opens", "told"), [(True, ""), (False, "no browser could be opened: open there/report.html by hand\n")]
)
def test_the_page_is_opened_when_that_is_asked_for(tmp_path, opens, told):
    answer = sumo_reactive("demo", "-q", "--open", "-o", "there", cwd=tmp_path, code=FORBIDDEN.format(opens))
    assert (answer.returncode, answer.stderr) == (0, told)
    assert f"opened {(tmp_path / 'there' / PAGE).as_uri()}" in answer.stdout


def test_the_package_brings_along_each_file_of_the_scenario():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    assert "demo/*" in project["tool"]["setuptools"]["package-data"]["sumo_reactive"]
    config = read_config(DEMO_CONFIG)
    for file in (DEMO_CONFIG, config.net_file, *config.route_files):
        assert file.parent == DEMO_CONFIG.parent
        assert file.read_bytes() == (ROOT / "networks" / "figure4" / file.name).read_bytes()
