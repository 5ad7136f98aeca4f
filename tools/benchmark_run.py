#!/usr/bin/env python3
"""Time whole runs against plain `sumo` on the same scenario, seed, step length and end.

    python tools/benchmark_run.py [--scenario FILE --scale FACTOR --until S] [--until-end] [--repeats N] [--sumo PROGRAM]

Both programs run in turn and simulate the same time: from the scenario's begin until the ego has arrived, or, with
`--until-end`, until the scenario's end. "Process" is the time from start to end of the process, "simulation" that of the
simulated part alone: without interpreter, imports, reading the network and, in ours, the plan, the loading of the kernels
and the verdicts at the end. The figures are medians. "Added" is what a driven step costs more than SUMO's own.
"""

from __future__ import annotations

import argparse
import json
import re
import shutil
import subprocess
import sys
import tempfile
import time as clock
from collections.abc import Sequence
from pathlib import Path
from statistics import mean, median
from typing import NamedTuple

from sumolib import checkBinary

ROOT = Path(__file__).resolve().parent.parent
CASES = (("multi_lane_road", 3.0, None), ("on_ramp_merge", 3.0, None), ("city_grid", 0.25, None), ("city_grid", 3.0, 240.0))
"""Own scenarios, the factor on their traffic, and when to end (s): three with about 60 cars, one with 500 or more."""

TARGETS = "targets: ratio ≤ 2.5 with about 60 vehicles in the network, ≤ 1.2 with 500 or more"

_OURS = """
import json, sys, time
from sumo_reactive import cli
from sumo_reactive.experiment import trial
marks, drive = {}, trial._drive
class TimedSession(trial.Session):
    def __enter__(self):
        session = super().__enter__()
        marks["begin"] = time.perf_counter()
        return session
    def __exit__(self, *error):
        marks["until"] = self.time
        super().__exit__(*error)
    def play_out(self, *rest):
        began = time.perf_counter()
        super().play_out(*rest)
        marks["played out"] = time.perf_counter() - began
class TimedTrip(trial.Trip):
    def scenes(self):
        for scene in super().scenes():
            marks.setdefault("driving", time.perf_counter())
            yield scene
def timed(session, *rest):
    marks["taken over"] = time.perf_counter()
    result = drive(session, *rest)
    marks["driven"] = time.perf_counter()
    marks["steps"] = round((session.time - result[0].departure) / session.step_length)
    return result
trial.Session, trial.Trip, trial._drive = TimedSession, TimedTrip, timed
try:
    cli.main()
finally:
    print(json.dumps(marks), file=sys.stderr)
"""
"""The command line itself, with a clock around the simulated part."""


class Case(NamedTuple):
    """A scenario `.toml`, the factor on its traffic, the latest end (s, None: the ego's arrival), whether to play it out."""

    scenario: Path
    scale: float
    until: float | None
    until_end: bool


class Run(NamedTuple):
    """Wall-clock seconds of the process and of the simulated part alone; simulation time of the end; steps driven."""

    process: float
    simulation: float
    until: float = 0.0
    steps: int = 0


def main() -> None:
    """Print one line a case."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenario", type=Path, help="a scenario .toml of this repository; else four of its own")
    parser.add_argument("--scale", type=float, default=1.0, help="factor on the scenario's traffic (with --scenario)")
    parser.add_argument("--until", type=float, help="end at this simulation time at the latest, s (with --scenario)")
    parser.add_argument("--until-end", action="store_true", help="play on after the ego has arrived")
    parser.add_argument("--repeats", type=int, default=5, help="runs of each program (default 5)")
    parser.add_argument("--sumo", default="", help="the plain sumo program; else that of $SUMO_HOME, eclipse-sumo or $PATH")
    asked = parser.parse_args()
    sumo = asked.sumo or shutil.which(checkBinary("sumo"))
    if not sumo:
        raise SystemExit("no plain sumo program: install eclipse-sumo or name one with --sumo")
    cases = [Case(ROOT / "scenarios" / f"{name}.toml", scale, until, asked.until_end) for name, scale, until in CASES]
    if asked.scenario:
        cases = [Case(asked.scenario, asked.scale, asked.until, asked.until_end)]
    print(f"{TARGETS}\n{'':24}{'vehicles':>9}{'until':>8}|{'process (s)':^26}|{'simulation (s)':^26}|{'added':>9}")
    print(f"{'':41}|{'sumo':>9}{'ours':>9}{'ratio':>8}|{'sumo':>9}{'ours':>9}{'ratio':>8}|{'µs/step':>9}")
    for case in cases:
        compare(case, sumo, asked.repeats)


def compare(case: Case, sumo: str, repeats: int) -> None:
    """Run both programs in turn and print the case's line; the first round fills caches and is not counted."""
    first = ours(case)
    vehicles = count(case, sumo, first.until)
    rounds = [(theirs(case, sumo, first.until), ours(case)) for _ in range(repeats)]
    added = 1e6 * median(b.simulation - a.simulation for a, b in rounds) / max(1, first.steps)
    line = f"{case.scenario.stem + f' × {case.scale:g}':24}{vehicles:9.0f}{first.until:8.1f}|"
    for part in ("process", "simulation"):
        a, b = (median(getattr(pair[k], part) for pair in rounds) for k in (0, 1))
        line += f"{a:9.2f}{b:9.2f}{median(getattr(y, part) / getattr(x, part) for x, y in rounds):8.2f}|"
    print(f"{line}{added:9.0f}", flush=True)


def ours(case: Case) -> Run:
    """Drive the ego to its goal."""
    arguments = ["run", str(case.scenario), "--quiet", *(["--until", f"{case.until:g}"] if case.until else [])]
    arguments += [*(["--until-end"] if case.until_end else []), "--", "--scale", f"{case.scale:g}"]
    began = clock.perf_counter()
    done = subprocess.run([sys.executable, "-c", _OURS, *arguments], capture_output=True, text=True, check=False)
    whole = clock.perf_counter() - began
    marks = next((json.loads(line) for line in done.stderr.splitlines() if line.startswith("{")), {})
    if done.returncode not in (0, 1) or "driven" not in marks:
        raise SystemExit(done.stderr)
    simulation = marks["taken over"] - marks["begin"] + marks["driven"] - marks["driving"] + marks.get("played out", 0.0)
    return Run(whole, simulation, marks["until"], marks["steps"])


def plain(case: Case, sumo: str, until: float, options: Sequence[str] = ()) -> float:
    """Let SUMO alone simulate the same; return the seconds of its process."""
    began = clock.perf_counter()
    subprocess.run([*_plain(case, sumo, until), *options], capture_output=True, check=True)
    return clock.perf_counter() - began


def theirs(case: Case, sumo: str, until: float) -> Run:
    """Let SUMO alone simulate the same; its simulated part is what a run takes longer than one that ends at once."""
    start = plain(case, sumo, 0.0)
    whole = plain(case, sumo, until)
    return Run(whole, max(whole - start, 1e-3), until)


def count(case: Case, sumo: str, until: float) -> float:
    """Return the mean number of vehicles in the network."""
    with tempfile.TemporaryDirectory() as folder:
        summary = Path(folder) / "summary.xml"
        plain(case, sumo, until, ["--summary-output", str(summary)])
        return mean(int(number) for number in re.findall(r'running="(\d+)"', summary.read_text(encoding="utf-8")))


def _plain(case: Case, sumo: str, until: float) -> list[str]:
    """The same options as ours takes: seed and step length of the scenario, collisions checked alike."""
    from sumo_reactive.experiment.scenario import load_scenario
    from sumo_reactive.sumo.config import read_config
    from sumo_reactive.sumo.launch import chosen_step_length, sumo_arguments

    scenario = load_scenario(case.scenario)
    config = read_config(scenario.config)
    options = ["--scale", f"{case.scale:g}", "--end", f"{until:g}"]
    step_length = chosen_step_length(config, scenario.step_length_s)
    arguments, _ = sumo_arguments(config, config.path, seed=scenario.seed, step_length_s=step_length, sumo_options=options)
    return [sumo, *arguments]


if __name__ == "__main__":
    main()
