"""`check` on a scenario of ten seconds, from command to exit; timed by `pytest tests/benchmark --benchmark-enable`."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

CONFIG = Path(__file__).parents[2] / "networks" / "roundabout" / "roundabout.sumocfg"


def test_a_scenario_of_ten_seconds_is_checked(benchmark, tmp_path):
    file = tmp_path / "short.toml"
    text = f'[scenario]\nconfig = "{CONFIG.as_posix()}"\nego = "ego"\nuntil_s = 22.0\n[expect]\narrived = false\n'
    file.write_text(text, encoding="utf-8")
    command = [sys.executable, "-m", "sumo_reactive", "check", str(file)]

    def check():
        return subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)

    check()
    answer = benchmark.pedantic(check, rounds=3)
    assert (answer.returncode, answer.stderr) == (0, ""), answer.stdout
