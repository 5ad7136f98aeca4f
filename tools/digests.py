#!/usr/bin/env python3
"""Write digests of what the ego drives and decides, or compare them with those written before.

    python tools/digests.py [--write | --also] [--only TEXT] [--jobs N]
    python tools/digests.py --trips CORPUS TRIPS.csv --file F [--seed N …] [--write] [--only TEXT] [--jobs N]

Without `--trips` these are the scenarios of this repository with both profiles and the seeds 42, 1 and 2, and the file is
tests/end_to_end/digests.json. TRIPS.csv has the columns scenario, config (path below CORPUS), ego and, if it likes,
step_length_s; seed 42 unless given. A run is called "scenario profile seed", a trip "scenario ego profile seed": `--only`
takes those whose name holds TEXT. Each run is written when it has ended; what the file says of others stays.

A digest is of time, place, heading, speed, acceleration and steering angle in millionths, and of each decision's time and
words: not of the last bits of a machine's arithmetic, and not of wall-clock times. Machines with other vector instructions
differ in such bits, and where two commands are as good as each other, these decide: `--also` keeps what a run is on this
machine beside what it is on others, and a run that is like one of them is as before. Where two runs part, the time and the
columns are told. Exit codes: 0, 1 if a run differs, or cannot be made when it is written, 2 for wrong input.
"""

from __future__ import annotations

import argparse
import csv
import hashlib
import json
import os
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from itertools import zip_longest
from pathlib import Path
from queue import SimpleQueue
from typing import Any, Self, TypeVar

from sumo_reactive.driver.nouns.record import Scene, StepRecord
from sumo_reactive.driver.parameters import Profile
from sumo_reactive.errors import InputError, ScenarioError
from sumo_reactive.lab.columns import COLUMNS
from sumo_reactive.lab.runner import Runner
from sumo_reactive.lab.scenario import DEFAULT_SEED, Scenario, load_scenario
from sumo_reactive.lab.simulation import run_trial
from sumo_reactive.lab.task import Ending
from sumo_reactive.lab.trace import Entry, entries, line_of

ROOT = Path(__file__).resolve().parent.parent
OWN = ROOT / "tests" / "end_to_end" / "digests.json"
SEEDS = (DEFAULT_SEED, 1, 2)
FIELDS = ("x", "y", "heading", "speed", "acceleration", "steering_angle")
BLOCK_S = 10.0
TIMEOUT_S = 600.0
USAGE_ERROR = 2

_ALIKE = {"-0.000000": "0.000000", "-3.141593": "3.141593"}
"""One number, two texts: which it is depends on the last bit."""
_LETTERS = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_"
_BLOCK, _LINE = 8, 4
"""Hexadecimal digits for a block of time and for a decision."""

Digests = dict[str, Any]
Order = TypeVar("Order")
Found = TypeVar("Found")


def main() -> None:
    """Drive, and write or compare."""
    asked = _arguments()
    try:
        runs = _own_runs() if asked.trips is None else dict(listed_runs(*asked.trips, asked.seed or [DEFAULT_SEED]))
        known = _read(asked.file) if asked.file.exists() or not asked.write else {}
    except InputError as error:
        raise SystemExit(_complain(str(error))) from error
    chosen = {name: scenario for name, scenario in runs.items() if asked.only in name}
    if not chosen:
        raise SystemExit(_complain(f"no run whose name holds '{asked.only}'"))
    wrong = 0
    for name, digests in driven(chosen, asked.jobs, asked.timeout):
        parts = "" if asked.write else parting_from_all(known.get(name, ()), digests)
        wrong += not digests["steps"] if asked.write or asked.also else bool(parts)
        print(f"{name}: {parts or digests['told']}", flush=True)
        if asked.write or (asked.also and parts):
            known[name] = [digests] if asked.write else [*known.get(name, []), digests]
            _write(asked.file, known)
    print(f"{len(chosen)} runs, {wrong} {'failed' if asked.write or asked.also else 'differ'}")
    raise SystemExit(int(wrong > 0))


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--trips", type=Path, nargs=2, metavar=("CORPUS", "TRIPS.csv"), help="drive a list of trips instead")
    parser.add_argument("--file", type=Path, metavar="F", help="the digests; else those of this repository's scenarios")
    parser.add_argument("--write", action="store_true", help="write the file instead of comparing")
    parser.add_argument("--also", action="store_true", help="keep beside what is there what differs on this machine")
    parser.add_argument("--only", default="", metavar="TEXT", help="runs whose name holds this text")
    parser.add_argument("--seed", type=int, nargs="+", metavar="N", help=f"of trips; default {DEFAULT_SEED}")
    parser.add_argument("--jobs", type=int, default=1, metavar="N", help="runs at a time; default 1")
    parser.add_argument("--timeout", type=float, default=TIMEOUT_S, metavar="S", help="of one run, wall clock; default 600")
    asked = parser.parse_args()
    if asked.trips and not asked.file:
        parser.error("--trips needs --file")
    if asked.seed and not asked.trips:
        parser.error("--seed is for --trips")
    if asked.jobs < 1 or not asked.timeout > 0.0:
        parser.error("--jobs and --timeout are greater than 0")
    asked.file = asked.file or OWN
    return asked


def _complain(message: str) -> int:
    print(f"digests: {message}", file=sys.stderr)
    return USAGE_ERROR


def _own_runs() -> dict[str, Scenario]:
    """Return this repository's scenarios with each profile and seed by the run's name."""
    scenarios = [load_scenario(path) for path in sorted((ROOT / "scenarios").glob("*.toml"))]
    return {
        f"{scenario.source.stem} {profile.value} {seed}": replace(scenario, profile=profile, seed=seed)
        for scenario in scenarios
        for profile in Profile
        for seed in SEEDS
    }


def listed_runs(corpus: Path, path: Path, seeds: Sequence[int]) -> Iterator[tuple[str, Scenario]]:
    """Yield the trips of a list; raise ScenarioError naming file, and column or line."""
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            rows = list(csv.DictReader(file))
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise ScenarioError(f"{path}: cannot be read: {getattr(error, 'strerror', None) or error}") from error
    for number, row in enumerate(rows, 1):
        try:
            step_length = float(row["step_length_s"]) if row.get("step_length_s") else None
            scenario = replace(load_scenario(corpus / row["config"]), ego=row["ego"], step_length_s=step_length)
            names = {f"{row['scenario']} {row['ego']} {scenario.profile.value} {seed}": seed for seed in seeds}
        except (KeyError, TypeError, ValueError) as error:
            raise ScenarioError(f"{path}: trip {number}: {type(error).__name__}: {error}") from error
        yield from ((name, replace(scenario, seed=seed)) for name, seed in names.items())


def driven(runs: Mapping[str, Scenario], jobs: int, timeout: float) -> Iterator[tuple[str, Digests]]:
    """Drive `jobs` runs at a time in processes of their own; yield name and digests in the order of the runs."""

    def one(scenario: Scenario, runner: Runner) -> Digests:
        ending, value, _ = runner.call("digests:digests_of_run", scenario, timeout)
        return value if ending is Ending.DONE else _nothing(value)

    yield from zip(runs, in_processes(runs.values(), one, jobs), strict=True)


def in_processes(orders: Iterable[Order], one: Callable[[Order, Runner], Found], jobs: int) -> Iterator[Found]:
    """Carry out `jobs` of the `orders` at a time, each with a runner whose process finds the tools; yield what `one` found
    in their order."""
    with Processes(jobs) as processes:
        yield from processes.each(orders, one)


class Processes:
    """Runners whose processes find the tools, kept from one list of orders to the next."""

    def __init__(self, jobs: int) -> None:
        here = str(Path(__file__).resolve().parent)
        os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, (here, os.environ.get("PYTHONPATH", ""))))
        self._runners = [Runner() for _ in range(jobs)]
        self._threads = ThreadPoolExecutor(jobs)

    def each(self, orders: Iterable[Order], one: Callable[[Order, Runner], Found]) -> Iterator[Found]:
        """Carry out as many of the `orders` at a time as there are runners; yield what `one` found in their order."""
        idle: SimpleQueue[Runner] = SimpleQueue()
        for runner in self._runners:
            idle.put(runner)

        def with_runner(order: Order) -> Found:
            runner = idle.get()
            try:
                return one(order, runner)
            finally:
                idle.put(runner)

        yield from self._threads.map(with_runner, orders)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._threads.shutdown(wait=False, cancel_futures=True)
        for runner in self._runners:
            runner.close()


def _nothing(reason: str) -> Digests:
    """Return what stands for a run that could not be made."""
    return {"told": f"failed: {reason}", "trajectory": "", "decisions": "", "steps": "", "blocks": "", "lines": ""}


def digests_of_run(scenario: Scenario) -> Digests:
    """Drive in this process; return the digests as plain data."""
    steps: list[StepRecord] = []

    def see(scene: Scene) -> None:
        steps.append(scene.step)

    return digests_of(run_trial(scenario, observer=see).arrived, steps)


def digests_of(arrived: bool, steps: Sequence[StepRecord]) -> Digests:
    """Return the digests of a run.

    `trajectory` and `decisions` are of all of it; `blocks` has 8 digits for each 10 s and `lines` 4 for each decision.
    `steps` has a letter for each step, with a bit of each column: two columns that differ show so in every other step.
    """
    rows = [[_text(getattr(step, field)) for field in ("time", *FIELDS)] for step in steps]
    first = steps[0].time
    step_s = round((steps[-1].time - first) / max(1, len(steps) - 1), 6)
    size = _block_size(step_s)
    lines = [words(entry) for entry in entries(steps)]
    return {
        "told": f"{'arrived' if arrived else 'not arrived'} at {steps[-1].time:.2f} s, {len(lines)} decisions",
        "first_s": round(first, 6),
        "step_s": step_s,
        "trajectory": _digest(rows),
        "decisions": _digest(lines),
        "steps": "".join(_letter(row[1:]) for row in rows),
        "blocks": "".join(_digest(rows[k : k + size])[:_BLOCK] for k in range(0, len(rows), size)),
        "lines": "".join(_digest(line)[:_LINE] for line in lines),
    }


def words(entry: Entry) -> list[Any]:
    """Return time and words of a decision, as `decisions.jsonl` has them."""
    line = line_of(entry)
    decisions = [[one[key] for key in ("behaviour", "reason", "region", "cause")] for one in line["decisions"]]
    return [_text(line["time_s"]), line["behaviour"], line["instruction"], decisions]


def _text(value: float) -> str:
    text = f"{value:.6f}"
    return _ALIKE.get(text, text)


def _digest(value: object) -> str:
    return hashlib.sha256(json.dumps(value).encode()).hexdigest()[:16]


def _letter(cells: Sequence[str]) -> str:
    return _LETTERS[sum((hashlib.sha256(cell.encode()).digest()[0] & 1) << k for k, cell in enumerate(cells))]


def _block_size(step_s: float) -> int:
    return max(1, round(BLOCK_S / step_s)) if step_s > 0.0 else 1


def parting_from_all(known: Sequence[Digests], now: Digests) -> str:
    """Return in one line where a run parts from the first of those known, one a kind of machine; empty: it is like one."""
    parts = [parting(one, now) for one in known]
    return "" if "" in parts else next(iter(parts), "differs: not in the file")


def parting(before: Digests, now: Digests) -> str:
    """Return in one line where two runs part; empty: they are alike."""
    if not before["steps"] or not now["steps"]:
        return "" if before["told"] == now["told"] else f"differs: {before['told']}; now {now['told']}"
    found = []
    if before["trajectory"] != now["trajectory"]:
        found.append(_where_driving_parts(before, now))
    if before["decisions"] != now["decisions"]:
        found.append(f"decision {_first(before['lines'], now['lines'], _LINE) + 1} of {len(now['lines']) // _LINE}")
    if before["told"] != now["told"]:
        found.append(f"{before['told']}; now {now['told']}")
    return f"differs: {'; '.join(found)}" if found else ""


def _where_driving_parts(before: Digests, now: Digests) -> str:
    """Name the block of time, which is sure, and the first step in it that shows a difference, with its columns."""
    if (before["first_s"], before["step_s"]) != (now["first_s"], now["step_s"]):
        was, is_now = (f"first step at {one['first_s']} s, a step {one['step_s']} s" for one in (before, now))
        return f"{was}; now {is_now}"
    size = _block_size(now["step_s"])
    start = _first(before["blocks"], now["blocks"], _BLOCK) * size
    end = start + size
    step = start + _first(before["steps"][start:end], now["steps"][start:end], 1)
    a, b = before["steps"][step : step + 1], now["steps"][step : step + 1]
    if not a or not b:
        return f"from {_time(now, min(step, len(now['steps'])))} on, where one ends"
    bits = _LETTERS.index(a) ^ _LETTERS.index(b)
    columns = [COLUMNS[field] for k, field in enumerate(FIELDS) if bits >> k & 1]
    return f"at {_time(now, step)} in {', '.join(columns)} (in the {BLOCK_S:g} s from {_time(now, start)} for sure)"


def _first(before: str, now: str, width: int) -> int:
    """Return the number of the first piece that differs; how many there are if none does."""
    pairs = zip_longest(*([text[k : k + width] for k in range(0, len(text), width)] for text in (before, now)))
    return next((k for k, (a, b) in enumerate(pairs) if a != b), max(len(before), len(now)) // width)


def _time(digests: Digests, step: int) -> str:
    return f"{digests['first_s'] + step * digests['step_s']:.2f} s"


def _read(path: Path) -> dict[str, list[Digests]]:
    try:
        return dict(json.loads(path.read_text(encoding="utf-8")))
    except (OSError, ValueError) as error:
        raise ScenarioError(f"{path}: cannot be read: {getattr(error, 'strerror', None) or error}") from error


def _write(path: Path, runs: Mapping[str, Sequence[Digests]]) -> None:
    """Write a line a run, so that a difference of two files names the runs."""
    lines = ",\n".join(f"{json.dumps(name)}: {json.dumps(one)}" for name, one in sorted(runs.items()))
    partial = path.with_name(f"{path.name}.partial")
    partial.write_text(f"{{\n{lines}\n}}\n", encoding="utf-8")
    partial.replace(path)


if __name__ == "__main__":
    main()
