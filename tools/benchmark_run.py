#!/usr/bin/env python3
"""Time whole runs against plain `sumo` on the same scenario, seed, step length and end.

    python tools/benchmark_run.py [--scenario FILE --scale FACTOR --until S] [--until-end] [--repeats N] [--sumo PROGRAM]

Both programs run in turn and simulate the same time: from the scenario's begin until the ego has arrived, or, with
`--until-end`, until the scenario's end. All times are the processor's, so that what else runs on the machine counts for
neither. "Process" is that of the whole process, "simulation" that of the simulated part alone: without interpreter,
imports, reading the network and, in ours, the plan, the loading of the kernels and the verdicts at the end. The figures are
medians, the ratio that of the runs side by side. "Added" is what a driven step costs more than SUMO's own.
"""

from __future__ import annotations

import argparse
import importlib.util
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time as clock
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from statistics import mean, median
from typing import NamedTuple

from sumolib import checkBinary

from sumo_reactive.lab.scenario import load_scenario
from sumo_reactive.lab.simulation import run_trial
from sumo_reactive.sumo.config import read_config
from sumo_reactive.sumo.launch import chosen_step_length, sumo_arguments

ROOT = Path(__file__).resolve().parent.parent
CASES = (("multi_lane_road", 3.0, None), ("on_ramp_merge", 3.0, None), ("city_grid", 0.25, None), ("city_grid", 3.0, 240.0))
"""Own scenarios, the factor on their traffic, and when to end (s): three with about 60 cars, one with 500 or more."""

TARGETS = "targets: ratio ≤ 2.5 with about 60 vehicles in the network, ≤ 1.2 with 500 or more"

WORKER = "--one-run"
"""First argument of the processes that this program starts to drive; the second is the case as JSON."""

WAITS, PLAYS = "waiting for the ego to depart", "playing out"
"""What a run says while it does not drive."""


class Case(NamedTuple):
    """A scenario `.toml`, the factor on its traffic, the latest end (s, None: the ego's arrival), whether to play it out."""

    scenario: Path
    scale: float
    until: float | None
    until_end: bool


class Run(NamedTuple):
    """Processor seconds of the process and of the simulated part alone; simulation time of the end; steps driven."""

    process: float
    simulation: float
    until: float = 0.0
    steps: int = 0


@dataclass
class Stopwatch:
    """Counts the processor's seconds between the steps of a run, and the steps that are driven: a run's `progress`.

    The plan and the loading of the kernels lie between waiting and driving, and are left out.
    """

    simulation: float = 0.0
    until: float = 0.0
    steps: int = 0
    _last: float = 0.0
    _waited: bool = True

    def step(self, time: float, doing: str) -> None:
        """Count a step that has ended at `time`."""
        now, waits = clock.process_time(), doing == WAITS
        if self._last and waits == self._waited:
            self.simulation += now - self._last
        self.until, self.steps = time, self.steps + (doing not in (WAITS, PLAYS))
        self._last, self._waited = now, waits


def main() -> None:
    """Print one line a case."""
    if sys.argv[1:2] == [WORKER]:
        drive(Case(Path(sys.argv[2]), *json.loads(sys.argv[3])))
        return
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


def plain_program() -> str | None:
    """Return the plain sumo program: the package's own, not the script that starts it, else one on the path."""
    package = importlib.util.find_spec("sumo")
    folders = [str(Path(place) / "bin") for place in (package.submodule_search_locations or ())] if package else []
    return shutil.which("sumo", path=os.pathsep.join(folders)) or shutil.which("sumo")


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


def drive(case: Case) -> None:
    """Drive the ego to its goal in this process; print what the stopwatch says."""
    watch, options = Stopwatch(), ("--scale", f"{case.scale:g}")
    scenario = load_scenario(case.scenario)
    until = scenario.until_s if case.until is None else case.until
    run_trial(replace(scenario, until_s=until, until_end=case.until_end, sumo_options=options), progress=watch.step)
    print(json.dumps({name: value for name, value in asdict(watch).items() if not name.startswith("_")}))


def ours(case: Case) -> Run:
    """Drive the ego to its goal in a process of its own."""
    rest = json.dumps([case.scale, case.until, case.until_end])
    whole, said = processor_time([sys.executable, __file__, WORKER, str(case.scenario), rest])
    return Run(whole, **json.loads(said.splitlines()[-1]))


def processor_time(command: Sequence[str]) -> tuple[float, str]:
    """Run a program; return the processor's seconds that it took, and what it said. Ends with that if it fails."""
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as process:
        said = process.stdout.read() if process.stdout else ""
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        raise SystemExit(said)
    return used.ru_utime + used.ru_stime, said


def plain(case: Case, sumo: str, until: float, options: Sequence[str] = ()) -> float:
    """Let SUMO alone simulate the same; return the processor's seconds of its process."""
    return processor_time([*_plain(case, sumo, until), *options])[0]


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
    scenario = load_scenario(case.scenario)
    config = read_config(scenario.config)
    options = ["--scale", f"{case.scale:g}", "--end", f"{until:g}"]
    step_length = chosen_step_length(config, scenario.step_length_s)
    arguments, _ = sumo_arguments(config, config.path, seed=scenario.seed, step_length_s=step_length, sumo_options=options)
    return [sumo, *arguments]


if __name__ == "__main__":
    main()
