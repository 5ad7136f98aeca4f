"""Several processes drive the egos of one simulation to the same bits as one."""

import json
import sys
from dataclasses import replace
from pathlib import Path

import pytest
from helpers.programs import ROOT, sumo_reactive

from sumo_reactive.errors import ScenarioError
from sumo_reactive.lab import fleet
from sumo_reactive.lab.drivers.choice import SUMO, DriverChoice
from sumo_reactive.lab.ego_rule import EgoRule
from sumo_reactive.lab.fleet import Running, run_fleet
from sumo_reactive.lab.recorder import FleetRecorder
from sumo_reactive.lab.scenario import load_scenario

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="several processes are for Linux")

EXAMPLES = ROOT / "examples" / "drivers"
SAME = "decisions.jsonl", "encounters.parquet", "regions.json", "surroundings.json", "users.parquet"


def driven(folder: Path, cores: int, share: float = 1.0, until_s: float = 40.0):
    """Drive by so many processes, with a record and SUMO's output of trips."""
    folder.mkdir()
    options = "--tripinfo-output", str(folder / "trips.xml"), "--tripinfo-output.write-unfinished", "true"
    asked = replace(load_scenario(ROOT / "scenarios" / "four_way_priority.toml"), until_s=until_s, sumo_options=options)
    recorder = FleetRecorder(folder / "record")
    running = Running(cores=cores, shelf=recorder.shelf if cores > 1 else None)
    result = run_fleet(replace(asked, ego=None), EgoRule(share=share), observer=recorder.see, running=running)
    recorder.write(result)
    return result


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """The folders of runs by one, two and four processes, and their results."""
    folder = tmp_path_factory.mktemp("cores")
    return {cores: (folder / str(cores), driven(folder / str(cores), cores)) for cores in (1, 2, 4)}


def body_of(text: str) -> str:
    """SUMO's output without its head, which tells options and time."""
    return text[text.index("<tripinfos") :]


@pytest.mark.parametrize("cores", [2, 4])
def test_two_and_four_processes_drive_and_record_as_one(runs, cores):
    (one, alone), (many, together) = runs[1], runs[cores]
    egos = [result.ego for result in alone.results]
    assert len(egos) > 5 and [result.ego for result in together.results] == egos
    for ego in egos:
        summaries = [json.loads((folder / "record" / ego / "summary.json").read_text()) for folder in (one, many)]
        assert summaries[0]["trajectory"] == summaries[1]["trajectory"]
        for file in SAME:
            assert (one / "record" / ego / file).read_bytes() == (many / "record" / ego / file).read_bytes()
    assert [result.figures for result in alone.results] == [result.figures for result in together.results]
    assert (alone.on_their_way, alone.until, alone.exit_code) == (together.on_their_way, together.until, together.exit_code)


def test_what_sumo_writes_is_written_once_and_put_right_for_all_egos(runs):
    trips = [body_of((folder / "trips.xml").read_text()) for folder, _ in runs.values()]
    assert trips[0] == trips[1] == trips[2]
    for folder, _ in runs.values():
        assert {file.name for file in folder.iterdir()} == {"trips.xml", "record"}


def test_an_ego_drives_alike_in_a_world_of_its_own_and_in_anothers(monkeypatch):
    def places(until_s=60.0):
        found = {}
        asked = replace(load_scenario(ROOT / "scenarios" / "city_grid.toml"), ego=None, until_s=until_s)
        run_fleet(asked, EgoRule(share=0.2), observer=lambda scene: found.setdefault(scene.ego, []).append(scene.step[:5]))
        return found

    shared = places()
    monkeypatch.setattr(fleet, "Worlds", lambda net: net)
    assert len(shared) > 10 and places() == shared


@pytest.mark.parametrize("driver", [SUMO, DriverChoice("sumo_reactive_examples.idm_mobil:IdmMobil", folder=EXAMPLES)])
def test_another_driver_has_one_process(driver):
    asked = replace(load_scenario(ROOT / "scenarios" / "four_way_priority.toml"), driver=driver)
    with pytest.raises(ScenarioError, match="with this program's driver alone"):
        run_fleet(asked, EgoRule(share=1.0), running=Running(cores=2))


def test_the_command_line_drives_several_egos_by_several_processes(tmp_path):
    asked = "run", ROOT / "scenarios" / "four_way_priority.toml", "--ego-probability", 1, "--until", 20, "--cores", 2
    answer = sumo_reactive(*asked, "--out", tmp_path / "out", "--quiet")
    assert answer.returncode == 0 and "egos until 20.0 s" in answer.stdout
    assert json.loads((tmp_path / "out" / "fleet.json").read_text())["egos"]


def test_one_ego_has_one_process():
    answer = sumo_reactive("run", ROOT / "scenarios" / "four_way_priority.toml", "--ego", "ego", "--cores", 2)
    assert answer.returncode == 2 and "--cores" in answer.stderr
