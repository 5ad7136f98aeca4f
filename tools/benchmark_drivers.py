#!/usr/bin/env python3
"""Time what a driver of the user's costs in a step beside its own work.

    python tools/benchmark_drivers.py [--scenario FILE] [--scale FACTOR] [--steps N]

Every other step of a run is commanded by a driver, each one between by a plain loop, so that both find the processor's
caches as SUMO leaves them; the protocol's own cost is the difference of their means. The plain loop gives SUMO the same
command, and asks it for the same of the lanes around where the driver reads them. What is left is to make the view, to
call the driver, to check its answer, and for a program to write the message, to wait, to read and check the line. What is
looked at after a step is for the judges, whoever drives, and does not count. The drivers have no work of their own, and
"answers at once" does not even read what it is told; the rows of the two examples have their work in them. "Processor" is
the time of this process, which waits awake at first, "elapsed" the wall's clock, which counts what else runs on the
machine.
"""

from __future__ import annotations

import argparse
import os
import shlex
import shutil
import subprocess
import sys
import tempfile
import time as clock
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import libsumo
import numpy as np

from sumo_reactive.lab.drivers.choice import DriverChoice
from sumo_reactive.lab.drivers.loading import maker_of
from sumo_reactive.lab.drivers.protocol import Driver, DriverView, LaneCommand, Mission, TripEnd
from sumo_reactive.lab.drivers.users_trip import UsersTrip
from sumo_reactive.lab.egos import find_ego
from sumo_reactive.lab.scenario import Scenario, load_scenario
from sumo_reactive.lab.simulation import Simulation, started
from sumo_reactive.sumo.config import read_config
from sumo_reactive.sumo.hand_over import LOOK_AHEAD_M, LOOK_BACK_M, move_on_lane
from sumo_reactive.sumo.net_reader import read_net

ROOT = Path(__file__).resolve().parent.parent
EXAMPLES = ROOT / "examples" / "drivers"
SCENARIO = ROOT / "scenarios" / "multi_lane_road.toml"
TARGETS = "targets: in process ≤ 15 µs a step, out of process ≤ 120 µs"

GAIN = 1.0
"""m/s², which SUMO's own checks allow as far as there is room."""

AT_ONCE = f"""import os, sys
answer = b'{{"ready": true}}\\n'
for line in sys.stdin.buffer:
    os.write(1, answer)
    answer = b'{{"lane": [{GAIN}, null, true], "reason": "as ever"}}\\n'
"""
"""A program that answers without a look at what it is told."""


class ReadsNothing(Driver):
    """Answers the same in every step."""

    reason = "as ever"

    def start(self, mission: Mission) -> None:
        """Need nothing."""

    def step(self, view: DriverView) -> LaneCommand:
        """Gain speed as far as SUMO allows."""
        return LaneCommand(GAIN, is_checked=True)

    def end(self, result: TripEnd) -> None:
        """Keep nothing."""


class ReadsEverything(ReadsNothing):
    """Goes through all that it is shown before it answers the same."""

    def step(self, view: DriverView) -> LaneCommand:
        """Gain speed as far as SUMO allows."""
        self.seen = view.time, view.state, view.ego, len(view.users), view.surroundings
        return LaneCommand(GAIN, is_checked=True)


class Cost(NamedTuple):
    """Seconds of the processor and of the wall's clock."""

    processor: float
    elapsed: float


def cost_of(call: Callable[[], object]) -> Cost:
    """Return what a call takes."""
    processor, began = clock.thread_time(), clock.perf_counter()
    call()
    return Cost(clock.thread_time() - processor, clock.perf_counter() - began)


class TimedTrip(UsersTrip):
    """A trip that times its commands in every other step, and in those between the same asked and told by a plain loop."""

    is_asking = True
    """Whether the plain loop asks for the lanes around."""

    def __init__(self, *how: Any) -> None:
        super().__init__(*how)
        self.costs = list[Cost](), list[Cost]()
        self.users = list[int]()

    def command(self) -> None:
        """Command one way or the other, and note what that has cost."""
        is_plain = len(self.costs[0]) > len(self.costs[1])
        self.users.append(len(self._users))
        self.costs[is_plain].append(cost_of(self._plainly if is_plain else super().command))
        if self.failure:
            raise SystemExit(self.failure)

    def _plainly(self) -> None:
        if self.is_asking:
            ask_for_lanes(self.id, self._own.lane_id.rpartition("_")[0])
        speed = min(self._own.speed + GAIN * self._duration, self.limits.max_speed)
        move_on_lane(self.id, speed, None, self._duration, is_checked=True)


def ask_for_lanes(ego: str, edge: str) -> None:
    """Ask SUMO for all that a view tells of the lanes around, and make nothing of it."""
    vehicle, lane = libsumo.vehicle, libsumo.lane
    index, best = vehicle.getLaneIndex(ego), vehicle.getBestLanes(ego)
    found = [vehicle.getLeader(ego, LOOK_AHEAD_M), vehicle.getFollower(ego, LOOK_BACK_M)]
    lanes = [number for number in (index, index + 1, index - 1) if 0 <= number < len(best)]
    for number in lanes:
        lane.getMaxSpeed(f"{edge}_{number}")
    for side in range(4):
        if index + 1 - 2 * (side % 2) in lanes:
            found += vehicle.getNeighbors(ego, side)[:1]
    for one in found:
        if one and one[0]:
            vehicle.getSpeed(one[0])
    vehicle.getNextTLS(ego)


def main() -> None:
    """Print a row a driver."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenario", type=Path, default=SCENARIO, help="a scenario .toml")
    parser.add_argument("--scale", type=float, default=3.0, help="factor on its traffic (default 3)")
    parser.add_argument("--steps", type=int, default=1500, help="steps to time of each driver (default 1500)")
    asked = parser.parse_args()
    scenario = replace(load_scenario(asked.scenario), sumo_options=("--scale", f"{asked.scale:g}"))
    print(f"{TARGETS}\n{'':50}|{'processor (µs)':^26}|{'elapsed (µs)':^34}")
    print(f"{'':36}{'steps':>7}{'users':>7}{'whole':>9}{'plain':>8}{'own':>8}{'whole':>11}{'plain':>8}{'own':>8}{'median':>10}")
    with tempfile.TemporaryDirectory() as folder:
        for name, make in drivers(Path(folder)):
            print(f"{name:36}{row(scenario, make, asked.steps, is_asking=make is not ReadsNothing)}", flush=True)


def drivers(folder: Path) -> Iterator[tuple[str, Callable[[], Driver]]]:
    """Yield what to time: its name, and what makes it; the example in C++ where there is a compiler."""
    yield "in process, reads nothing", ReadsNothing
    yield "in process, reads everything", ReadsEverything
    (folder / "at_once.py").write_text(AT_ONCE, encoding="utf-8")
    python = shlex.quote(sys.executable)
    yield "out of process, answers at once", program(f"{python} at_once.py", folder)
    if hasattr(os, "sched_setaffinity"):
        with on_one_core():
            yield "  both on one core", program(f"{python} at_once.py", folder)
    yield "  pass_on.py, with its work", program(f"{python} pass_on.py", EXAMPLES)
    if shutil.which("g++"):
        build = ["g++", "-O2", "-std=c++17", "-o", str(folder / "pass_on"), str(EXAMPLES / "pass_on.cpp")]
        subprocess.run(build, check=True)
        yield "  pass_on.cpp, with its work", program("./pass_on", folder)


@contextmanager
def on_one_core() -> Iterator[None]:
    """Keep this process, and those that it starts, on one core."""
    cores = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {min(cores)})
    try:
        yield
    finally:
        os.sched_setaffinity(0, cores)


def program(words: str, folder: Path) -> Callable[[], Driver]:
    """Return what starts a program as a driver."""
    return maker_of(DriverChoice(f"exec:{words}", folder=folder))


def row(scenario: Scenario, make: Callable[[], Driver], steps: int, *, is_asking: bool) -> str:
    """Return steps, users near, and what is taken by both clocks, over as many seeds as the steps need."""
    costs, users, seed = (list[Cost](), list[Cost]()), list[int](), scenario.seed
    while len(users) < 2 * steps:
        trip = driven(replace(scenario, seed=seed), make, 2 * steps - len(users), is_asking=is_asking)
        users, seed = users + trip.users, seed + 1
        for all_of_them, found in zip(costs, trip.costs, strict=True):
            all_of_them.extend(found)
    whole, plain = (1e6 * np.array(one) for one in costs)
    clocks = (f"{a:9.1f}{b:8.1f}{a - b:8.1f}  " for a, b in zip(whole.mean(axis=0), plain.mean(axis=0), strict=True))
    middle = np.median(whole[:, 1]) - np.median(plain[:, 1])
    return f"{len(whole):7}{np.mean(users):7.0f}{''.join(clocks)}{middle:8.1f}"


def driven(scenario: Scenario, make: Callable[[], Driver], steps: int, *, is_asking: bool) -> TimedTrip:
    """Return a trip of so many steps, or to its end."""
    net, trips = read_net(read_config(scenario.config).net_file), list[TimedTrip]()
    with started(scenario) as start:

        def take_over(ego: str) -> TimedTrip:
            trips.append(TimedTrip(start.session, ego, net, scenario, make))
            trips[0].is_asking = is_asking
            return trips[0]

        simulation = Simulation(start, scenario, take_over, None, None)
        simulation.admit(*find_ego(start.session, scenario, start.config, None))
        while not simulation.results and simulation.ego_steps < steps:
            simulation.step()
        if not simulation.results:
            trips[0].release()
    return trips[0]


if __name__ == "__main__":
    main()
