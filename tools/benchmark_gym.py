#!/usr/bin/env python3
"""Time a step of the Gymnasium environment, with one ego among about 50 vehicles, beside highway-env's.

    python tools/benchmark_gym.py [--steps N] [--write MACHINE] [--page FILE]

Times are the processor's, of all threads of this process, for `step` alone: a reset, after which ten steps are not
counted, is not timed. Actions keep the speed. "SUMO alone" is the same traffic in libsumo with nobody watched or driven.
highway-env (`pip install highway-env`) is timed as it comes, where a step is 1 s in 15 parts, and with the length of our
step in one part; where it is not installed, its rows are left out. `--write` puts the table into docs/gym.md, with
commit, date and the MACHINE in words.
"""

from __future__ import annotations

import argparse
import shutil
import tempfile
import time as clock
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import gymnasium
import libsumo
import numpy as np
from samples import measured_on, replaced

from sumo_reactive.gym import SumoReactiveEnv
from sumo_reactive.lab.scenario import load_scenario
from sumo_reactive.lab.simulation import started

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs" / "gym.md"
NETWORK = ROOT / "networks" / "multi_lane_road"
TARGET = "target: ≥ 1500 steps/s"

OTHERS = 50
"""Vehicles beside the ego in highway-env."""

SCALES = {"speed": 1.4, "steer": 2.0}
"""The factor on our scenario's traffic that gives about as many: who holds the wheel straight does not get far."""

SCENARIO = '[scenario]\nconfig = "busy/multi_lane_road.sumocfg"\nego = "ego"\nstep_length_s = 0.1\n'

WARMING = 10
"""Steps after a reset that are not counted: they load what the others have loaded."""

HEAD = (
    "| environment | vehicles | step (s) | steps/s | simulated s/s |",
    "|---|---:|---:|---:|---:|",
)


class Row(NamedTuple):
    """What was timed: its name, mean number of vehicles, length of a step (s), the processor's seconds a step."""

    name: str
    vehicles: float
    length: float
    took: float

    def __str__(self) -> str:
        """Return it as a row in Markdown."""
        rate = 1.0 / self.took
        return f"| {self.name} | {self.vehicles:.0f} | {self.length:g} | {rate:.0f} | {rate * self.length:.0f} |"


def main() -> None:
    """Print the table, and write it if that is asked for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--steps", type=int, default=2000, help="steps to time of each environment (default 2000)")
    parser.add_argument("--write", metavar="MACHINE", help="write the table into the page, measured on this machine")
    parser.add_argument("--page", type=Path, default=PAGE, metavar="FILE", help="default docs/gym.md")
    asked = parser.parse_args()
    print(TARGET)
    with tempfile.TemporaryDirectory() as folder:
        rows = [*ours(Path(folder), asked.steps), *theirs(asked.steps)]
    table = "\n".join((*HEAD, *map(str, rows)))
    print(table)
    if asked.write:
        text, head = asked.page.read_text(encoding="utf-8"), f"{measured_on(asked.write)}; `python tools/benchmark_gym.py`:"
        asked.page.write_text(replaced(text, "steps", f"{head}\n\n{table}"), encoding="utf-8")


def busy_scenario(folder: Path, scale: float) -> Path:
    """Write a scenario with so much more traffic; return its file."""
    shutil.copytree(NETWORK, folder / "busy", dirs_exist_ok=True)
    config, scenario = folder / "busy" / "multi_lane_road.sumocfg", folder / "busy.toml"
    text = config.read_text(encoding="utf-8")
    config.write_text(text.replace("</configuration>", f'<scale value="{scale:g}"/></configuration>'), encoding="utf-8")
    scenario.write_text(SCENARIO, encoding="utf-8")
    return scenario


def ours(folder: Path, steps: int) -> Iterator[Row]:
    """Yield our environment with either kind of action, and SUMO alone."""
    for action, kept in (("speed", [0.2]), ("steer", [0.0, 0.0])):
        env = SumoReactiveEnv(busy_scenario(folder, SCALES[action]), action=action)
        always = np.array(kept, dtype=np.float32)
        yield Row(f'SumoReactive-v0, action="{action}"', *timed(env, always, steps, libsumo.vehicle.getIDCount))
        env.close()
    yield Row("SUMO alone", *alone(busy_scenario(folder, SCALES["speed"]), steps))


def theirs(steps: int) -> Iterator[Row]:
    """Yield highway-env as it comes, and with steps as short as ours; tell if it is not installed."""
    try:
        import highway_env
    except ImportError:
        print("highway-env is not installed: its rows are left out")
        return
    gymnasium.register_envs(highway_env)
    short = {"policy_frequency": 10, "simulation_frequency": 10}
    for name, config in (("as it comes", {}), ("steps of 0.1 s", short)):
        made = gymnasium.make("highway-v0", config=config | {"vehicles_count": OTHERS, "duration": 1e6})
        env: Any = made.unwrapped
        idle = {name: number for number, name in env.action_type.ACTIONS_ALL.items()}["IDLE"]
        found = timed(env, idle, steps // (1 if config else 10), lambda env=env: len(env.road.vehicles))
        yield Row(f"highway-env, highway-v0, {name}", *found)
        made.close()


def timed(env: Any, action: Any, steps: int, count: Callable[[], int]) -> tuple[float, float, float]:
    """Return the mean number of vehicles, the length of a step (s), and the processor's seconds that `step` takes."""
    took, vehicles, seed, counted, is_over = 0.0, 0, 0, -WARMING, True
    while counted < steps:
        if is_over:
            env.reset(seed=seed)
            seed, counted = seed + 1, counted if counted > 0 else -WARMING
        began = clock.process_time()
        _, _, terminated, truncated, _ = env.step(action)
        spent, is_over, counted = clock.process_time() - began, terminated or truncated, counted + 1
        if counted > 0:
            took, vehicles = took + spent, vehicles + count()
    return vehicles / steps, length_of(env), took / steps


def length_of(env: Any) -> float:
    """Return the length of an environment's step, s."""
    return 1.0 / env.config["policy_frequency"] if hasattr(env, "config") else float(libsumo.simulation.getDeltaT())


def alone(file: Path, steps: int) -> tuple[float, float, float]:
    """Return the same of SUMO, while the ego is on its way."""
    scenario, took, vehicles, counted = load_scenario(file), 0.0, 0, 0
    while counted < steps:
        with started(replace(scenario, seed=counted)):
            while scenario.ego not in libsumo.simulation.getDepartedIDList():
                libsumo.simulationStep()
            while scenario.ego in libsumo.vehicle.getIDList() and counted < steps:
                began = clock.process_time()
                libsumo.simulationStep()
                took, counted = took + clock.process_time() - began, counted + 1
                vehicles += libsumo.vehicle.getIDCount()
            length = float(libsumo.simulation.getDeltaT())
    return vehicles / steps, length, took / steps


if __name__ == "__main__":
    main()
