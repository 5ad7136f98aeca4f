"""The command line in processes of its own: exit codes, one clear line for bad input, nothing left behind."""

import json
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
FOUR_WAY = ROOT / "scenarios" / "four_way_priority.toml"


def sumo_reactive(*arguments, cwd=None):
    command = [sys.executable, "-m", "sumo_reactive", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, encoding="utf-8", timeout=300, cwd=cwd, check=False)


def test_the_version_is_told():
    answer = sumo_reactive("--version")
    assert (answer.returncode, answer.stdout.split()[0]) == (0, "sumo-reactive")


def test_help_loads_nothing_heavy():
    code = (
        "import sys, sumo_reactive.cli; "
        "print([name for name in ('numba', 'numpy', 'duckdb', 'shapely', 'libsumo', 'sumolib') if name in sys.modules])"
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
        (("run", FOUR_WAY, "--seed", "x"), "--seed"),
        (("run", FOUR_WAY, "--step-length", "0"), "impossible step length"),
        (("run", FOUR_WAY, "--step-length", "1.5"), "impossible step length"),
        (("run", FOUR_WAY, "--ego", "nobody", "--out", "out"), "nobody"),
        (("run", FOUR_WAY, "--out", FOUR_WAY), "a file, not a folder"),
        (("run", FOUR_WAY, "--out", "out", "--", "--no-such-option"), "SUMO"),
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
    answer = sumo_reactive("run", FOUR_WAY, "--out", out, "--", "--tripinfo-output", tmp_path / "trips.xml")
    assert answer.returncode == 0, answer.stdout + answer.stderr
    assert "arrived without a violation" in answer.stdout
    summary = json.loads((out / "summary.json").read_text(encoding="utf-8"))
    assert summary["arrived"] and summary["ego"] == "ego"
    assert 'id="ego"' in (tmp_path / "trips.xml").read_text(encoding="utf-8")
    assert sumo_reactive("run", FOUR_WAY, "--out", out).returncode == 2


def test_quiet_prints_the_verdict_only():
    answer = sumo_reactive("run", FOUR_WAY, "--quiet")
    assert answer.stdout == "ego: arrived without a violation\n"


@pytest.mark.parametrize("interrupt", [signal.SIGINT, signal.SIGKILL], ids=lambda one: one.name)
def test_a_run_cut_short_leaves_no_record(tmp_path, interrupt):
    city = ROOT / "scenarios" / "city_grid.toml"
    command = [sys.executable, "-m", "sumo_reactive", "run", str(city), "--until-end", "--out", str(tmp_path / "out")]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True, encoding="utf-8") as process:
        time.sleep(1.5)
        process.send_signal(interrupt)
        _, message = process.communicate(timeout=60)
    assert process.returncode == (130 if interrupt is signal.SIGINT else -signal.SIGKILL)
    assert interrupt is signal.SIGKILL or message.endswith("sumo-reactive: interrupted\n")
    assert list(tmp_path.iterdir()) == []
