"""`sumo-reactive compare` as a user calls it."""

from __future__ import annotations

import csv
import json
import shlex
import subprocess
from pathlib import Path
from xml.etree import ElementTree

import pytest
import sumo
from helpers.programs import ROOT, started_anew, sumo_reactive

from sumo_reactive.lab.metric_names import NETWORK

FOUR_WAY = ROOT / "scenarios" / "four_way_priority.toml"
SUMO = Path(sumo.SUMO_HOME) / "bin" / "sumo"


def test_a_comparison_prints_a_table_and_its_baseline_is_plain_sumos_tripinfo(tmp_path):
    answer = started_anew("compare", FOUR_WAY, "--ego", "ego", "--seed", "1-2", "--jobs", 2, "--out", "out", cwd=tmp_path)
    assert answer.returncode == 0, answer.stdout + answer.stderr
    assert "95 % interval" in answer.stdout and "other vehicles" in answer.stdout
    assert answer.stdout.endswith("2 of 2 pairs driven by both\n")
    data = json.loads((tmp_path / "out" / "comparison.json").read_text(encoding="utf-8"))
    for pair in data["pairs"]:
        program, *arguments = shlex.split(pair["sumo"]["command"])
        assert program == "sumo"
        subprocess.run([SUMO, *arguments], cwd=tmp_path, check=True, timeout=60)
        trips = ElementTree.parse(tmp_path / "tripinfo.xml").getroot()
        (trip,) = (one for one in trips if one.get("id") == "ego")
        found = pair["sumo"]["figures"]
        for name, metric in (("duration", "duration_s"), ("routeLength", "distance_m"), ("timeLoss", "time_loss_s")):
            assert float(trip.get(name)) == found[metric]
        told = pair["sumo"]["departure_s"], pair["sumo"]["end_s"]
        assert (float(trip.get("depart")), float(trip.get("arrival"))) == told
    table = sumo_reactive("table", tmp_path / "out", "--format", "latex", "--out", tmp_path / "t.tex")
    assert (table.returncode, table.stdout) == (0, "")
    assert r"\begin{tabular}" in (tmp_path / "t.tex").read_text(encoding="utf-8")
    (row,) = csv.DictReader(
        sumo_reactive("table", tmp_path / "out", "--format", "csv", "--metric", "duration_s").stdout.splitlines()
    )
    assert float(row["difference"]) == data["metrics"]["duration_s"]["difference"]
    report = sumo_reactive("report", tmp_path / "out")
    assert (report.returncode, report.stdout) == (0, f"{tmp_path / 'out' / 'report.html'}\n")
    assert "2 of 2 pairs driven by both." in (tmp_path / "out" / "report.html").read_text(encoding="utf-8")


def test_several_egos_are_compared_with_the_same_vehicles_in_sumos_hands(tmp_path):
    crossing = ROOT / "networks" / "right_before_left" / "right_before_left.sumocfg"
    asked = ("--ego-probability", 0.5, "--until", 30, "--seed", "3-4", "--out", "out")
    answer = sumo_reactive("compare", crossing, *asked, cwd=tmp_path)
    assert answer.returncode == 0 and answer.stdout.endswith("2 of 2 pairs driven by both\n"), answer.stdout + answer.stderr
    data = json.loads((tmp_path / "out" / "comparison.json").read_text(encoding="utf-8"))
    assert data["horizon_s"] is None and set(data["pairs"][0]["metrics"]) == set(NETWORK)
    for pair in data["pairs"]:
        assert pair["ego"] == "share 0.5" and "--ego-probability 0.5" in pair["reactive"]["command"]
        theirs, ours = (pair[driver]["figures"] for driver in data["drivers"])
        assert theirs["egos"] == ours["egos"] > 0 and theirs["network_vehicles"] == ours["network_vehicles"]
    assert sumo_reactive("report", tmp_path / "out").returncode == 0
    table = sumo_reactive("table", tmp_path / "out", "--format", "csv", "--metric", "network_mean_speed_m_s")
    assert (table.returncode, len(table.stdout.splitlines())) == (0, 2), table.stderr


@pytest.mark.parametrize(
    ("arguments", "place"),
    [
        (("nowhere.sumocfg",), "nowhere.sumocfg: no such file"),
        ((FOUR_WAY, "--ego", "a", "--ego", "a"), "--ego: a value is given twice"),
        ((FOUR_WAY, "--seed", "1-3", "--seed", "2"), "'--seed': a value is given twice"),
        ((FOUR_WAY, "--seed", "x"), "'--seed': 'x' is neither a whole number nor a range"),
        ((FOUR_WAY, "--seed", "3-1"), "'--seed': '3-1' is empty"),
        ((FOUR_WAY, "--horizon", "0"), "--horizon"),
        ((FOUR_WAY, "--ego-region", "1,2,3"), "a region is a rectangle by two corners"),
        ((FOUR_WAY, "--ego-region", "1,2,x,4"), "'1,2,x,4' is not four numbers"),
        ((FOUR_WAY, "--ego", "a", "--ego-type", "car"), "--ego: one trip each"),
        ((FOUR_WAY, "--jobs", "0"), "--jobs"),
        ((FOUR_WAY, "--out", FOUR_WAY), "a file, not a folder"),
        ((FOUR_WAY, "--", "--tripinfo-output", "x"), "SUMO option 'tripinfo-output' cannot be given"),
        ((FOUR_WAY, "--ego", "nobody", "--out", "out"), "unknown ego 'nobody'"),
    ],
)
def test_bad_input_gets_one_line_and_exit_code_2_and_leaves_nothing(tmp_path, arguments, place):
    answer = sumo_reactive("compare", *arguments, cwd=tmp_path)
    lines = [line for line in answer.stderr.splitlines() if line.startswith("sumo-reactive: ")]
    assert answer.returncode == 2
    assert len(lines) == 1 and place in lines[0]
    assert "Traceback" not in answer.stderr and list(tmp_path.iterdir()) == []
