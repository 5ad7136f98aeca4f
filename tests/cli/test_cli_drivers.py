"""The same scenario file with five drivers: checked, compared, batched, each told apart and none in the way of another."""

import json
import sys
from pathlib import Path

import pytest
from helpers.programs import sumo_reactive

from sumo_reactive.show.page import driver_name

ROOT = Path(__file__).resolve().parents[2]
WAYWARD = ROOT / "tests" / "lab" / "drivers" / "wayward.py"
IDM = "sumo_reactive_examples.idm_mobil:IdmMobil"
CRASHING = "wayward:CrashesAt20"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder with a scenario file, the examples and a driver that crashes at 20 s."""
    found = tmp_path_factory.mktemp("drivers")
    (found / "sumo_reactive_examples").symlink_to(ROOT / "examples" / "drivers" / "sumo_reactive_examples")
    (found / "pass_on.py").symlink_to(ROOT / "examples" / "drivers" / "pass_on.py")
    (found / "wayward.py").symlink_to(WAYWARD)
    config = ROOT / "networks" / "four_way_priority" / "four_way_priority.sumocfg"
    (found / "crossing.toml").write_text(f'[scenario]\nconfig = "{config}"\nego = "ego"\n', encoding="utf-8")
    return found


PROGRAM = f"exec:{sys.executable} pass_on.py"
FIVE = "reactive", "sumo", IDM, PROGRAM, CRASHING


def test_five_drivers_are_checked_and_the_one_that_crashes_is_red_with_its_traceback(folder):
    named = [word for name in FIVE for word in ("--driver", name)]
    answer = sumo_reactive("check", "crossing.toml", *named, "--junit", "v.xml", "--jobs", 2, cwd=folder)
    assert answer.returncode == 1, answer.stderr
    assert "4 of 5 met" in answer.stdout
    failed = [line for line in answer.stdout.splitlines() if line.startswith("FAILED")]
    assert len(failed) == 1
    assert f"did not arrive (driver '{CRASHING}' failed at 20.1 s: ZeroDivisionError: division by zero)" in failed[0]
    assert "wayward.py" in answer.stdout
    assert f"--driver {CRASHING}" in answer.stdout
    assert 'name="seed 42 driver sumo"' in (folder / "v.xml").read_text(encoding="utf-8")


def test_drivers_are_compared_with_sumos_own_each_in_a_folder_of_its_own(folder):
    words = ("--driver", IDM, "--driver", "reactive", "--seed", "1-2", "--horizon", "60", "--out", "both", "--jobs", 2)
    answer = sumo_reactive("compare", "crossing.toml", *words, cwd=folder)
    assert answer.returncode == 0, answer.stderr
    assert "IdmMobil" in answer.stdout
    told = {one: json.loads((one / "comparison.json").read_text(encoding="utf-8")) for one in (folder / "both").iterdir()}
    assert sorted(tuple(data["drivers"]) for data in told.values()) == [("sumo", "reactive"), ("sumo", IDM)]
    assert all(data["pairs_driven"] == 2 for data in told.values())
    for one in told:
        assert sumo_reactive("table", one, cwd=folder).returncode == 0


def test_five_drivers_are_batched_and_the_page_has_each(folder):
    drivers = json.dumps(FIVE)
    text = f'[experiment]\nscenarios = ["crossing.toml"]\ndrivers = {drivers}\nseeds = [1, 2]\n'
    text += f'[driver_options."{IDM}"]\nheadway_s = 1.2\n'
    (folder / "five.toml").write_text(text, encoding="utf-8")
    answer = sumo_reactive("batch", "five.toml", "--workers", 2, cwd=folder)
    assert answer.returncode == 0, answer.stdout + answer.stderr
    assert "10 of 10 trials have a result" in answer.stdout
    assert sumo_reactive("report", "five.duckdb", cwd=folder).returncode == 0
    page = (folder / "five.html").read_text(encoding="utf-8")
    assert all(driver_name(name).replace("'", "&#x27;") in page for name in (*FIVE[:2], f"{IDM}(headway_s=1.2)", CRASHING))
    again = sumo_reactive("batch", "five.toml", "--dry-run", cwd=folder)
    assert f"seed 1 {IDM}(headway_s=1.2)" in again.stdout


def test_a_record_of_such_a_driver_is_explained(folder):
    answer = sumo_reactive("run", "crossing.toml", "--driver", IDM, "--out", "record", "--quiet", cwd=folder)
    assert answer.returncode == 0, answer.stderr
    told = sumo_reactive("explain", "record", "--at", 20, cwd=folder).stdout
    assert told.splitlines()[1].startswith("20.0 s: the ego drives at")
    assert told.splitlines()[2].startswith("The driver: ")


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (("run", "crossing.toml", "--driver", "reactve"), "unknown driver 'reactve'; near it: reactive"),
        (("run", "crossing.toml", "--driver-option", "a=1"), "there is no --driver of the user's that takes it"),
        (("run", "crossing.toml", "--driver", IDM, "--driver-option", "headway"), "'headway' is not NAME=VALUE"),
        (("compare", "crossing.toml", "--driver", "sumo"), "SUMO's own driver is there anyway"),
        (("check", "crossing.toml", "--driver", "nowhere:D"), "driver 'nowhere:D' cannot be loaded"),
        (("compare", "crossing.toml", "--driver", "nowhere:D"), "driver 'nowhere:D' cannot be loaded"),
    ],
)
def test_a_driver_that_there_is_not_is_one_line(folder, arguments, told):
    answer = sumo_reactive(*arguments, cwd=folder)
    assert told in answer.stderr + answer.stdout
    assert answer.returncode == 2
