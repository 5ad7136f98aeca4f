#!/usr/bin/env python3
"""Compare the profile of 1991 with the finer discretisation that its authors could not afford (F&L 1991, §4).

    python tools/compare_profiles.py [SCENARIO…] [--json FILE]

Drives scenarios of this repository, by default all but city_grid, with `--profile default` and `--profile paper`, each
run in a process of its own, and prints a Markdown table of pairs "default / paper", and below it what a control step takes
of the processor. Exit codes: 0, 1 if a run failed, 2 for wrong usage. The profiles differ in the command space, in δt and
in U₁: exact distances against bitmaps.
"""

from __future__ import annotations

import argparse
import json
import math
import multiprocessing
import sys
import time as clock
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple
from unittest.mock import patch

import numpy as np
from numpy.typing import NDArray

from sumo_reactive.driver.controller import Controller
from sumo_reactive.driver.field.command_grid import CommandGrid, lattice, paper_grid
from sumo_reactive.driver.nouns.record import Scene
from sumo_reactive.driver.parameters import USUAL, Profile
from sumo_reactive.driver.vehicle.limits import VehicleLimits
from sumo_reactive.errors import ReactiveError
from sumo_reactive.lab.metric_names import METRICS
from sumo_reactive.lab.scenario import load_scenario
from sumo_reactive.lab.simulation import run_trial

ROOT = Path(__file__).resolve().parent.parent
PROFILES = (Profile.DEFAULT, Profile.PAPER)
LEFT_OUT = ("city_grid",)
"""It takes minutes, most of them SUMO's."""

_CAR = VehicleLimits(
    length=4.7, width=1.8, wheelbase=2.8, front_overhang=0.9, max_speed=55.0, max_acceleration=2.6,
    comfort_deceleration=2.5, service_deceleration=4.5, emergency_deceleration=8.0, max_steering_angle=0.65,
    max_steering_rate=1.0, max_lateral_acceleration=4.0, comfort_lateral_acceleration=3.0,
)  # fmt: skip
"""Any car: the size of the command space does not depend on it."""


class Drive(NamedTuple):
    """One run: verdict, |d| of each step (m) and the processor's time for it (µs), duration (s), and the judges' figures."""

    verdict: str
    is_clean: bool
    distances: NDArray[np.float64]
    control_us: NDArray[np.float64]
    duration: float
    figures: dict[str, float | None]


class Measure(NamedTuple):
    """A column: title, key in the JSON with its unit, digits, and the value over one or several runs."""

    title: str
    key: str
    digits: int
    value: Callable[[Sequence[Drive]], float | None]


def _largest(name: str) -> Callable[[Sequence[Drive]], float | None]:
    """Return the measure "largest of the judges' figure"."""
    return lambda drives: max(_known(drives, name), default=None)


def _smallest(name: str) -> Callable[[Sequence[Drive]], float | None]:
    """Return the measure "smallest of the judges' figure"."""
    return lambda drives: min(_known(drives, name), default=None)


def _known(drives: Sequence[Drive], name: str) -> list[float]:
    """Return a figure of all runs that have it."""
    return [value for drive in drives if (value := drive.figures[name]) is not None]


def _rms_distance(drives: Sequence[Drive]) -> float:
    """Return the root mean square of d over all steps, m."""
    return math.sqrt(float(np.mean(np.concatenate([drive.distances for drive in drives]) ** 2)))


def _rms_jerk(drives: Sequence[Drive]) -> float:
    """Return the root mean square of the jerk over all the time, m/s³."""
    squares = sum(drive.duration * (drive.figures["rms_jerk_m_s3"] or 0.0) ** 2 for drive in drives)
    return math.sqrt(squares / sum(drive.duration for drive in drives))


def _control_us(drives: Sequence[Drive]) -> NDArray[np.float64]:
    """Return the time of every control step, µs."""
    return np.concatenate([drive.control_us for drive in drives])


def _metric(key: str, value: Callable[[Sequence[Drive]], float | None], digits: int = 2) -> Measure:
    """Return the measure of a metric, which is called what it is called everywhere."""
    return Measure(METRICS[key].title, key, digits, value)


MEASURES = (
    Measure("RMS of d (m)", "rms_tracking_error_m", 3, _rms_distance),
    Measure("max of d (m)", "max_tracking_error_m", 2, lambda drives: max(float(d.distances.max()) for d in drives)),
    _metric("rms_jerk_m_s3", _rms_jerk),
    _metric("max_lateral_acceleration_m_s2", _largest("max_lateral_acceleration_m_s2")),
    _metric("max_braking_m_s2", _largest("max_braking_m_s2")),
    _metric("duration_s", lambda drives: sum(drive.duration for drive in drives), 1),
    _metric("min_time_to_collision_s", _smallest("min_time_to_collision_s")),
    _metric("emergencies", lambda drives: sum(_known(drives, "emergencies")), 0),
)
"""What the same versions give again."""

TIMES = (
    Measure("mean (µs)", "control_step_cpu_mean_us", 0, lambda drives: float(_control_us(drives).mean())),
    Measure("p99 (µs)", "control_step_cpu_p99_us", 0, lambda drives: float(np.percentile(_control_us(drives), 99.0))),
)


def main() -> None:
    """Drive, print the table, write the file."""
    asked = _arguments()
    drives: dict[str, tuple[Drive, ...]] = {}
    for name in asked.names or known_names():
        print(f"driving {name}…", file=sys.stderr)
        drives[name] = tuple(_apart(name, profile) for profile in PROFILES)
    print(f"{header()}\n\n{table(drives)}\n\nControl step, processor's time:\n\n{table(drives, TIMES)}")
    for name, pair in drives.items():
        for profile, drive in zip(PROFILES, pair, strict=True):
            if not drive.is_clean:
                print(f"\n{name}, profile {profile.value}: {drive.verdict}")
    if asked.json:
        asked.json.write_text(json.dumps(as_data(drives), indent=2, ensure_ascii=False) + "\n", encoding="utf-8")


def _arguments() -> argparse.Namespace:
    """Read the command line; wrong usage ends with exit code 2."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="SCENARIO", help="of scenarios/; without one all but city_grid")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the figures there, too")
    asked = parser.parse_args()
    there = sorted(path.stem for path in (ROOT / "scenarios").glob("*.toml"))
    if unknown := [name for name in asked.names if name not in there]:
        parser.error(f"no scenario named {', '.join(unknown)}; there are {', '.join(there)}")
    if asked.json and (asked.json.is_dir() or not asked.json.parent.is_dir()):
        parser.error(f"{asked.json}: not a file in a folder that exists")
    return asked


def known_names() -> list[str]:
    """Return the scenarios that are driven unless named."""
    return sorted(path.stem for path in (ROOT / "scenarios").glob("*.toml") if path.stem not in LEFT_OUT)


def _apart(name: str, profile: Profile) -> Drive:
    """Drive in a process of its own: libsumo holds one simulation a process."""
    context = multiprocessing.get_context("spawn")
    try:
        with ProcessPoolExecutor(1, mp_context=context) as pool:
            return pool.submit(drive_once, name, profile).result()
    except (ReactiveError, BrokenProcessPool) as error:
        raise SystemExit(f"{name}, profile {profile.value}: {error}") from error


def drive_once(name: str, profile: Profile) -> Drive:
    """Drive one scenario in this process."""
    scenes: list[Scene] = []
    scenario = replace(load_scenario(ROOT / "scenarios" / f"{name}.toml"), profile=profile)
    with steps_timed() as times:
        result = run_trial(scenario, observer=scenes.append)
    return Drive(
        result.verdict,
        result.exit_code == 0,
        np.abs([scene.step.d for scene in scenes]),
        np.array(times[1:]),  # the first loads what a step needs
        result.duration_s,
        dict(result.figures),
    )


@contextmanager
def steps_timed() -> Iterator[list[float]]:
    """Give a list that gets the processor's time of each control step, µs."""
    times: list[float] = []
    whole = Controller.step

    def timed(controller: Controller, *given: object) -> object:
        began = clock.thread_time()
        step = whole(controller, *given)  # type: ignore[arg-type]
        times.append(1e6 * (clock.thread_time() - began))
        return step

    with patch.object(Controller, "step", timed):
        yield times


def table(drives: Mapping[str, Sequence[Drive]], measures: Sequence[Measure] = MEASURES) -> str:
    """Return the Markdown table: a row a scenario, one over all, pairs "default / paper"."""
    titles = " | ".join(measure.title for measure in measures)
    lines = [f"| default / paper | {titles} |", f"|---|{'---:|' * len(measures)}"]
    rows = {name: [[one] for one in pair] for name, pair in drives.items()}
    if len(rows) > 1:
        rows["**all**"] = [list(one) for one in zip(*drives.values(), strict=True)]
    lines += [f"| {name} | {' | '.join(_pair(measure, row) for measure in measures)} |" for name, row in rows.items()]
    return "\n".join(lines)


def header() -> str:
    """Say what the two profiles are."""
    fine, paper = (f"{size} commands, δt = {period:g} s" for size, period in spaces().values())
    return (
        f"default: {fine}, exact distances; paper: {paper}, bitmaps. d: front axle off C. A step is one of simulation; a "
        "command of the paper's is held over several."
    )


def spaces() -> dict[str, tuple[int, float]]:
    """Return the size of the command space and the longest δt (s) of each profile."""
    fine = lattice(_CAR, 10.0, 0.0, USUAL.control_period_s)
    paper = paper_grid(_CAR, 10.0, USUAL.paper_control_period_s)
    return {"default": (_size(fine), USUAL.control_period_s), "paper": (_size(paper), USUAL.paper_control_period_s)}


def _size(grid: CommandGrid) -> int:
    """Return how many commands there are."""
    return len(grid.accelerations) * len(grid.steering_rates)


def _pair(measure: Measure, row: Sequence[Sequence[Drive]]) -> str:
    """Return the cell "default / paper"."""
    values = (measure.value(drives) for drives in row)
    return " / ".join("–" if value is None else f"{value:.{measure.digits}f}" for value in values)


def as_data(drives: Mapping[str, Sequence[Drive]]) -> dict[str, object]:
    """Return everything measured as plain data, units in the keys."""
    profiles = {name: {"commands": size, "control_period_s": period} for name, (size, period) in spaces().items()}
    scenarios = {
        name: {p.value: _figures([drive]) | {"verdict": drive.verdict} for p, drive in zip(PROFILES, pair, strict=True)}
        for name, pair in drives.items()
    }
    overall = {
        profile.value: _figures(alike) for profile, alike in zip(PROFILES, zip(*drives.values(), strict=True), strict=True)
    }
    return {"profiles": profiles, "scenarios": scenarios, "all": overall}


def _figures(drives: Sequence[Drive]) -> dict[str, float | str | None]:
    """Return every measure over these runs by its key."""
    values = {measure.key: (measure.value(drives), measure.digits) for measure in (*MEASURES, *TIMES)}
    return {key: None if value is None else round(value, digits + 2) for key, (value, digits) in values.items()}


if __name__ == "__main__":
    main()
