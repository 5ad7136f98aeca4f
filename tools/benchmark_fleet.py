#!/usr/bin/env python3
"""Measure what egos cost beside plain `sumo`, and tell whether that has become more.

    python tools/benchmark_fleet.py [--write | --check] [--scale FACTOR] [--until S] [--shares SHARE …]

The city grid of this repository is simulated by plain `sumo` and with egos in turn, a process each, to the same time. All
times are the processor's. A share of 0 is the one car that is called `ego`. A "ratio" is what one ego costs in one step as
a multiple of what SUMO's step costs for one vehicle in the same invocation, so that it can be compared between machines.

With `--write` the figures go to tools/speed.json and, as tables, to docs/speed.md and docs/scale.md. With `--check` they
are compared with those there. Exit codes: 0; with `--check` 1 if a ratio is more than 10 % larger than it was.
"""

from __future__ import annotations

import argparse
import json
import resource
import shutil
import sys
import time as clock
from collections import Counter, defaultdict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import wraps
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np
from benchmark_run import Case, count, processor_time, theirs
from sumolib import checkBinary

from sumo_reactive.lab.ego_rule import EgoRule
from sumo_reactive.lab.fleet import Running, run_fleet
from sumo_reactive.lab.metrics.jury import Jury
from sumo_reactive.lab.scenario import Scenario, load_scenario
from sumo_reactive.lab.simulation import Simulation
from sumo_reactive.lab.surroundings_record import SurroundingsRecord
from sumo_reactive.lab.trip import Trip
from sumo_reactive.sumo.session import Session

ROOT = Path(__file__).resolve().parent.parent
SCENARIO = ROOT / "scenarios" / "city_grid.toml"
FIGURES, SPEED, SCALE = ROOT / "tools" / "speed.json", ROOT / "docs" / "speed.md", ROOT / "docs" / "scale.md"
SHARES, UNTIL_S, FACTOR, REPEATS = (0.0, 0.08, 0.8), 120.0, 1.0, 3
CORES = 1, 2
"""Processes that share the most egos."""

TIMED, WEIGHED, SHARED = "--timed", "--weighed", "--shared"
"""First arguments of the processes that this program starts to drive; the second are share, factor and end as JSON."""

MOST_MORE = 0.1
"""A ratio that has grown by more than this share is told."""

CITY_VEHICLES, CITY_STEP_S, CITY_SHARE = 100_000, 0.1, 0.1
_MB = 1024.0
"""KiB, the unit of `ru_maxrss`, in a MiB."""

Figures = dict[str, Any]


def main() -> None:
    """Measure, print, and write or compare."""
    workers: dict[str, Callable[..., Figures | float]] = {TIMED: driven, WEIGHED: weighed, SHARED: shared}
    if sys.argv[1:2] and sys.argv[1] in workers:
        print(json.dumps(workers[sys.argv[1]](*json.loads(sys.argv[2]))))
        return
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--write", action="store_true", help="write the figures and the pages")
    parser.add_argument("--check", action="store_true", help="compare with the figures that are written")
    parser.add_argument("--scale", type=float, default=FACTOR, help="factor on the grid's traffic")
    parser.add_argument("--until", type=float, default=UNTIL_S, help="end, s")
    parser.add_argument("--shares", type=float, nargs="+", default=SHARES, help="of the cars that are egos; 0: the one ego")
    asked = parser.parse_args()
    found = measured(asked.shares, asked.scale, asked.until)
    print(speed_table(found))
    if asked.write:
        FIGURES.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
        SPEED.write_text(speed_page(found), encoding="utf-8")
        SCALE.write_text(scale_page(found), encoding="utf-8")
    if asked.check:
        worse = regressions(json.loads(FIGURES.read_text(encoding="utf-8")), found)
        print("\n".join(worse) or "no ratio has grown by more than 10 %")
        raise SystemExit(bool(worse))


def measured(shares: Sequence[float], factor: float, until: float) -> Figures:
    """Return SUMO's figures and, by share, those with egos; the first run fills caches and is not counted."""
    sumo = shutil.which(checkBinary("sumo"))
    if not sumo:
        raise SystemExit("no plain sumo program: install eclipse-sumo")
    case, step_s = Case(SCENARIO, factor, until, False), load_scenario(SCENARIO).step_length_s or 1.0
    vehicles, rows = count(case, sumo, until), []
    _fleet(TIMED, shares[0], factor, until)
    for share in shares:
        plain_us = 1e6 * median(theirs(case, sumo, until).simulation for _ in range(REPEATS)) / (until / step_s)
        row = _fleet(TIMED, share, factor, until) | _fleet(WEIGHED, share, factor, until)
        row |= {"share": share, "plain_us": plain_us}
        row["split"]["in SUMO"] = (row.pop("sumo_us") - plain_us) / row["egos"]
        row["ego_us"] = sum(row["split"].values())
        rows.append(row | {"ratio": row["ego_us"] / (plain_us / vehicles)})
    wall = {cores: _fleet(SHARED, max(shares), factor, until, cores)["wall_us"] for cores in CORES} if max(shares) else {}
    return {"vehicles": vehicles, "factor": factor, "until_s": until, "rows": rows, "wall_us": wall}


def _fleet(worker: str, *order_of: float) -> Figures:
    order = json.dumps(order_of)
    found: Figures = json.loads(processor_time([sys.executable, __file__, worker, order])[1].splitlines()[-1])
    return found


def driven(share: float, factor: float, until: float) -> Figures:
    """Drive egos in this process; return the mean number at once, and the µs a step that they and SUMO's step take."""
    spent: dict[str, list[float]] = {}
    for part, owner, name in (
        ("place", Trip, "_place"), ("command", Trip, "command"), ("observe", Trip, "scene"), ("judge", Jury, "see"),
        ("SUMO", Session, "step"), ("tell", Simulation, "_agree"),
    ):  # fmt: skip
        setattr(owner, name, timed(getattr(owner, name), spent.setdefault(part, [])))
    records: dict[str, SurroundingsRecord] = defaultdict(SurroundingsRecord)
    record = timed(lambda scene: records[scene.ego].see(scene), spent.setdefault("record", []))
    run_fleet(_scenario(factor, until), _rule(share), observer=record)
    spent["control"] = list(np.subtract(spent.pop("command"), spent["place"]))
    sumo, told = spent.pop("SUMO"), sum(spent.pop("tell"))
    spent["place"].append(told)
    steps = len(sumo)
    return {
        "egos": len(spent["control"]) / steps, "sumo_us": sum(sumo) / steps,
        "control_p99_us": float(np.percentile(spent["control"], 99)),
        "split": {part: sum(each) / len(spent["control"]) for part, each in spent.items()},
    }  # fmt: skip


def weighed(share: float, factor: float, until: float) -> Figures:
    """Drive egos in this process, unrecorded; return the MB that it takes at most, and the most egos at once."""
    at_once: Counter[float] = Counter()
    run_fleet(_scenario(factor, until), _rule(share), observer=lambda scene: at_once.update([scene.step.time]))
    return {"memory_mb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / _MB, "most_egos": max(at_once.values())}


def shared(share: float, factor: float, until: float, cores: int) -> Figures:
    """Drive egos by several processes, unrecorded; return the wall clock's µs that the driver takes an ego and step."""
    return {"wall_us": run_fleet(_scenario(factor, until), _rule(share), running=Running(cores=cores)).step_us}


def _scenario(factor: float, until: float) -> Scenario:
    return replace(load_scenario(SCENARIO), until_s=until, sumo_options=("--scale", f"{factor:g}"))


def _rule(share: float) -> EgoRule:
    return EgoRule(share=share) if share else EgoRule(ids=("ego",))


def timed(function: Callable[..., Any], spent: list[float]) -> Callable[..., Any]:
    """Return the function, which then notes the processor's µs that each call takes."""

    @wraps(function)
    def call(*arguments: Any, **named: Any) -> Any:
        began = clock.process_time_ns()
        try:
            return function(*arguments, **named)
        finally:
            spent.append((clock.process_time_ns() - began) / 1e3)

    return call


def regressions(before: Mapping[str, Any], now: Mapping[str, Any]) -> list[str]:
    """Return a line for each share whose ratio has grown by more than a tenth; shares that are not known are new."""
    known = {row["share"]: row["ratio"] for row in before["rows"]}
    return [
        f"share {row['share']:g}: an ego costs {row['ratio']:.1f} of SUMO's vehicles, before {known[row['share']]:.1f}"
        for row in now["rows"]
        if row["share"] in known and row["ratio"] > (1.0 + MOST_MORE) * known[row["share"]]
    ]


def speed_table(figures: Figures) -> str:
    """Return the figures as a table."""
    parts = ("observe", "control", "place", "judge", "record", "in SUMO")
    head = ["egos", "at most", "run / plain", "µs", "ratio", *parts, "control p99", "plain step", "MB"]
    lines = [head, ["---:"] * len(head)]
    for row in figures["rows"]:
        whole = 1.0 + row["egos"] * row["ego_us"] / row["plain_us"]
        cells = (*(row["split"][part] for part in parts), row["control_p99_us"], row["plain_us"], row["memory_mb"])
        first = [f"{row['egos']:.1f}", str(row["most_egos"]), f"{whole:.2f}", f"{row['ego_us']:.0f}", f"{row['ratio']:.0f}"]
        lines.append([*first, *(f"{cell:.0f}" for cell in cells)])
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def speed_page(figures: Figures) -> str:
    """Return the page of the figures."""
    return f"""# Speed

<!-- written by tools/benchmark_fleet.py: do not edit -->
The city grid of this repository (× {figures['factor']:g}, to {figures['until_s']:g} s, steps of 0.1 s,
{figures['vehicles']:.0f} vehicles on the mean), with egos and by plain `sumo` in turn, the processor's time:

{speed_table(figures)}

"Egos" are those at once, on the mean of all steps. "Run / plain" is a step with its egos, beside one of plain `sumo`. The µs
are an ego's in a step, followed by their parts; "in SUMO" is what SUMO's own step takes longer for it than the plain step.
"Ratio": an ego's step as a multiple of what the plain step costs for a vehicle. MB is the process
at its largest, unrecorded.

With several processes (`run --cores`) each has the same SUMO and a part of the egos. By the wall's clock the driver of the
{max(row['egos'] for row in figures['rows']):.0f} egos takes, an ego and step, unrecorded: {wall_of(figures)}.

```text
python tools/benchmark_fleet.py            # print the table
python tools/benchmark_fleet.py --check    # exit code 1 if a ratio is more than 10 % above the one here
python tools/benchmark_fleet.py --write    # measure, and write this page
```

Whole runs with one ego in other traffic: `tools/benchmark_run.py`.
"""


def wall_of(figures: Figures) -> str:
    """Return the µs of the wall's clock by processes, in words."""
    return ", ".join(f"{wall:.0f} µs with {cores}" for cores, wall in figures["wall_us"].items())


def scale_page(figures: Figures) -> str:
    """Return the estimate for a city, from the figures with the most egos."""
    rows = sorted(figures["rows"], key=lambda row: row["egos"])
    least, most = rows[0], rows[-1]
    vehicle_us, ego_us = most["plain_us"] / figures["vehicles"], most["ego_us"]
    more = most["most_egos"] - least["most_egos"]
    ego_mb = (most["memory_mb"] - least["memory_mb"]) / more if more else 0.0
    egos, steps = CITY_SHARE * CITY_VEHICLES, 3600.0 / CITY_STEP_S
    sumo_s, egos_s = 1e-6 * CITY_VEHICLES * vehicle_us, 1e-6 * egos * ego_us
    return f"""# A city of 100,000 vehicles

<!-- written by tools/benchmark_fleet.py: do not edit -->
An estimate on paper, from [what is measured](speed.md) on {figures['vehicles']:.0f} vehicles: nobody has driven it.
It takes all costs to grow with the number of vehicles and egos, and leaves out that the
processor's caches no longer suffice.

| what | how | figure |
|---|---|---:|
| c, SUMO's step for a vehicle | plain step / vehicles | {vehicle_us:.1f} µs |
| e, a step of an ego | with {most['egos']:.0f} egos at once | {ego_us:.0f} µs |
| m, memory for an ego | {most['memory_mb'] - least['memory_mb']:.0f} MB / {more} egos more at once | {ego_mb:.1f} MB |
| SUMO alone, a step of 0.1 s | 100,000 · c | {sumo_s:.2f} s |
| … an hour | 36,000 steps | {steps * sumo_s / 3600.0:.1f} h |
| 10 % egos, a step | 10,000 · e | {egos_s:.2f} s |
| … an hour, with SUMO | 36,000 steps | {steps * (sumo_s + egos_s) / 3600.0:.1f} h |
| … memory for them | 10,000 · m | {1e-3 * egos * ego_mb:.1f} GB |
| egos that cost as much as SUMO itself | 100,000 · c / e | {CITY_VEHICLES * vehicle_us / ego_us:.0f} |

## Where the walls are

- **A scenario is one process.** SUMO steps all vehicles on one core, and 0.1 s of the city take it {sumo_s:.2f} s:
  real time ends at {1e6 * CITY_STEP_S / vehicle_us:,.0f} vehicles without any ego. Steps of 1 s
  cost a tenth, but are no steps to drive in.
- **An ego costs as much as {ego_us / vehicle_us:.0f} vehicles.** Processes share the egos (`run --cores`): each still
  steps SUMO and places all egos, {most['split']['place'] + most['split']['in SUMO']:.0f} µs of the {ego_us:.0f} µs.
- **Memory.** A tenth of the cars as egos take {1e-3 * egos * ego_mb:.1f} GB in one process,
  unrecorded, for two minutes of driving.
- **Many runs are no wall.** Shares × seeds × scenarios are trials of a [batch](batch.md), which share nothing: n cores take
  1 / n of the time, on one machine or on a cluster. Each takes the memory of a whole scenario.

So a study of a whole city is one of few egos in it, or of districts: cut the network, and let
trips begin and end at its edge.
"""


if __name__ == "__main__":
    main()
