"""Whoever reads what is printed may stop reading: what is driven and written is the same."""

import os
import subprocess
import sys

import pytest
from helpers.programs import ROOT

ROAD = ROOT / "scenarios" / "multi_lane_road.toml"
WRITES = {
    "run": ("--out", "run", "run/summary.json"),
    "compare": ("--out", "compared", "compared/comparison.json"),
    "check": ("--junit", "verdicts.xml", "verdicts.xml"),
}


def unread(command, *arguments, folder):
    """Run a command whose standard output nobody reads; return its exit code and what it says on the other."""
    reads, writes = os.pipe()
    os.close(reads)
    words = [sys.executable, "-m", "sumo_reactive", command, str(ROAD), *arguments]
    done = subprocess.run(words, stdout=writes, stderr=subprocess.PIPE, text=True, cwd=folder, check=False)
    os.close(writes)
    return done.returncode, done.stderr


@pytest.mark.parametrize("command", WRITES)
def test_what_nobody_reads_is_written_all_the_same(command, tmp_path):
    option, name, written = WRITES[command]
    assert unread(command, option, name, folder=tmp_path) == (0, "")
    assert (tmp_path / written).stat().st_size > 0


def test_an_error_is_told_to_who_still_listens(tmp_path):
    code, said = unread("run", "--ego", "nobody", folder=tmp_path)
    assert code == 2
    assert "nobody" in said
