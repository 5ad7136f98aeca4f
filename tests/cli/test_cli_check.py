"""`sumo-reactive check` as CI calls it: what failed is kept, with its page, and named in the JUnit file."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

from helpers.programs import ROOT, sumo_reactive
from junitparser import JUnitXml

from sumo_reactive.lab.check import Case, recorded, verdict_on
from sumo_reactive.lab.scenario import load_scenario_file
from sumo_reactive.lab.task import Ending, Outcome

ROUNDABOUT = ROOT / "networks" / "roundabout" / "roundabout.sumocfg"


def scenario(folder: Path, longest: float) -> Path:
    """Write a scenario file whose trip may take so long (s); return it."""
    folder.mkdir(exist_ok=True)
    file = folder / "ring.toml"
    said = f'[scenario]\nconfig = "{ROUNDABOUT}"\nego = "ego"\n[expect.metrics]\nduration_s = {{ max = {longest} }}\n'
    file.write_text(said, encoding="utf-8")
    return file


def test_seeds_are_a_range_as_in_a_comparison_and_take_the_place_of_the_files(tmp_path):
    file = scenario(tmp_path / "a", 100)
    answer = sumo_reactive("check", file, "--seed", "3-4", "--workers", 2, cwd=tmp_path)
    assert (answer.returncode, answer.stdout.endswith("2 of 2 met\n")) == (0, True), answer.stdout + answer.stderr
    assert all(f"ring.toml seed {seed} " in answer.stdout for seed in (3, 4))
    twice = sumo_reactive("check", file, "--seed", "1-3", "--seed", "2", cwd=tmp_path)
    assert twice.returncode == 2 and "'--seed': a value is given twice" in twice.stderr


def test_record_and_page_of_what_was_not_met_are_kept_and_linked_in_the_junit_file(tmp_path):
    for name, longest in (("a", 20), ("b", 20), ("c", 100)):
        scenario(tmp_path / name, longest)
    answer = sumo_reactive("check", "a", "b", "c", "--out", "kept", "--junit", "v.xml", "--jobs", 2, cwd=tmp_path)
    assert answer.returncode == 1, answer.stderr
    kept = {folder.relative_to(tmp_path): folder for folder in (tmp_path / "kept").iterdir()}
    assert len(kept) == 2  # the third was met; two files of one name do not share a folder
    (suites,) = [list(JUnitXml.fromfile(str(tmp_path / "v.xml")))]
    attached = [case.system_out for suite in suites for case in suite]
    assert attached[2] is None
    for name, folder in kept.items():
        assert json.loads((folder / "summary.json").read_text(encoding="utf-8"))["ego"] == "ego"
        assert "<html" in (folder / "report.html").read_text(encoding="utf-8")
        assert f"record: {name}, page: {name / 'report.html'}" in answer.stdout
        assert any(f"[[ATTACHMENT|{name / 'report.html'}]]" in text for text in attached[:2])
    again = sumo_reactive("check", "a", "--out", "kept", cwd=tmp_path)
    assert again.returncode == 1 and "record: " in again.stdout


def test_what_came_to_no_end_is_not_recorded_and_what_cannot_be_is_told(tmp_path):
    file = load_scenario_file(scenario(tmp_path / "a", 20))
    case = Case(file.scenario, file.expectation)
    crashed = verdict_on(case, Outcome(task=case.task, ending=Ending.CRASHED, reason="killed by SIGSEGV"))
    assert recorded(crashed, tmp_path / "kept", 60.0) == crashed
    unmet = replace(crashed, outcome=Outcome(task=case.task, ending=Ending.DONE), reasons=("too slow",))
    taken = tmp_path / "taken"
    taken.write_text("a file", encoding="utf-8")
    found = recorded(unmet, taken, 60.0)
    assert found.record is None and found.reasons[0] == "too slow"
    assert found.reasons[1].startswith("not recorded: ") and "taken" in found.reasons[1]


def test_a_folder_that_cannot_be_is_told_before_anything_runs():
    answer = sumo_reactive("check", "scenarios", "--out", "pyproject.toml", cwd=ROOT)
    assert answer.returncode == 2 and "a file, not a folder" in answer.stderr and not answer.stdout


CROSSING = ROOT / "networks" / "right_before_left" / "right_before_left.sumocfg"


def test_several_egos_are_a_case_for_each_share_and_what_is_not_met_is_recorded(tmp_path):
    said = f'[scenario]\nconfig = "{CROSSING}"\nseed = 3\nuntil_s = 30\n[egos]\nshare = [0.0, 0.5]\n'
    file = tmp_path / "fleet.toml"
    file.write_text(f"{said}[expect.metrics]\negos = {{ max = 0 }}\n", encoding="utf-8")
    answer = sumo_reactive("check", file, "--out", "kept", "--junit", "v.xml", cwd=tmp_path)
    assert answer.returncode == 1 and "1 of 2 met" in answer.stdout, answer.stdout + answer.stderr
    first, second = answer.stdout.splitlines()[:2]
    assert first.startswith("met") and "seed 3 share 0 " in first and "0 egos among" in first
    assert second.startswith("FAILED") and "expected at most 0" in second
    assert f"replay: sumo-reactive run {file} --seed 3 --ego-probability 0.5" in answer.stdout
    folder = tmp_path / "kept" / "fleet_seed_3_share_0.5"
    egos = json.loads((folder / "fleet.json").read_text(encoding="utf-8"))["egos"]
    assert egos and all((folder / one["folder"] / "summary.json").is_file() for one in egos)
    assert "<html" in (folder / "report.html").read_text(encoding="utf-8")
    (suite,) = JUnitXml.fromfile(str(tmp_path / "v.xml"))
    assert [case.name for case in suite] == ["seed 3 share 0", "seed 3 share 0.5"]
    again = sumo_reactive("run", file, "--seed", 3, "--ego-probability", 0.5, "--quiet", cwd=tmp_path)
    assert again.stdout.startswith(f"{len(egos)} egos until 30.0 s")
