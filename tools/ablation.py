#!/usr/bin/env python3
"""Take each mechanism of the paper out of the driver, one at a time, and tell what driving loses without it.

    python tools/ablation.py [--only TEXT] [--without NAME…] [--write FILE] [--jobs N]
    python tools/ablation.py --trips CORPUS TRIPS.csv [--seed N …] …

Drives the scenarios of this repository and a few kinds of situations, or a list of trips as `digests.py` reads it, with the
whole driver and then without each mechanism; `--only` takes runs whose name holds TEXT. What is left out is a value of the
driver's `Parameters`: no code is exchanged. A run ends at the latest after LONGEST times the time
that the whole driver took, and LONGER_S. A mechanism carries weight when a loss exceeds its threshold (`MEASURES`). Prints
the table and last "N of M mechanisms carry weight"; `--write` puts it into a file, what a row has come to goes to stderr at
once. Exit codes: 0, 1 if the whole driver fails in a run, 2 for wrong usage.
"""

from __future__ import annotations

import argparse
import importlib
import math
import os
import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import shapely
from digests import listed_runs

from sumo_reactive.driver.ablation import Mechanism
from sumo_reactive.driver.geometry.footprint import Footprint
from sumo_reactive.driver.nouns.record import Scene, StepRecord
from sumo_reactive.errors import InputError
from sumo_reactive.lab.runner import Runner
from sumo_reactive.lab.scenario import DEFAULT_SEED, Scenario, load_scenario
from sumo_reactive.lab.simulation import run_trial
from sumo_reactive.lab.task import Ending

ROOT = Path(__file__).resolve().parent.parent
TIMEOUT_S = 600.0
LONGEST = 1.5
"""A run without a mechanism takes at most so many times as long as the whole driver…"""
LONGER_S = 20.0
"""…and so much longer."""
STANDING = 0.1
PASSING = 2.0
"""m/s; clearance counts while the ego drives faster: behind a queue it stands near."""
CLEAR_M = 1.0
"""More room than this nobody misses."""
SOON_S = 4.0
"""Nor a longer time to collision."""
EGO_SIZE = (4.7, 1.8)
"""Length and width (m) of the box whose clearance is taken: a car, whatever the ego."""

Figures = Mapping[str, float]
"""What a run came to, by the key of a measure."""
Runs = Mapping[str, Figures]


class Ablation(NamedTuple):
    """A mechanism of the paper: `name` for the command line, its title, the parameters that take it out
    (None: there is nothing to take out), and what is to be known about it. `saves_runs`: it is there to ask the highway code
    less often, so that asking it more often is a loss."""

    name: str
    title: str
    parameters: Mapping[str, float] | None
    note: str = ""
    saves_runs: bool = False


def _out(mechanism: Mechanism, **parameters: float) -> dict[str, float]:
    return {"without": int(mechanism), **parameters}


ABLATIONS = (
    Ablation(
        "argmin",
        "argmin of U (§3.2)",
        {"valley_share": 0.0, "shadow_share": 0.0, "velocity_share": 0.0},
        "U ≡ 0: the first command that passes the tests.",
    ),
    Ablation("u1", "U₁ (§3.3.1)", {"valley_share": 0.0}),
    Ablation("u2", "U₂ (§3.3.2)", {"shadow_share": 0.0}, "The ego then stays on C beside whomever it passes."),
    Ablation("u3", "U₃ (§3.3.3)", {"velocity_share": 0.0}),
    Ablation(
        "beta",
        "β, static obstacles (§3.3.1)",
        {"valley_repulsion": 0.0},
        "On C U₁ is least whatever β is: it counts while the ego leans towards a border or somebody parked.",
    ),
    Ablation("rear", "rear control point R (§3.3.1)", None, "R is towed: off C_R by no more than F was off C."),
    Ablation("times", "(l, t_l) in v_d (§3.3.3)", _out(Mechanism.TIMES), "Gaps are then met standing."),
    Ablation(
        "delays",
        "Δt shifted or planned anew (§2)",
        _out(Mechanism.DELAYS),
        "Constraints once missed stay missed and activate the pilot at every step; it drives the same.",
        saves_runs=True,
    ),
    Ablation("failure", "assessment: FAILURE (§2)", _out(Mechanism.FAILURE), "Nothing then asks who gives way."),
    Ablation("late", "assessment: late (§2)", {"excessive_delay_s": 1e9}),
    Ablation("behaviours", "five behaviours (§2)", _out(Mechanism.BEHAVIOURS), "Normal driving asks no rule."),
    Ablation(
        "tuning", "instructions tune w and v_d (§2)", _out(Mechanism.TUNING),
        "Only pulling out, falling back and moves differ, by less than a threshold.",
    ),
    Ablation("room_behind", "post-conflict region (§2.1)", _out(Mechanism.ROOM_BEHIND)),
    Ablation("graph", "labelled graph (§2.1)", _out(Mechanism.GRAPH)),
    Ablation("events", "events (§2.1)", _out(Mechanism.EVENTS), "The pilot then decides at every step.", True),
    Ablation(
        "feedback", "feedback: no command (§3.1)", _out(Mechanism.FEEDBACK),
        "Room to stop is kept ahead of time: in these runs there is always an admissible command.",
    ),
    Ablation("escape", "local minima (§3.2)", _out(Mechanism.ESCAPE)),
    Ablation(
        "exact_tests", "collision test, room to stop (§3.3.1)", _out(Mechanism.ROOM_TO_STOP, collision_horizon_s=0.0)
    ),
)
WHOLE = Ablation("whole", "the whole driver", {})


class Measure(NamedTuple):
    """A column: `title`, key, the words for a loss (`{}`: how much), the loss in it over all runs, and beyond which loss a
    user would miss something."""

    title: str
    key: str
    words: str
    loss: Callable[[str, Sequence[Figures], Sequence[Figures]], float]
    threshold: float
    digits: int = 0


def more(key: str, before: Sequence[Figures], after: Sequence[Figures]) -> float:
    """Return by how much the sum has grown."""
    return sum(run[key] for run in after) - sum(run[key] for run in before)


def fewer(key: str, before: Sequence[Figures], after: Sequence[Figures]) -> float:
    """Return by how much the sum has fallen."""
    return -more(key, before, after)


def nearer(key: str, before: Sequence[Figures], after: Sequence[Figures]) -> float:
    """Return by how much the smallest distance of a run has fallen at most."""
    return max(was[key] - run[key] for was, run in zip(before, after, strict=True))


def rougher(key: str, before: Sequence[Figures], after: Sequence[Figures]) -> float:
    """Return by how much the root mean square over all the time has grown."""
    return _rms(key, after) - _rms(key, before)


def rougher_by(key: str, before: Sequence[Figures], after: Sequence[Figures]) -> float:
    """Return by how many per cent it has."""
    return 100.0 * (_rms(key, after) / max(_rms(key, before), 1e-9) - 1.0)


def times_as_many(key: str, before: Sequence[Figures], after: Sequence[Figures]) -> float:
    """Return how many times the sum it is."""
    return sum(run[key] for run in after) / max(sum(run[key] for run in before), 1.0)


def _rms(key: str, runs: Sequence[Figures]) -> float:
    steps = sum(run["duration_s"] for run in runs)
    return math.sqrt(sum(run["duration_s"] * run[key] ** 2 for run in runs) / max(steps, 1e-9))


MEASURES = (
    Measure("arrivals", "arrived", "{} fewer arrive", fewer, 0),
    Measure("contacts", "collisions", "{} more contacts", more, 0),
    Measure("violations", "violations", "{} more violations", more, 0),
    Measure("emergencies", "emergencies", "{} more emergencies", more, 0),
    Measure("caused", "hard_braking_caused", "{} more hard brakings caused", more, 0),
    Measure("stops", "stops", "{} more stops", more, 0),
    Measure("standstill (s)", "standstill_s", "{} s more standstill", more, 1.0, 1),
    Measure("in junctions (s)", "in_junctions_s", "stands {} s more in junctions", more, 1.0, 1),
    Measure("time (s)", "duration_s", "{} s more", more, 1.0, 1),
    Measure("clearance (m)", "clearance_m", "passes {} m nearer", nearer, 0.05, 2),
    Measure("TTC (s)", "time_to_collision_s", "time to collision smaller by {} s", nearer, 0.5, 2),
    Measure("jerk (%)", "rms_jerk_m_s3", "{} % more jerk", rougher_by, 5.0, 1),
    Measure("RMS of d (m)", "tracking_m", "RMS of d {} m greater", rougher, 0.05, 3),
    Measure("pilot runs (×)", "pilot_activations", "the pilot runs {} times as often", times_as_many, 2.0, 1),
)
NOTHING: Figures = {measure.key: 0.0 for measure in MEASURES}
"""Of a run that a fault of the program ended: it has not arrived."""


def main() -> None:
    """Drive, print the table, write it."""
    asked = _arguments()
    chosen = [one for one in ABLATIONS if not asked.without or one.name in asked.without]
    with tempfile.TemporaryDirectory() as folder:
        try:
            every = dict(listed_runs(*asked.trips, asked.seed or [DEFAULT_SEED])) if asked.trips else own_runs(Path(folder))
        except InputError as error:
            print(f"ablation: {error}", file=sys.stderr)
            raise SystemExit(2) from error
        runs = {name: scenario for name, scenario in every.items() if asked.only in name}
        if not runs:
            print(f"ablation: no run whose name holds '{asked.only}'", file=sys.stderr)
            raise SystemExit(2)
        whole = driven(WHOLE, runs)
        if failed := [name for name in runs if whole[name] is NOTHING]:
            print(f"ablation: the whole driver fails in {', '.join(failed)}", file=sys.stderr)
            raise SystemExit(1)
        limited = {
            name: replace(run, horizon_s=LONGEST * whole[name]["duration_s"] + LONGER_S, until_s=None)
            for name, run in runs.items()
        }
        with ThreadPoolExecutor(asked.jobs) as threads:
            found = list(threads.map(lambda one: _ablated(one, limited, whole), chosen))
    text = told(whole, list(zip(chosen, found, strict=True)))
    print(text)
    if asked.write:
        asked.write.write_text(f"{HEAD}\n\n{text}\n", encoding="utf-8")


def _ablated(one: Ablation, runs: Mapping[str, Scenario], whole: Runs) -> Runs:
    """Return the runs without a mechanism; say at once what they have come to."""
    found = driven(one, runs) if one.parameters else whole
    print(f"{one.name}: {_sentence(one, losses(whole, found))}", file=sys.stderr, flush=True)
    return found


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    names = [one.name for one in ABLATIONS]
    parser.add_argument("--trips", type=Path, nargs=2, metavar=("CORPUS", "TRIPS.csv"), help="drive a list of trips instead")
    parser.add_argument("--seed", type=int, nargs="+", metavar="N", help=f"of trips; default {DEFAULT_SEED}")
    parser.add_argument("--only", default="", metavar="TEXT", help="runs whose name holds this text")
    parser.add_argument("--without", nargs="+", choices=names, metavar="NAME", help=f"only these: {', '.join(names)}")
    parser.add_argument("--jobs", type=int, default=1, metavar="N", help="mechanisms at a time; default 1")
    parser.add_argument("--write", type=Path, metavar="FILE", help="write the table there, too")
    asked = parser.parse_args()
    if asked.jobs < 1:
        parser.error("--jobs is greater than 0")
    if asked.write and not asked.write.parent.is_dir():
        parser.error(f"{asked.write}: not a file in a folder that exists")
    return asked


def own_runs(folder: Path) -> dict[str, Scenario]:
    """Return this repository's scenarios and the kinds of situations, built in `folder`, by name."""
    scenarios = {path.stem: load_scenario(path) for path in sorted((ROOT / "scenarios").glob("*.toml"))}
    return scenarios | dict(_kinds(folder))


def _kinds(folder: Path) -> Iterator[tuple[str, Scenario]]:
    """Yield a few situations that the scenarios do not hold, from the networks of `tests/kinds`."""
    sys.path[:0] = [str(ROOT / "tests"), str(ROOT / "tests" / "kinds")]
    k: Any = importlib.import_module("kinds")
    two_way = k.Net(k.node("a", 0, 0) + k.node("b", 300, 0), k.edge("ab") + k.edge("ba"))
    bike = k.car("bike", "ab", type="bike", departPos=60)
    yield _kind(k, folder, "bicycle in the lane", two_way, bike, k.car("ego", "ab", 3))
    path = k.element("lane", index=0, allow="bicycle", width=1.6) + k.element("lane", index=1, disallow="bicycle")
    beside = k.Net(k.node("a", 0, 0) + k.node("b", 300, 0), k.edge("ab", path, numLanes=2))
    bikes = k.stream("b", "ab", [0, 2, 4, 6], type="bike", departLane=0, departPosLat="left")
    yield _kind(k, folder, "bicycles beside", beside, bikes, k.car("ego", "ab", 9, departLane=1))
    wall = k.element("poly", id="wall", type="obstacle", shape="150,-3.4 154,-3.4 154,-2.7 150,-2.7", fill=1, color="red")
    yield _kind(k, folder, "wall beside", k.road(300), k.car("ego", "ab"), extra=wall)
    contra = k.element("lane", index=0, disallow="bicycle") + k.element("lane", index=1, allow="bicycle", width=1.6)
    between = k.Net(k.node("a", 0, 0) + k.node("b", 300, 0), k.edge("ab", contra, numLanes=2))
    bay = k.element("parkingArea", id="bay", lane="ab_0", startPos=100, endPos=160, roadsideCapacity=8, width=2)
    halt = k.element("stop", parkingArea="bay", duration=900)
    parked = k.stream("p", "ab", [0] * 8, departPos="stop", departSpeed=0, stops=halt)
    bikes = k.stream("b", "ab", [0, 2, 4, 6, 8], type="bike", departLane=1, departPosLat="right", departPos=60)
    ego = k.car("ego", "ab", 3, departLane=0)
    yield _kind(k, folder, "bicycles and parked cars beside", between, parked, bikes, ego, extra=bay)
    halts = k.car("x", "ab", 0, k.stop("ab_0", 160, duration=10000), departPos=10, departSpeed=5)
    yield _kind(k, folder, "too near to pass", k.road(320, numLanes=2), halts, k.car("ego", "ab", 1.2, departLane=0))
    jam = k.standing("jam", "ce", "ce_0", 5.5, 30)
    yield _kind(k, folder, "exit full", k.cross(), jam, k.car("ego", "wc ce", 5), k.stream("s", "sc cn", [9, 12, 15]))
    lanes = k.Net(k.node("a", 0, 0) + k.node("b", 300, 0), k.edge("ab", numLanes=2))
    hurry = k.sort("hurry", lcAssertive=5, lcKeepRight=50, minGap=0.5, tau=0.3)
    cuts = k.car("x", "ab", 1.4, type="hurry", departLane=1)
    yield _kind(k, folder, "cut in", lanes, hurry, cuts, k.car("ego", "ab", 1, departLane=0))
    hard = k.sort("hard", decel=9, emergencyDecel=9, sigma=0)
    brakes = k.car("x", "ab", 0, k.stop("ab_0", 180, duration=4), type="hard")
    yield _kind(k, folder, "leader brakes hard", k.road(300), hard, brakes, k.car("ego", "ab", 1.2))
    rude = k.sort("rude", jmIgnoreFoeProb=1, jmIgnoreFoeSpeed=100, jmIgnoreJunctionFoeProb=1, jmTimegapMinor=0)
    takes = k.stream("x", "sc cn", [1, 3.5, 6, 8.5, 11], type="rude")
    yield _kind(k, folder, "right of way taken from it", k.cross(), rude, takes, k.car("ego", "wc ce", 3))
    platoon = k.stream("x", "wc ce", [1.2 * i for i in range(7)])
    yield _kind(k, folder, "platoon before the gap", k.cross(), platoon, k.car("ego", "sc cn", 4))
    two_ways = k.Net(k.node("a", 0, 0) + k.node("b", 600, 0), k.edge("ab") + k.edge("ba"))
    sorts = k.sort("slow", maxSpeed=6, sigma=0) + k.sort("fast", maxSpeed=30, accel=4, speedFactor=1.3)
    slow = k.car("x", "ab", 0, type="slow", departPos=60, departSpeed=6)
    starts = k.standing("y", "ba", "ba_0", 300, 10, type="fast")
    yield _kind(k, folder, "pass given up", two_ways, sorts, slow, starts, k.car("ego", "ab", 2))
    dead_end = k.Net(k.node("a", 0, 0) + k.node("b", 100, 0), k.edge("ab") + k.edge("ba"), options=())
    yield _kind(k, folder, "turning round", dead_end, k.car("ego", "ab ba"))


def _kind(k: Any, folder: Path, name: str, net: Any, *vehicles: str, extra: str = "") -> tuple[str, Scenario]:
    place = folder / name.replace(" ", "_")
    place.mkdir()
    return name, k.situation(place, net, *vehicles, extra=extra, until=120.0)


def driven(ablation: Ablation, runs: Mapping[str, Scenario]) -> dict[str, Figures]:
    """Drive each run with these parameters, in a process of its own; return its figures by its name."""
    here = str(Path(__file__).resolve().parent)
    os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, (here, os.environ.get("PYTHONPATH", ""))))
    found: dict[str, Figures] = {}
    with Runner() as runner:
        for name, scenario in runs.items():
            varied = replace(scenario, parameters=scenario.parameters.with_values(ablation.parameters or {}))
            ending, value, _ = runner.call("ablation:figures_of_run", varied, TIMEOUT_S)
            if ending is not Ending.DONE:
                print(f"{ablation.name}: {name}: {value}", file=sys.stderr, flush=True)
            found[name] = value if ending is Ending.DONE else NOTHING
    return found


def figures_of_run(scenario: Scenario) -> dict[str, float]:
    """Drive in this process."""
    scenes: list[Scene] = []
    result = run_trial(scenario, observer=scenes.append)
    steps = [scene.step for scene in scenes]
    stands = [step.speed < STANDING for step in steps]
    figures = result.figures
    named = ("collisions", "violations", "emergencies", "hard_braking_caused", "standstill_s", "rms_jerk_m_s3")
    return {name: float(figures.get(name) or 0.0) for name in (*named, "pilot_activations")} | {
        "arrived": float(result.arrived),
        "collisions": float(len(result.collisions)),
        "violations": float(len(result.violations)),
        "hard_braking_caused": float(len(result.hard_brakes)),
        "duration_s": result.duration_s,
        "stops": float(sum(now and not before for before, now in pairwise(stands))),
        "in_junctions_s": _in_junctions(steps, result.step_length_s),
        "clearance_m": min((_clearance(scene) for scene in scenes if scene.step.speed > PASSING), default=CLEAR_M),
        "time_to_collision_s": min(float(figures.get("min_time_to_collision_s") or SOON_S), SOON_S),
        "tracking_m": math.sqrt(sum(step.d**2 for step in steps) / max(len(steps), 1)),
    }


def _in_junctions(steps: Sequence[StepRecord], step_length: float) -> float:
    """Return for how long the ego stands with a part of its body in a junction, s."""
    found, way = 0.0, math.inf
    for step in steps:
        way = 0.0 if step.lane_id.startswith(":") else way + step.speed * step_length
        found += step_length if way < EGO_SIZE[0] and step.speed < STANDING else 0.0
    return found


def _clearance(scene: Scene) -> float:
    """Return the distance to the nearest body, at most CLEAR_M, m."""
    step = scene.step
    ego = Footprint(step.x, step.y, step.heading, *EGO_SIZE)
    reach = sum(EGO_SIZE) + CLEAR_M
    near = (
        user
        for user in (*scene.users, *scene.beside)  # who is parked is on no lane: only the second hold him
        if math.hypot(user.x - step.x, user.y - step.y) < reach + user.body.length + user.body.width
    )
    bodies = [Footprint(user.x, user.y, user.heading, user.body.length, user.body.width) for user in near]
    boxes = [shapely.polygons(body.corners()) for body in bodies]
    return float(min(CLEAR_M, *shapely.distance(shapely.polygons(ego.corners()), boxes))) if boxes else CLEAR_M


def losses(whole: Runs, without: Runs) -> dict[str, float]:
    """Return the loss in each measure over all runs, by key."""
    before, after = list(whole.values()), [without[name] for name in whole]
    return {measure.key: measure.loss(measure.key, before, after) for measure in MEASURES}


def missed(lost: Mapping[str, float], *, saves_runs: bool = False) -> list[str]:
    """Return in words what a user would miss: every loss beyond its threshold."""
    counted = MEASURES if saves_runs else MEASURES[:-1]
    return [one.words.format(_number(one, lost[one.key])) for one in counted if lost[one.key] > one.threshold]


def _number(measure: Measure, value: float) -> str:
    return f"{value:.{measure.digits}f}"


def told(whole: Runs, found: Sequence[tuple[Ablation, Runs]]) -> str:
    """Return the table, a sentence a row, and how many mechanisms carry weight."""
    everyone = [(one, losses(whole, runs)) for one, runs in found]
    lines = [
        f"{len(whole)} runs: {', '.join(whole)}.",
        "",
        f"| without | {' | '.join(measure.title for measure in MEASURES)} |",
        f"|---|{'---:|' * len(MEASURES)}",
    ]
    lines += [f"| (the whole driver) | {' | '.join(_number(m, _whole(m, list(whole.values()))) for m in MEASURES)} |"]
    lines += [f"| {one.title} | {' | '.join(_cells(one, lost))} |" for one, lost in everyone]
    lines += ["", *(f"- **{one.title}**: {_sentence(one, lost)}" for one, lost in everyone), ""]
    carrying = sum(bool(missed(lost, saves_runs=one.saves_runs)) for one, lost in everyone)
    return "\n".join([*lines, f"{carrying} of {len(everyone)} mechanisms carry weight"])


def _whole(measure: Measure, runs: Sequence[Figures]) -> float:
    """Return what a measure is over all runs."""
    if measure.loss is nearer:
        return min(run[measure.key] for run in runs)
    return _rms(measure.key, runs) if measure.loss in (rougher, rougher_by) else sum(run[measure.key] for run in runs)


def _cells(ablation: Ablation, lost: Mapping[str, float]) -> Iterator[str]:
    """Yield the cells of a row, what would be missed in bold."""
    for measure in MEASURES:
        number, counts = _number(measure, lost[measure.key]), measure is not MEASURES[-1] or ablation.saves_runs
        bold = counts and lost[measure.key] > measure.threshold
        yield f"**{number}**" if bold else "0" if float(number) == 0.0 else number


def _sentence(ablation: Ablation, lost: Mapping[str, float]) -> str:
    words = missed(lost, saves_runs=ablation.saves_runs)
    verdict = f"without it {', '.join(words)}." if words else "carries no weight yet."
    return f"{verdict} {ablation.note}".rstrip()


HEAD = f"""# What carries weight

Each mechanism of the paper, taken out of the default profile one at a time by `tools/ablation.py`: what driving loses
against the whole driver, over all runs. Positive is worse, negative better, and bold is a loss that a user would miss: an
arrival, a contact, a violation, an emergency, a hard braking caused or a stop; more than 1 s of standstill, of standing with
a part of the car in a junction, or of time; 5 % of jerk; 5 cm of tracking; in any one run 5 cm of clearance (below
{CLEAR_M:g} m, faster than {PASSING:g} m/s) or half a second of time to collision (below {SOON_S:g} s); and, where the
mechanism is there for it, twice the runs of the pilot. A run that does not arrive is ended after {LONGEST:g} times
the time that the whole driver takes, and {LONGER_S:g} s."""


if __name__ == "__main__":
    main()
