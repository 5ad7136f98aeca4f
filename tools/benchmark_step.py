#!/usr/bin/env python3
"""Time the control step, the paper's bitmap and the start-up.

    python tools/benchmark_step.py [--repeats N] [--starts N]

Control step: perceive, decide if an event asks for it, and execute on a frozen scene: the ego comes up
the minor road of `networks/four_way_priority` to turn left, ten cars are near. Each time is given twice: by the wall's
clock, which counts what other processes take, and by the processor's, which does not. Start-up: the processor's time from
the start of a Python process to the end of the first control step of a run, kernels cached, and the whole by the wall's
clock. In a run the steps of SUMO in between empty the processor's caches; the summary of `sumo-reactive run` tells what a
control step costs there.
"""

from __future__ import annotations

import argparse
import json
import math
import subprocess
import sys
import time as clock
from collections.abc import Callable
from pathlib import Path
from statistics import median

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
NETWORK = ROOT / "networks" / "four_way_priority" / "four_way_priority.net.xml"
SCENARIO = ROOT / "scenarios" / "four_way_priority.toml"
ROUTE = ("from_south", "to_west")
TO_LINE_M, SPEED, PERIOD_S = 12.0, 6.0, 0.1
OTHERS = (
    ("from_west_0", -4.0, 11.0, "to_east"), ("from_west_0", -14.0, 11.0, "to_east"), ("from_east_0", -3.0, 12.0, "to_west"),
    ("from_east_0", -13.0, 12.0, "to_south"), ("from_north_0", -2.0, 3.0, "to_south"),
    ("from_north_0", -9.0, 2.0, "to_south"), ("to_east_0", 8.0, 13.0, ""), ("to_west_0", 9.0, 12.0, ""),
    ("to_south_0", 15.0, 9.0, ""), ("from_south_0", -2.0, 5.0, "to_west"),
)  # fmt: skip
"""Lane, place on it (m, negative: from its end), speed (m/s) and next edge of each car near."""

TARGETS = "targets: control step mean ≤ 150 µs, p99 ≤ 1000 µs; bitmap ≤ 10 ms; first step ≤ 2.5 s after the start"

_START = """
import json, sys
from pathlib import Path
from time import process_time
marks = {"interpreter": process_time()}
import numba
marks["numpy, numba"] = process_time()
import libsumo
marks["libsumo"] = process_time()
import sumo_reactive.cli, sumo_reactive.lab.recorder, sumo_reactive.lab.result
from sumo_reactive.lab.scenario import load_scenario
from sumo_reactive.lab.simulation import run_trial
marks["the rest of the imports"] = process_time()
class Done(Exception): pass
def stop(scene):
    marks["SUMO, map, plan, kernels, first step"] = process_time()
    raise Done
try:
    run_trial(load_scenario(Path(sys.argv[1])), observer=stop)
except Done:
    print(json.dumps(marks))
"""


def main() -> None:
    """Print all figures."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--repeats", type=int, default=5000, help="control steps to time (default 5000)")
    parser.add_argument("--starts", type=int, default=5, help="processes to start (default 5)")
    asked = parser.parse_args()
    print(TARGETS)
    time_step(asked.repeats)
    time_bitmap()
    if asked.starts > 0:
        time_start(asked.starts)


def time_step(repeats: int) -> None:
    """Print the time of the control step and of its stages."""
    controller, traffic, drive = scene()
    step = controller.step(traffic, drive, PERIOD_S)
    near, foes, obstacles = len(step.snapshot.boxes), len(step.snapshot.foes), len(step.snapshot.on_path)
    print(f"\ncontrol step, {near} cars near, {foes} foes at regions, {obstacles} on the path (µs)")
    print(f"  {'':24}{'mean':>8}{'p50':>8}{'p99':>8}{'max':>9}{'mean cpu':>10}{'p99 cpu':>9}{'max cpu':>9}")
    for name, call in stages(controller, traffic, drive).items():
        print(f"  {name:24}{_row(*_timed(call, repeats))}")


def stages(controller, traffic, drive) -> dict[str, Callable[[], object]]:  # type: ignore[no-untyped-def]
    """Return the whole step, with the pilot and without, and its stages, each ready to be called."""
    from sumo_reactive.driver.field.executor import execute
    from sumo_reactive.driver.nouns.event import Event, EventKind
    from sumo_reactive.driver.pilot.events import detect
    from sumo_reactive.driver.pilot.passages import view_of
    from sumo_reactive.driver.pilot.pilot import Style, decide
    from sumo_reactive.driver.view.ahead import passages_ahead
    from sumo_reactive.driver.view.outlook import outlook
    from sumo_reactive.driver.view.perceive import perceive

    step = controller.step(traffic, drive, PERIOD_S)
    graph, limits, plan, snapshot = controller.graph, controller.limits, drive.plan, step.snapshot
    ahead, after = passages_ahead(graph, plan, limits, snapshot.passages), step.drive
    foreseen, view = outlook(traffic, snapshot, plan, graph, limits), view_of(snapshot, plan, limits, ahead)
    event = (Event(EventKind.NEW_PLAN),)
    between = after._replace(ego=drive.ego, s=drive.s)
    return {
        "step with an event": lambda: controller.step(traffic, drive, PERIOD_S),
        "step between events": lambda: controller.step(traffic, between, PERIOD_S),
        "  perceive": lambda: perceive(traffic, drive.ego, plan, graph, limits, (drive.s, 0.0)),
        "  what lies ahead": lambda: passages_ahead(graph, plan, limits, snapshot.passages),
        "  detect events": lambda: detect(snapshot, plan, ahead, after.completed, after.memory, False),
        "  outlook (on an event)": lambda: outlook(traffic, snapshot, plan, graph, limits),
        "  decide (on an event)": lambda: decide(view, foreseen, event, drive.memory, Style()),
        "  execute": lambda: execute(snapshot, step.completed, limits, PERIOD_S),
    }


def scene():  # type: ignore[no-untyped-def]
    """Return controller, traffic and drive: the frozen scene."""
    from sumo_reactive.driver.controller import Controller, Drive
    from sumo_reactive.driver.nouns.state import Pose, VehicleState
    from sumo_reactive.driver.nouns.traffic import Body, RoadUser, Traffic
    from sumo_reactive.driver.path.planner import PlanStart, plan
    from sumo_reactive.driver.vehicle.limits import VehicleLimits
    from sumo_reactive.driver.world.route import Route
    from sumo_reactive.sumo.net_reader import read_net

    limits = VehicleLimits(
        length=4.7, width=1.8, wheelbase=2.8, front_overhang=0.9, max_speed=55.0, max_acceleration=2.6,
        comfort_deceleration=2.5, service_deceleration=4.5, emergency_deceleration=8.0, max_steering_angle=0.6,
        max_steering_rate=1.0, max_lateral_acceleration=4.0, comfort_lateral_acceleration=3.0,
    )  # fmt: skip
    graph, body = read_net(NETWORK).build(ROUTE), Body(4.7, 1.8, 8.0, 55.0)
    users = []
    for k, (lane_id, place, speed, then) in enumerate(OTHERS):
        spine = graph.lanes[lane_id].spine
        at = place if place >= 0.0 else spine.length + place
        route = (lane_id[:-2], then) if then else (lane_id[:-2],)
        users.append(RoadUser(f"car{k}", *spine.at(at), spine.heading_at(at), speed, lane_id, at, body, route))
    spine = graph.lanes[f"{ROUTE[0]}_0"].spine
    at = spine.length - TO_LINE_M
    (x, y), heading, back = spine.at(at), spine.heading_at(at), limits.front_to_rear_axle
    pose = Pose(x - back * math.cos(heading), y - back * math.sin(heading), heading)
    start = PlanStart(pose, SPEED, 0.0, 100.0, f"{ROUTE[0]}_0", at, 0)
    nominal = plan(graph, Route(ROUTE), limits, start)
    return Controller(graph=graph, limits=limits), Traffic(time=100.0, users=tuple(users), lights={}), Drive(
        VehicleState(pose, SPEED, 0.0), nominal, 0.0
    )


def _timed(call: Callable[[], object], repeats: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the times of `repeats` calls by the wall's clock and by the processor's, µs."""
    wall, cpu = np.empty(repeats), np.empty(repeats)
    for _ in range(50):
        call()
    for k in range(repeats):
        cpu_before, before = clock.thread_time(), clock.perf_counter()
        call()
        wall[k], cpu[k] = clock.perf_counter() - before, clock.thread_time() - cpu_before
    return 1e6 * wall, 1e6 * cpu


def _row(wall: np.ndarray, cpu: np.ndarray) -> str:
    p50, p99, cpu99 = np.percentile(wall, 50.0), np.percentile(wall, 99.0), np.percentile(cpu, 99.0)
    text = f"{wall.mean():8.1f}{p50:8.1f}{p99:8.1f}{wall.max():9.1f}"
    return f"{text}{cpu.mean():10.1f}{cpu99:9.1f}{cpu.max():9.1f}"


def time_bitmap() -> None:
    """Print the time of one bitmap of U₁."""
    from sumo_reactive.driver.field.valley_map import CELLS, MAP_SIDE_M, valley_bitmap
    from sumo_reactive.driver.parameters import USUAL

    cell = MAP_SIDE_M / CELLS
    arc = np.arange(0.0, MAP_SIDE_M, 0.5 * cell)
    line = np.column_stack((arc, 0.5 * MAP_SIDE_M + 8.0 * np.sin(0.05 * arc)))
    static = line[::20] + np.array((0.0, 6.0))
    print(f"\nbitmap of U₁, {CELLS} × {CELLS}, processor's time (ms)")
    for name, points in (("without obstacles", np.empty((0, 2))), ("with static obstacles", static)):
        _, cpu = _timed(lambda points=points: valley_bitmap(line, points, 0.0, 0.0, cell, USUAL), 50)  # type: ignore[misc]
        print(f"  {name:24}mean {cpu.mean() / 1e3:.2f}   p50 {np.median(cpu) / 1e3:.2f}   max {cpu.max() / 1e3:.2f}")


def time_start(starts: int) -> None:
    """Print how long it takes from a process's start to its first control step, and where the time goes."""
    runs = [_start() for _ in range(starts + 1)][1:]  # the first one fills the caches of disk and kernels
    print(f"\nstart-up to the first control step, processor's time, median of {starts} (s)")
    for name in runs[0]:
        print(f"  {name:40}{median(run[name] for run in runs):.2f}")


def _start() -> dict[str, float]:
    """Start a process that drives one step; return the processor's seconds that it spent on each part, and the wall's."""
    began = clock.perf_counter()
    command = [sys.executable, "-c", _START, str(SCENARIO)]
    marks = json.loads(subprocess.run(command, check=True, capture_output=True, text=True, cwd=ROOT).stdout)
    whole, ends = clock.perf_counter() - began, list(marks.values())
    parts = {name: end - before for name, end, before in zip(marks, ends, [0.0, *ends], strict=False)}
    return parts | {"together": ends[-1], "together, by the wall's clock": whole}


if __name__ == "__main__":
    main()
