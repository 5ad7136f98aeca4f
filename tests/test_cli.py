"""The command line in processes of its own: exit codes, one clear line for bad input, nothing left behind."""

import json
import subprocess
import sys

import pytest
from helpers.programs import ROOT, started_anew, sumo_reactive

FOUR_WAY = ROOT / "scenarios" / "four_way_priority.toml"


def test_the_version_is_told():
    answer = started_anew("--version")
    assert (answer.returncode, answer.stdout.split()[0]) == (0, "sumo-reactive")


def test_help_loads_nothing_heavy():
    code = (
        "import sys, sumo_reactive.cli; "
        "heavy = ('numba', 'numpy', 'duckdb', 'plotly', 'shapely', 'libsumo', 'sumolib'); "
        "print([name for name in heavy if name in sys.modules])"
    )
    answer = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=True)
    assert answer.stdout.strip() == "[]"


@pytest.mark.parametrize(
    ("arguments", "place"),
    [
        ((), "Missing command"),
        (("run",), "config"),
        (("run", "nowhere.sumocfg"), "nowhere.sumocfg: no such file"),
        (("run", "."), ".: a directory"),
        (("run", FOUR_WAY, "--bogus"), "--bogus"),
        (("run", FOUR_WAY, "extra"), "extra"),
        (("run", FOUR_WAY, "--profile", "fast"), "'fast'"),
        (("run", FOUR_WAY, "--delays", "ignore"), "'ignore'"),
        (("run", FOUR_WAY, "--seed", "x"), "--seed"),
        (("run", FOUR_WAY, "--step-length", "0"), "impossible step length"),
        (("run", FOUR_WAY, "--step-length", "1.5"), "impossible step length"),
        (("run", FOUR_WAY, "--ego", "nobody", "--out", "out"), "nobody"),
        (("run", FOUR_WAY, "--out", FOUR_WAY), "a file, not a folder"),
        (("run", FOUR_WAY, "--out", "out", "--", "--no-such-option"), "SUMO"),
        (("explain",), "DIR"),
        (("explain", "nowhere"), "nowhere: no such folder"),
        (("explain", FOUR_WAY), "a file, not a folder"),
        (("explain", "."), ".: not the record of a run: it has no summary.json"),
        (("explain", ".", "--at", "x"), "--at"),
        (("report",), "PATH"),
        (("report", "nowhere"), "nowhere: no such file or folder"),
        (("report", "."), ".: not the record of a run: it has no summary.json"),
        (("report", FOUR_WAY), "four_way_priority.toml: not the store of an experiment"),
        (("table",), "PATH"),
        (("table", "nowhere"), "nowhere: no such file"),
        (("table", "."), "comparison.csv: no such file"),
        (("table", FOUR_WAY), "four_way_priority.toml: not the store of an experiment"),
        (("check",), "PATH"),
        (("check", "nowhere"), "nowhere: no such file or folder"),
        (("check", "."), ".: no scenario file"),
        (("check", FOUR_WAY, "--jobs", "0"), "--jobs"),
        (("check", FOUR_WAY, "--junit", "."), ".: a folder, not a file"),
        (("check", ROOT / "pyproject.toml"), "pyproject.toml: missing key 'scenario'"),
    ],
)
def test_bad_input_gets_one_line_and_exit_code_2_and_leaves_nothing(tmp_path, arguments, place):
    answer = sumo_reactive(*arguments, cwd=tmp_path)
    assert answer.returncode == 2
    lines = [line for line in answer.stderr.splitlines() if line.startswith("sumo-reactive: ")]
    assert len(lines) == 1 and place in lines[0]
    assert "Traceback" not in answer.stderr
    assert list(tmp_path.iterdir()) == []


def test_a_scenario_is_driven_judged_and_recorded(tmp_path):
    out = tmp_path / "out"
    answer = started_anew("run", FOUR_WAY, "--out", out, "--", "--tripinfo-output", tmp_path / "trips.xml")
    assert answer.returncode == 0, answer.stdout + answer.stderr
    assert "arrived without a violation" in answer.stdout
    summary = json.loads((out / "summary.json").read_text(encoding="utf-8"))
    assert summary["arrived"] and summary["ego"] == "ego"
    assert 'id="ego"' in (tmp_path / "trips.xml").read_text(encoding="utf-8")
    assert sumo_reactive("run", FOUR_WAY, "--out", out).returncode == 2


@pytest.mark.parametrize(
    ("arguments", "help_of"),
    [((), "sumo-reactive"), (("run", "--bogus"), "sumo-reactive run"), (("explain", "--bogus"), "sumo-reactive explain")],
)
def test_wrong_usage_points_to_the_help_of_its_own_command(arguments, help_of):
    assert f"(see {help_of} --help)" in sumo_reactive(*arguments).stderr


@pytest.mark.parametrize(("command", "takes"), [("run", True), ("compare", True), ("explain", False)])
def test_where_an_option_of_sumo_goes_is_told_to_who_forgets_it(command, takes):
    answer = sumo_reactive(command, FOUR_WAY, "--time-to-teleport", "300")
    assert answer.returncode == 2
    assert ("; an option of SUMO goes behind --" in answer.stderr) is takes


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    """The recorded run of a short scenario in which the ego has to yield."""
    out = tmp_path_factory.mktemp("explained") / "out"
    answer = sumo_reactive("run", FOUR_WAY, "--delays", "shift", "--quiet", "--out", out)
    assert answer.returncode == 0, answer.stdout + answer.stderr
    return out


def yields(recording):
    """Return the recorded lines in which the ego waits for somebody with priority, as (time, vehicle, region)."""
    lines = map(json.loads, (recording / "decisions.jsonl").read_text(encoding="utf-8").splitlines())
    reason = "traffic with priority would meet the ego in the region"
    return [
        (line["time_s"], decision["cause"], decision["region"])
        for line in lines
        for decision in line["decisions"]
        if decision["reason"] == reason and not decision["passes"]
    ]


def test_explain_tells_to_whom_the_ego_yields_where_and_when(recording):
    answer = started_anew("explain", recording)
    assert (answer.returncode, answer.stderr) == (0, "")
    told = answer.stdout.splitlines()
    assert told[0].endswith("four_way_priority.toml: arrived without a violation.")
    assert told[-1].startswith("The pilot decided ")
    found = yields(recording)
    assert found
    for moment, vehicle, _ in found:
        (line,) = (line for line in told if line.startswith(f"{moment:.1f} s  "))
        assert f"since {vehicle} has priority" in line
    assert "\x1b" not in answer.stdout


def test_explain_tells_all_that_was_in_force_at_a_time(recording):
    moment, vehicle, region = yields(recording)[0]
    answer = sumo_reactive("explain", recording, "--at", moment + 0.05)
    assert answer.returncode == 0
    assert f"in force since {moment:.1f} s: " in answer.stdout
    assert f"{region}: claimed by another ({vehicle})" in answer.stdout
    assert "the ego drives at" in answer.stdout


def test_explain_tells_in_brief_and_about_one_road_user_but_not_both(recording):
    _, vehicle, _ = yields(recording)[0]
    in_brief, about = sumo_reactive("explain", recording, "--brief"), sumo_reactive("explain", recording, "--about", vehicle)
    assert (in_brief.returncode, about.returncode) == (0, 0)
    whole = sumo_reactive("explain", recording).stdout.splitlines()
    assert 3 < len(in_brief.stdout.splitlines()) < len(whole)
    assert all(vehicle in line for line in about.stdout.splitlines()[1:])
    both = sumo_reactive("explain", recording, "--about", vehicle, "--brief")
    assert both.returncode == 2 and "one of them at a time" in both.stderr


@pytest.mark.parametrize("moment", ["0", "1e6", "nan"])
def test_explain_refuses_a_time_outside_the_run(recording, moment):
    answer = sumo_reactive("explain", recording, "--at", moment)
    assert answer.returncode == 2
    assert "s is outside the run (" in answer.stderr and answer.stderr.count("\n") == 1


def test_quiet_prints_the_verdict_only():
    answer = sumo_reactive("run", FOUR_WAY, "--quiet")
    assert answer.stdout == "ego: arrived without a violation\n"
