#!/usr/bin/env python3
"""Drive every trip of a list, and let SUMO's own driver drive the same trip with the same seed.

    python tools/benchmark_trips.py TRIPS.csv CORPUS [--seed N …] [--jobs N] [--only TEXT] [--step-length S] [--out DIR]
                                    [--json FILE] [--no-baseline] [--timeout S]

TRIPS.csv has the columns scenario, config (path below CORPUS) and ego; others are not read. Each run is a process of its
own; ours are recorded in DIR/<scenario>__<ego>__<seed>, in place of an earlier record. Prints a row a scenario and one over
all, "ours / SUMO's own", then the worst five trips, each with the commands that replay and explain it: not arrived first,
then most collisions, most violations, longest beside SUMO's own. A run that fails or takes too long is a row with its error
and the exit code that a shell would show (124: too long). Exit codes: 0, 1 if a run failed, 2 for wrong input. Control
steps are timed while other runs go on. SUMO's own driver is judged by the same judges, but not on pedestrians and rules.
"""

from __future__ import annotations

import argparse
import csv
import json
import math
import os
import re
import shlex
import signal
import subprocess
import sys
import threading
import time as clock
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor, as_completed
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from sumo_reactive.driver.nouns.record import Scene
from sumo_reactive.errors import InputError, ReactiveError, ScenarioError
from sumo_reactive.lab.recorder import Recorder
from sumo_reactive.lab.scenario import DEFAULT_SEED, Scenario, load_scenario
from sumo_reactive.lab.simulation import run_sumo_driver, run_trial

COLUMNS = ("scenario", "config", "ego")
"""What each row of a list must hold."""

WORST = 5
TIMEOUT_S = 600.0

USAGE_ERROR, INTERNAL_ERROR, TOO_LONG, INTERRUPTED, KILLED = 2, 70, 124, 130, 128
WORKER = "--one-run"
"""First argument of the processes that this program starts; the second is the order as JSON."""

_ANSWER = "\nanswer: "
_NOT_IN_A_NAME = re.compile(r'[/\\:*?"<>|\s]')


class Trip(NamedTuple):
    """A row of the list; `config` is below the corpus as the list says."""

    scenario: str
    config: str
    ego: str


class Order(NamedTuple):
    """One run by one driver; `folder` is for the record, empty: SUMO's own driver."""

    config: str
    ego: str
    seed: int
    step_length_s: float | None
    folder: str


class Outcome(NamedTuple):
    """What a run came to: figures as the judges name them, wall-clock µs of each control step; `error`: why it failed."""

    arrived: bool
    exit_code: int
    verdict: str
    duration_s: float = 0.0
    figures: Mapping[str, float | None] = {}
    control_us: Sequence[float] = ()
    error: str = ""


class Pair(NamedTuple):
    """A trip with a seed, driven by this project and, unless left out, by SUMO."""

    scenario: str
    order: Order
    ours: Outcome
    sumo: Outcome | None

    @property
    def ratio(self) -> float | None:
        """Duration over that of SUMO's own driver, if both arrived."""
        both = self.sumo is not None and self.sumo.arrived and self.ours.arrived
        return self.ours.duration_s / self.sumo.duration_s if both and self.sumo and self.sumo.duration_s > 0.0 else None

    @property
    def errors(self) -> list[str]:
        """Why a run of this pair failed."""
        named = (("", self.ours), ("SUMO's own driver: ", self.sumo))
        return [who + run.error for who, run in named if run is not None and run.error]


Number = float | int | None
Runs = Sequence[Outcome]


class Measure(NamedTuple):
    """A figure over several runs: key in the JSON with its unit, digits, value, and whether SUMO's own has it, too."""

    key: str
    digits: int
    value: Callable[[Runs], Number]
    is_pair: bool = False


def percentile(values: Sequence[float], share: float) -> float | None:
    """Return the percentile `share` (0 to 100), interpolated between neighbours; None of nothing."""
    return float(np.percentile(values, share)) if len(values) else None


def known(runs: Runs, name: str) -> list[float]:
    """Return a figure of all runs that have it."""
    return [value for run in runs if (value := run.figures.get(name)) is not None]


def rms_jerk(runs: Runs) -> float | None:
    """Return the root mean square of the jerk over all the time, m/s³."""
    timed = [(run.duration_s, run.figures["rms_jerk_m_s3"] or 0.0) for run in runs if "rms_jerk_m_s3" in run.figures]
    whole = sum(duration for duration, _ in timed)
    return math.sqrt(sum(duration * jerk**2 for duration, jerk in timed) / whole) if whole else None


def _count(name: str) -> Callable[[Runs], Number]:
    """Return the measure "sum of the judges' figure"."""
    return lambda runs: int(sum(known(runs, name)))


def _largest(*names: str) -> Callable[[Runs], Number]:
    """Return the measure "largest of these figures"."""
    return lambda runs: max((value for name in names for value in known(runs, name)), default=None)


def _control_us(runs: Runs) -> list[float]:
    """Return the time of every control step, µs."""
    return [time for run in runs for time in run.control_us]


SAFETY = {
    "trips": Measure("trips", 0, len),
    "arrived": Measure("arrived", 0, lambda runs: sum(run.arrived for run in runs), True),
    "collisions": Measure("collisions", 0, _count("collisions"), True),
    "red lights": Measure("red_lights_run", 0, _count("red_lights_run")),
    "right of way": Measure("right_of_way_violations", 0, _count("right_of_way_violations")),
    "hard braking": Measure("hard_braking_caused", 0, _count("hard_braking_caused"), True),
}
COMFORT = {
    "max |a| m/s²": Measure("max_abs_acceleration_m_s2", 1, _largest("max_acceleration_m_s2", "max_braking_m_s2"), True),
    "lateral m/s²": Measure("max_lateral_acceleration_m_s2", 1, _largest("max_lateral_acceleration_m_s2"), True),
    "RMS jerk m/s³": Measure("rms_jerk_m_s3", 2, rms_jerk, True),
    "emergencies": Measure("emergencies", 0, _count("emergencies")),
    "step mean µs": Measure("control_step_mean_us", 0, lambda runs: float(np.mean(t)) if (t := _control_us(runs)) else None),
    "step p99 µs": Measure("control_step_p99_us", 0, lambda runs: percentile(_control_us(runs), 99.0)),
}
MEASURES = SAFETY | COMFORT


def main() -> None:
    """Read the list, drive, write the file, print."""
    if sys.argv[1:2] == [WORKER]:
        return answer(Order(*json.loads(sys.argv[2])))
    asked = _arguments()
    try:
        chosen = chosen_trips(asked.trips, asked.corpus, asked.only)
        orders = _orders(chosen, asked)
    except InputError as error:
        print(f"benchmark_trips: {error}", file=sys.stderr)
        raise SystemExit(USAGE_ERROR) from error
    pairs = driven(orders, asked.jobs, asked.timeout, not asked.no_baseline)
    if asked.json:
        asked.json.write_text(json.dumps(as_data(pairs), indent=2, ensure_ascii=False) + "\n", encoding="utf-8")
    show(pairs)
    raise SystemExit(int(any(pair.errors for pair in pairs)))


def _arguments() -> argparse.Namespace:
    """Read the command line; wrong usage ends with exit code 2."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("trips", type=Path, metavar="TRIPS.csv", help="list of trips: scenario, config, ego")
    parser.add_argument("corpus", type=Path, metavar="CORPUS", help="folder that the configs are below")
    parser.add_argument("--seed", type=int, nargs="+", default=[DEFAULT_SEED], metavar="N", help="default 42")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, metavar="N", help="runs at a time; default: cores")
    parser.add_argument("--only", default="", metavar="TEXT", help="trips whose scenario or ego holds this text")
    parser.add_argument("--step-length", type=float, metavar="S", help="simulation step, s; else as the scenario says")
    parser.add_argument("--out", type=Path, default=Path("runs/trips"), metavar="DIR", help="records; default runs/trips")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the figures there, too")
    parser.add_argument("--no-baseline", action="store_true", help="leave SUMO's own driver out")
    parser.add_argument("--timeout", type=float, default=TIMEOUT_S, metavar="S", help="of one run, wall clock; default 600")
    asked = parser.parse_args()
    if complaint := _complaint(asked):
        parser.exit(USAGE_ERROR, f"benchmark_trips: {complaint}\n")
    return asked


def _complaint(asked: argparse.Namespace) -> str:
    """Return what no run could be made with; empty: all is well."""
    if len(set(asked.seed)) < len(asked.seed) or not all(0 <= seed < 2**31 for seed in asked.seed):
        return "--seed: different whole numbers from 0 to 2147483647"
    if asked.jobs < 1 or not asked.timeout > 0.0:
        return "--jobs and --timeout are greater than 0"
    if asked.step_length is not None and not 0.0 < asked.step_length <= 1.0:
        return "--step-length: more than 0 and at most 1 s"
    if asked.out.exists() and not asked.out.is_dir():
        return f"{asked.out}: a file, not a folder for records"
    if asked.json and (asked.json.is_dir() or not asked.json.parent.is_dir()):
        return f"{asked.json}: not a file in a folder that exists"
    return "" if asked.corpus.is_dir() else f"{asked.corpus}: no such folder"


def chosen_trips(path: Path, corpus: Path, only: str = "") -> tuple[Trip, ...]:
    """Return the trips whose scenario or ego holds `only`; raise ScenarioError naming file and column, or line."""
    listed = {line: trip for line, trip in _listed(path) if only in trip.scenario or only in trip.ego}
    if not listed:
        raise ScenarioError(f"{path}: no trip" + (f" whose scenario or ego holds '{only}'" if only else ""))
    folders: dict[str, int] = {}
    for line, trip in listed.items():
        if not (corpus / trip.config).is_file():
            raise ScenarioError(f"{path}:{line}: column 'config': {corpus / trip.config}: no such file")
        if (first := folders.setdefault(folder_of(trip, 0), line)) != line:
            raise ScenarioError(f"{path}:{line}: column 'ego': the trip of '{trip.ego}' is in line {first}, too")
    return tuple(listed.values())


def _listed(path: Path) -> Iterator[tuple[int, Trip]]:
    """Yield line and trip of each row of the list."""
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            rows = csv.DictReader(file)
            for name in COLUMNS:
                if name not in (rows.fieldnames or ()):
                    raise ScenarioError(f"{path}: no column '{name}'; a list of trips has {', '.join(COLUMNS)}")
            for row in rows:
                yield rows.line_num, Trip(*(_cell(path, rows.line_num, row, name) for name in COLUMNS))
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise ScenarioError(f"{path}: cannot be read: {getattr(error, 'strerror', None) or error}") from error


def _cell(path: Path, line: int, row: Mapping[str, str | None], name: str) -> str:
    """Return a cell that must hold something."""
    if not (text := (row[name] or "").strip()):
        raise ScenarioError(f"{path}:{line}: column '{name}': empty")
    return text


def folder_of(trip: Trip, seed: int) -> str:
    """Return the name of the folder for the record of a trip."""
    return _NOT_IN_A_NAME.sub("_", f"{trip.scenario}__{trip.ego}__{seed}")


def _orders(trips: Sequence[Trip], asked: argparse.Namespace) -> list[tuple[str, Order]]:
    """Return scenario and order of each run that is to be made."""
    folder, corpus, step_length = asked.out, asked.corpus, asked.step_length
    return [
        (trip.scenario, Order(str(corpus / trip.config), trip.ego, seed, step_length, str(folder / folder_of(trip, seed))))
        for trip in trips
        for seed in asked.seed
    ]


def driven(orders: Sequence[tuple[str, Order]], jobs: int, timeout: float, baseline: bool) -> list[Pair]:
    """Make all runs, `jobs` at a time, and tell of each on stderr."""
    with ThreadPoolExecutor(jobs) as pool:
        ours = [pool.submit(apart, order, timeout) for _, order in orders]
        sumo = [pool.submit(apart, order._replace(folder=""), timeout) for _, order in orders if baseline]
        titles = [f"{scenario} {order.ego} seed {order.seed}" for scenario, order in orders]
        names = dict(zip(ours, titles, strict=True)) | {run: f"{titles[k]}, SUMO's own driver" for k, run in enumerate(sumo)}
        try:
            _tell(names)
        except KeyboardInterrupt:
            pool.shutdown(wait=False, cancel_futures=True)
            raise SystemExit(INTERRUPTED) from None
    beside = [run.result() for run in sumo]
    return [
        Pair(name, order, ours[k].result(), beside[k] if beside else None) for k, (name, order) in enumerate(orders)
    ]


def _tell(names: Mapping[Future[Outcome], str]) -> None:
    """Wait for all runs; say on stderr what each came to."""
    for k, run in enumerate(as_completed(names), 1):
        print(f"[{k}/{len(names)}] {names[run]}: {run.result().verdict}", file=sys.stderr, flush=True)


def apart(order: Order, timeout: float) -> Outcome:
    """Make a run in a process of its own: libsumo holds one simulation a process, and may take the process down."""
    command = [sys.executable, str(Path(__file__).resolve()), WORKER, json.dumps(order)]
    try:
        done = subprocess.run(
            command, stdin=subprocess.DEVNULL, capture_output=True, encoding="utf-8", errors="replace",
            timeout=timeout, check=False,
        )  # fmt: skip
    except subprocess.TimeoutExpired:
        return failure(f"took longer than {timeout:g} s", TOO_LONG)
    found = done.stdout.rpartition(_ANSWER)
    if done.returncode == 0 and found[1]:
        return Outcome(**json.loads(found[2]))
    if done.returncode < 0:
        return failure(f"the process died of {signal.Signals(-done.returncode).name}", KILLED - done.returncode)
    last = [line.strip() for line in done.stderr.splitlines() if line.strip()][-1:]
    return failure(f"internal error: {' '.join(last) or 'no answer'}", INTERNAL_ERROR)


def failure(error: str, exit_code: int) -> Outcome:
    """Return the outcome of a run that could not be made or finished."""
    line = " ".join(error.split())
    return Outcome(arrived=False, exit_code=exit_code, verdict=f"failed: {line}", error=line)


def answer(order: Order) -> None:
    """Make the run that another process has ordered and print its outcome; end when that process has ended."""
    threading.Thread(target=_end_with, args=(os.getppid(),), daemon=True).start()
    try:
        scenario = replace(
            load_scenario(Path(order.config)), ego=order.ego, seed=order.seed, step_length_s=order.step_length_s
        )
        outcome = drive(scenario, Path(order.folder)) if order.folder else drive_by_sumo(scenario)
    except ReactiveError as error:
        outcome = failure(str(error), error.exit_code)
    print(_ANSWER + json.dumps(outcome._asdict()), flush=True)


def _end_with(parent: int) -> None:
    """Let no run outlive the benchmark that has ordered it."""
    while os.getppid() == parent:
        clock.sleep(1.0)
    os._exit(INTERRUPTED)


def drive(scenario: Scenario, folder: Path) -> Outcome:
    """Drive with this project; keep the record."""
    recorder = Recorder(folder, overwrite=True)
    control_us: list[float] = []

    def watch(scene: Scene) -> None:
        recorder.see(scene)
        control_us.append(round(scene.step.control_us, 1))

    result = run_trial(scenario, observer=watch)
    recorder.write(result)
    figures = dict(result.figures)
    return Outcome(result.arrived, result.exit_code, result.verdict, result.duration_s, figures, control_us)


def drive_by_sumo(scenario: Scenario) -> Outcome:
    """Let SUMO drive the same trip, started in the same way, and judge it."""
    result = run_sumo_driver(scenario)
    return Outcome(result.arrived, int(not result.arrived), result.verdict, result.duration_s, dict(result.figures))


def by_scenario(pairs: Sequence[Pair]) -> dict[str, list[Pair]]:
    """Return the pairs of each scenario, in the order of the list."""
    return {name: [pair for pair in pairs if pair.scenario == name] for name in dict.fromkeys(p.scenario for p in pairs)}


def ratios_of(pairs: Sequence[Pair]) -> list[float]:
    """Return the durations over those of SUMO's own driver, where both arrived."""
    return [ratio for pair in pairs if (ratio := pair.ratio) is not None]


def cells(pairs: Sequence[Pair]) -> dict[str, str]:
    """Return a row of the table: "ours / SUMO's own" where both have the figure."""
    ratios = [_text(percentile(ratios_of(pairs), share), 2) for share in (50.0, 95.0)]
    codes = Counter(pair.ours.exit_code for pair in pairs)
    return {
        **{title: _cell_of(measure, pairs) for title, measure in SAFETY.items()},
        "duration / SUMO's p50, p95": ", ".join(ratios),
        **{title: _cell_of(measure, pairs) for title, measure in COMFORT.items()},
        "exit codes": ", ".join(f"{code} ×{number}" for code, number in sorted(codes.items())),
    }


def _cell_of(measure: Measure, pairs: Sequence[Pair]) -> str:
    """Return a figure over these trips, beside that of SUMO's own driver if it drove and has one."""
    ours, sumo = [pair.ours for pair in pairs], [pair.sumo for pair in pairs if pair.sumo]
    sides = [ours, sumo] if measure.is_pair and sumo else [ours]
    return " / ".join(_text(measure.value(side), measure.digits) for side in sides)


def _text(value: Number, digits: int) -> str:
    return "–" if value is None else f"{value:.{digits}f}"


def worst(pairs: Sequence[Pair], number: int = WORST) -> list[Pair]:
    """Return the worst first: failed or not arrived, then collisions, then violations, then the longest beside SUMO's."""
    return sorted(pairs, key=_badness, reverse=True)[:number]


def _badness(pair: Pair) -> tuple[float, ...]:
    ours = pair.ours
    violations = sum(known([ours], "red_lights_run")) + sum(known([ours], "right_of_way_violations"))
    return (not ours.arrived, bool(ours.error), sum(known([ours], "collisions")), violations, pair.ratio or 0.0)


def show(pairs: Sequence[Pair]) -> None:
    """Print the table, for a reader or as Markdown, the runs of SUMO's own driver that failed, and the worst trips."""
    table = {name: cells(group) for name, group in by_scenario(pairs).items()}
    if len(table) > 1:
        table["**all**"] = cells(pairs)
    if sys.stdout.isatty():
        Console().print(_rich(table))
    else:
        print(markdown(table))
    for pair in pairs:
        if pair.sumo and (pair.sumo.error or not pair.sumo.arrived):
            print(f"\n{pair.scenario} {pair.order.ego} seed {pair.order.seed}, SUMO's own driver: {pair.sumo.verdict}")
    print("\nWorst trips:")
    for rank, pair in enumerate(worst(pairs), 1):
        print(f"\n{rank}. {told(pair)}")


def markdown(table: Mapping[str, Mapping[str, str]]) -> str:
    """Return the table in Markdown."""
    titles = next(iter(table.values()))
    lines = [f"| ours / SUMO's own | {' | '.join(titles)} |", f"|---|{'---:|' * len(titles)}"]
    lines += [f"| {name} | {' | '.join(row.values())} |" for name, row in table.items()]
    return "\n".join(line.replace("|a|", r"\|a\|") for line in lines)


def _rich(table: Mapping[str, Mapping[str, str]]) -> Table:
    """Return the table for a terminal."""
    shown = Table(box=SIMPLE_HEAD, padding=(0, 1, 0, 0))
    shown.add_column("ours / SUMO's own", overflow="fold")
    for title in next(iter(table.values())):
        shown.add_column(title, justify="right", overflow="fold")
    for name, row in table.items():
        shown.add_row(escape(name.strip("*")), *row.values())
    return shown


def told(pair: Pair) -> str:
    """Return what a trip came to in one line, and the commands that replay and explain it."""
    order, ours = pair.order, pair.ours
    slow = f"; {pair.ratio:.2f} × SUMO's own duration" if pair.ratio is not None else ""
    lines = [f"{pair.scenario} {order.ego} seed {order.seed}: {' '.join(ours.verdict.split())}{slow}", f"   {replay(order)}"]
    return "\n".join(lines if ours.error else [*lines, f"   sumo-reactive explain {shlex.quote(order.folder)}"])


def replay(order: Order) -> str:
    """Return the command that makes the same run again, in place of its record."""
    step = ["--step-length", f"{order.step_length_s:g}"] if order.step_length_s is not None else []
    words = ["sumo-reactive", "run", order.config, "--ego", order.ego, "--seed", str(order.seed), *step]
    return shlex.join([*words, "--out", order.folder, "--overwrite"])


def as_data(pairs: Sequence[Pair]) -> dict[str, object]:
    """Return everything measured as plain data, units in the keys."""
    scenarios = {name: _figures(group) for name, group in by_scenario(pairs).items()}
    return {"all": _figures(pairs), "scenarios": scenarios, "trips": [_trip(pair) for pair in pairs]}


def _figures(pairs: Sequence[Pair]) -> dict[str, object]:
    """Return every measure over these trips by its key, SUMO's own apart."""
    ours, sumo = [pair.ours for pair in pairs], [pair.sumo for pair in pairs if pair.sumo]
    codes, ratios = Counter(run.exit_code for run in ours), ratios_of(pairs)
    theirs = {m.key: _rounded(m.value(sumo), m.digits + 2) for m in MEASURES.values() if m.is_pair}
    return {
        **{m.key: _rounded(m.value(ours), m.digits + 2) for m in MEASURES.values()},
        "duration_ratio_p50": _rounded(percentile(ratios, 50.0), 4),
        "duration_ratio_p95": _rounded(percentile(ratios, 95.0), 4),
        "exit_codes": dict(sorted(codes.items())),
        "sumo": theirs if sumo else None,
    }


def _rounded(value: Number, digits: int) -> Number:
    return None if value is None else round(value, digits)


def _trip(pair: Pair) -> dict[str, object]:
    """Return one trip: what was asked, what each driver made of it, and how to see it again."""
    asked = {"scenario": pair.scenario, **pair.order._asdict(), "duration_ratio": _rounded(pair.ratio, 4)}
    sides = {"ours": _outcome(pair.ours), "sumo": _outcome(pair.sumo) if pair.sumo else None}
    return asked | sides | {"replay": replay(pair.order)}


def _outcome(run: Outcome) -> dict[str, object]:
    """Return an outcome without the time of each step."""
    whole = {name: value for name, value in run._asdict().items() if name != "control_us"}
    return whole | {"duration_s": _rounded(run.duration_s, 3)}


if __name__ == "__main__":
    main()
