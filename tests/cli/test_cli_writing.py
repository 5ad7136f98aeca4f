"""What a finished run has come to is not lost where it cannot be written, and what cannot be is told before it begins."""

import sys

import pytest
from helpers.programs import ROOT, sumo_reactive
from helpers.recordings import made_record, step
from helpers.stores import made_store

from sumo_reactive.cli import main
from sumo_reactive.errors import OutputError
from sumo_reactive.lab.comparison import comparison, record
from sumo_reactive.lab.comparison.comparison import Comparison

FOUR_WAY = ROOT / "scenarios" / "four_way_priority.toml"
LONG = "x" * 300

FULL = """
import resource
resource.setrlimit(resource.RLIMIT_FSIZE, (100, 100))
"""
"""A disk without room."""


@pytest.mark.parametrize(
    ("arguments", "shown"),
    [
        (("run", FOUR_WAY, "--out", "new/out"), "time loss"),
        (("run", FOUR_WAY, "--out", "new/out", "--quiet"), "time loss"),
        (("run", FOUR_WAY, "--ego-probability", 1, "--until", 20, "--out", "new/out", "--quiet"), "time loss"),
        (("check", FOUR_WAY, "--junit", "new/out"), "2 of 2 met"),
    ],
    ids=["run", "quiet run", "fleet", "check"],
)
def test_without_room_the_figures_are_on_the_terminal_and_one_line_says_what_is_not_written(tmp_path, arguments, shown):
    answer = sumo_reactive(*arguments, cwd=tmp_path, code=FULL)
    assert answer.returncode == 2
    assert shown in answer.stdout
    assert answer.stderr.splitlines()[-1] == "sumo-reactive: new/out: cannot be written: File too large"
    assert "Traceback" not in answer.stderr and list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("quiet", [(), ("--quiet",)])
def test_a_comparison_that_cannot_be_written_is_shown(tmp_path, monkeypatch, capsys, quiet):
    def no_room(*_):
        raise OutputError("out: cannot be written: No space left on device")

    monkeypatch.setattr(comparison, "compare", lambda *_, **__: [Comparison((), 600.0)])
    monkeypatch.setattr(record, "comparison_rows", lambda _: [("duration (s)", "2", "31", "30", "-1", "none")])
    monkeypatch.setattr(record, "write", no_room)
    monkeypatch.setattr(sys, "argv", ["sumo-reactive", "compare", str(FOUR_WAY), "--out", str(tmp_path / "out"), *quiet])
    with pytest.raises(SystemExit) as ended:
        main()
    told = capsys.readouterr()
    assert ended.value.code == 2 and "duration (s)" in told.out
    assert told.err.splitlines()[-1] == "sumo-reactive: out: cannot be written: No space left on device"


@pytest.mark.parametrize(
    "arguments",
    [
        ("run", FOUR_WAY, "--out", LONG),
        ("run", FOUR_WAY, "--out", f"new/{LONG}"),
        ("run", FOUR_WAY, "--ego-probability", 1, "--out", LONG),
        ("compare", FOUR_WAY, "--out", LONG),
        ("check", FOUR_WAY, "--junit", LONG),
        ("report", "record", "--out", LONG),
        ("results", "made.duckdb", "--csv", LONG),
        ("results", "made.duckdb", "--parquet", f"new/{LONG}"),
    ],
    ids=lambda arguments: " ".join(str(one)[:10] for one in arguments if one != FOUR_WAY),
)
def test_a_name_that_is_too_long_is_one_line_and_leaves_nothing(tmp_path, arguments):
    made_record(tmp_path / "record", [step(k) for k in range(3)])
    made_store(tmp_path / "made.duckdb")
    before = sorted(tmp_path.rglob("*"))
    answer = sumo_reactive(*arguments, cwd=tmp_path)
    (line,) = answer.stderr.splitlines()
    assert answer.returncode == 2 and ": cannot be written: " in line
    assert sorted(tmp_path.rglob("*")) == before


@pytest.mark.parametrize(
    ("arguments", "name"),
    [
        (("report", "record"), "record/report.html"),
        (("results", "made.duckdb", "--csv", "t.csv"), "t.csv"),
        (("results", "made.duckdb", "--parquet", "t.parquet"), "t.parquet"),
        (("check", FOUR_WAY, "--junit", "t.xml"), "t.xml"),
    ],
    ids=["report", "csv", "parquet", "junit"],
)
def test_a_planted_link_is_replaced_and_what_it_leads_to_stays(tmp_path, arguments, name):
    made_record(tmp_path / "record", [step(k) for k in range(3)])
    made_store(tmp_path / "made.duckdb")
    victim = tmp_path / "victim"
    victim.write_text("mine", encoding="utf-8")
    (tmp_path / name).symlink_to(victim)
    assert sumo_reactive(*arguments, cwd=tmp_path).returncode == 0
    assert victim.read_text(encoding="utf-8") == "mine"
    assert not (tmp_path / name).is_symlink() and (tmp_path / name).stat().st_size > 100
