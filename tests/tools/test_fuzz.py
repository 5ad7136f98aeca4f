"""The fuzzer on a few hundred inputs of fixed numbers, and the fuzzer itself: it must notice what ends wrongly."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
CASES = 150
"""Each takes about a tenth of a second on a quiet machine; the material takes some seconds once."""


def fuzz(*arguments: object, code: str = "") -> subprocess.CompletedProcess[str]:
    """Run the tool, after some code, in a process of its own: it forks."""
    run = f"import runpy; runpy.run_path({str(ROOT / 'tools' / 'fuzz.py')!r}, run_name='__main__')"
    command = [sys.executable, "-c", f"{code}\n{run}", *map(str, arguments)]
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])}
    return subprocess.run(command, capture_output=True, text=True, timeout=560, env=environment, check=False)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Material that is made once."""
    return tmp_path_factory.mktemp("fuzz")


def test_every_spoilt_input_ends_in_one_line(folder):
    kinds = ("scenario", "configuration", "network", "traffic", "experiment", "record", "fleet", "store", "command line")
    asked = [word for kind in kinds for word in ("--kind", kind)]
    answer = fuzz("--number", CASES, "--keep", folder, *asked)
    assert answer.returncode == 0, answer.stdout + answer.stderr
    assert f"0 of {CASES} ended wrongly" in answer.stdout


@pytest.mark.parametrize(
    ("fault", "told"),
    [
        ("raise KeyError('x')", "ended with 70"),
        ("raise KeyboardInterrupt", "interrupted"),
        ("import os; os.abort()", "ended with -6"),
        ("import tempfile; tempfile.mkdtemp()", "left"),
        ("print('Traceback', file=sys.stderr)", "traceback"),
    ],
)
def test_the_fuzzer_notices_what_ends_wrongly(folder, fault, told):
    code = f"""
import sys
import sumo_reactive.show.recording as one
def load(folder):
    {fault}
    from sumo_reactive.errors import ScenarioError
    raise ScenarioError("said")
one.load = load
"""
    answer = fuzz("--number", 1, "--keep", folder, "--kind", "record", code=code)
    assert answer.returncode == 1 and "1 of 1 ended wrongly" in answer.stdout
    assert told in answer.stdout.split(": ")[1], answer.stdout
