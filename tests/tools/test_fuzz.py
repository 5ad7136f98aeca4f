"""The fuzzer on a few hundred inputs of fixed numbers, and the fuzzer itself: it must notice what ends wrongly."""

from __future__ import annotations

import pytest
from helpers.programs import run_tool

CASES = 150
"""Each takes about a tenth of a second on a quiet machine; the material takes some seconds once."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Material that is made once."""
    return tmp_path_factory.mktemp("fuzz")


def test_every_spoilt_input_ends_in_one_line(folder):
    kinds = ("scenario", "configuration", "network", "traffic", "experiment", "record", "fleet", "store", "command line")
    asked = [word for kind in kinds for word in ("--kind", kind)]
    answer = run_tool("fuzz", "--number", CASES, "--keep", folder, *asked, timeout=560)
    assert answer.returncode == 0, answer.stdout + answer.stderr
    assert f"0 of {CASES} ended wrongly" in answer.stdout


@pytest.mark.parametrize(
    ("fault", "told"),
    [
        ("raise KeyError('x')", "ended with 70"),
        ("raise KeyboardInterrupt", "interrupted"),
        ("import os; os.abort()", "ended with -6"),
        ("import tempfile; tempfile.mkdtemp()", "left"),
        ("import sys; print('Traceback', file=sys.stderr)", "traceback"),
    ],
)
def test_the_fuzzer_notices_what_ends_wrongly(folder, fault, told):
    code = f"""
import sumo_reactive.show.recording as one
import sumo_reactive.show.reports as other
def load(folder):
    {fault}
    from sumo_reactive.errors import ScenarioError
    raise ScenarioError("said")
one.read_run = other.read_run = load
"""
    answer = run_tool("fuzz", "--number", 1, "--keep", folder, "--kind", "record", code=code)
    assert answer.returncode == 1 and "1 of 1 ended wrongly" in answer.stdout
    assert told in answer.stdout.split(": ")[1], answer.stdout
