"""The tool that kills and interrupts, on a few moments, and that it notices what stays behind."""

from __future__ import annotations

import importlib.util
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
TOOL = ROOT / "tools" / "kill.py"


@pytest.fixture(scope="module")
def tool():
    spec = importlib.util.spec_from_file_location("kill", TOOL)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_what_is_struck_at_random_moments_leaves_nothing(tmp_path):
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])}
    command = [sys.executable, TOOL, "--number", "4", "--command", "run", "--command", "compare", "--keep", tmp_path / "k"]
    answer = subprocess.run(command, capture_output=True, text=True, timeout=500, env=environment, check=False)
    assert answer.returncode == 0, answer.stdout + answer.stderr
    assert "0 of 4 ended wrongly" in answer.stdout


def test_the_tool_notices_what_stays_behind(tool, tmp_path):
    (tmp_path / "tmp" / "x").mkdir(parents=True)
    (tmp_path / "here" / "out").mkdir(parents=True)
    (tmp_path / "here" / ".out.1.partial").touch()
    (tmp_path / "stderr").write_text("Traceback", encoding="utf-8")
    waiting = [sys.executable, "-c", "import time; print(flush=True); time.sleep(60)"]
    with subprocess.Popen(waiting, stdout=subprocess.PIPE, env=os.environ | {tool.MARK: str(tmp_path)}) as process:
        process.stdout.readline()
        found = tool._wrong(70, signal.SIGINT, tmp_path)
        process.kill()
    told = "; ".join(found)
    for part in ("ended with 70", "traceback", "left running", "left ['x']", "partial .out", "half a record"):
        assert part in told
