"""No control step waits for a kernel to be compiled or to come from the disk."""

import subprocess
import sys
from pathlib import Path

import pytest

SCENARIOS = Path(__file__).parents[2] / "scenarios"
CODE = """
import sys
from pathlib import Path
from numba.core.dispatcher import Dispatcher
from sumo_reactive.lab.scenario import load_scenario
from sumo_reactive.lab.simulation import run_trial
from sumo_reactive.lab.trip import Trip

compiled, command = Dispatcher.compile, Trip.command
stepping, late = [False], []

def noted(kernel, signature):
    if stepping[0]:
        late.append(kernel.py_func.__name__)
    return compiled(kernel, signature)

def commanded(trip):
    stepping[0] = True
    command(trip)
    stepping[0] = False

Dispatcher.compile, Trip.command = noted, commanded
run_trial(load_scenario(Path(sys.argv[1])))
print("late:", *late)
"""


@pytest.mark.parametrize("name", ["blocked_lane", "roundabout"])
def test_every_kernel_is_loaded_before_the_first_step(name):
    command = [sys.executable, "-c", CODE, str(SCENARIOS / f"{name}.toml")]
    answer = subprocess.run(command, capture_output=True, text=True, timeout=300, check=True)
    assert answer.stdout.splitlines()[-1].strip() == "late:"
