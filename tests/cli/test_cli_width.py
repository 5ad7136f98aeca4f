"""What people read fits a terminal of eighty columns."""

import fcntl
import os
import pty
import re
import struct
import subprocess
import sys
import termios

import pytest
from helpers.programs import ROOT, sumo_reactive
from helpers.stores import made_store

WIDTH = 80
ROUNDABOUT = ROOT / "scenarios" / "roundabout.toml"
PROSE = ("Means over n pairs",)
"""Sentences, which a terminal breaks by itself."""


def lines_on_a_terminal(*arguments, width=WIDTH, cwd=None):
    """Run the command line on a terminal of so many columns; return the lines that it prints, without their colours."""
    ours, theirs = pty.openpty()
    fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 40, width, 0, 0))
    unset = {"COLUMNS", "LINES"}
    environment = {name: value for name, value in os.environ.items() if name not in unset} | {"TERM": "xterm"}
    command = [sys.executable, "-m", "sumo_reactive", *map(str, arguments)]
    process = subprocess.Popen(command, stdout=theirs, stderr=subprocess.DEVNULL, cwd=cwd, env=environment)
    os.close(theirs)
    said = b""
    try:
        while part := os.read(ours, 1 << 16):
            said += part
    except OSError:  # the other end is closed
        pass
    finally:
        os.close(ours)
        process.wait(timeout=60)
    text = re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", said.decode())
    return [line.rstrip() for line in text.replace("\r\n", "\n").split("\n")]


def too_wide(lines):
    return [line for line in lines if len(line) > WIDTH and not line.startswith(PROSE)]


@pytest.mark.parametrize(
    "arguments",
    [
        ("run", ROUNDABOUT), ("run", ROUNDABOUT, "--ego-probability", 1, "--until", 30),
        ("compare", ROUNDABOUT, "--seed", "1-2"), ("check", ROUNDABOUT, "--seed", "1-2"),
    ],
    ids=["run", "several egos", "compare", "check"],
)  # fmt: skip
def test_what_is_told_of_runs_fits_a_narrow_terminal_and_a_file(arguments):
    answer = sumo_reactive(*arguments, cwd=ROOT)
    assert answer.stdout and too_wide(answer.stdout.replace(f"{ROOT}/", "").splitlines()) == []
    told = lines_on_a_terminal(*arguments, cwd=ROOT)
    assert any(told) and too_wide([line.replace(f"{ROOT}/", "") for line in told]) == []


def test_means_that_are_too_wide_for_the_terminal_stand_below_each_other(tmp_path):
    store = made_store(tmp_path / "a.duckdb")
    narrow, wide = (lines_on_a_terminal("results", store, width=width) for width in (WIDTH, 200))
    assert too_wide(narrow) == []
    assert "town.toml  reactive  5 of 6" in narrow and any(line.startswith(" duration_s ") for line in narrow)
    (head,) = (line for line in wide if "scenario" in line)
    assert {"driver", "arrived", "duration_s", "rms_jerk_m_s3"} <= set(head.split())


def test_several_seeds_are_for_commands_that_take_them():
    answer = sumo_reactive("run", ROUNDABOUT, "--seed", "1-10")
    assert answer.returncode == 2 and answer.stdout == ""
    assert "'1-10' are several, and run drives once: compare, check and batch take them" in answer.stderr
    for command in ("compare", "check"):
        answer = sumo_reactive(command, ROUNDABOUT, "--seed", "ten")
        assert answer.returncode == 2
        assert "Invalid value for '--seed': 'ten' is neither a whole number nor a range such as 1-10" in answer.stderr
