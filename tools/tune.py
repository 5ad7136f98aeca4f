#!/usr/bin/env python3
"""Search the coefficients of the potential field on roads drawn at random, and judge what is found on others.

    python tools/tune.py SEED N [--judged N] [--egos N] [--evaluations N] [--only INSTRUCTION …] [--jobs N] [--write FILE]

For all instructions together w₁, w₂ (w₃ stays: U is scaled by it), α, β and k₀ are searched; for one alone its w₁ and w₂
(F&L 1991, §4 names it as open that each behaviour needs its own). Nelder and Mead's simplex looks for the least cost over
the trips of N networks of the seed, in powers of two about the values in use: contacts before violations before time, as a
share of what SUMO's own driver takes, before jerk. What is found is then judged on the `--judged` networks of the next seed.
Prints a row for each search: the factors found, the cost before and after where it was searched and where it was judged;
they are worth taking where both fall. `--write` puts the table into a file. Exit codes: 0, 2 for wrong usage, 130 after an
interrupt.
"""

from __future__ import annotations

import argparse
import shutil
import signal
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.optimize import minimize

sys.path.insert(0, str(Path(__file__).parent))

from digests import Processes
from roads.trips import Order, Run, Trip

from sumo_reactive.driver.nouns.decision import INSTRUCTION_NUMBERS, Instruction
from sumo_reactive.driver.parameters import USUAL, Parameters
from sumo_reactive.lab.runner import Runner
from sumo_reactive.lab.task import Ending

TIMEOUT_S = 900.0
INTERRUPTED = 130
EVALUATIONS = 40
FARTHEST = 3.0
"""A coefficient is searched from an eighth of its value to eight times it."""

WEIGHTS = ("valley_share", "shadow_share")
COEFFICIENTS = (*WEIGHTS, "valley_attraction", "valley_repulsion", "shadow_scale")
TUNED = (
    Instruction.FOLLOW_CURVE, Instruction.APPROACH, Instruction.STOP, Instruction.CROSS, Instruction.OVERTAKE,
    Instruction.RETURN,
)  # fmt: skip
"""Those in which most of the way is driven; the others move slowly, and alone."""

PER_CONTACT, PER_VIOLATION, PER_SHARE_OF_TIME, PER_JERK = 1000.0, 100.0, 10.0, 1.0


class Case(NamedTuple):
    """A trip, and how long SUMO's own driver takes, s."""

    trip: Trip
    sumo_s: float


class Search(NamedTuple):
    """What is searched: for one instruction (None: for all), by which names."""

    instruction: Instruction | None
    names: tuple[str, ...]

    def parameters(self, powers: Sequence[float]) -> Parameters:
        """Return the driver's with the coefficients multiplied by these powers of two."""
        changed = {name: getattr(USUAL, name) * 2.0**power for name, power in zip(self.names, powers, strict=True)}
        number = 0.0 if self.instruction is None else INSTRUCTION_NUMBERS[self.instruction]
        return replace(USUAL, shares_of=number, **changed)


class Finding(NamedTuple):
    """What a search has come to: the powers of two, and the costs before and after where it searched and was judged."""

    search: Search
    powers: tuple[float, ...]
    searched: tuple[float, float]
    judged: tuple[float, float]

    @property
    def is_better(self) -> bool:
        """Whether it costs less on the roads that it has not seen, too."""
        return all(after < before for before, after in (self.searched, self.judged))


def cost_of(run: Run, sumo_s: float) -> float:
    """Return what a trip costs: contacts, then violations and what was no arrival, then time, then jerk."""
    violations = len(run.red) + run.ways_taken + run.hard_braking + (not run.arrived)
    time = run.duration_s / sumo_s if run.arrived else 2.0
    return PER_CONTACT * len(run.contacts) + PER_VIOLATION * violations + PER_SHARE_OF_TIME * time + PER_JERK * run.jerk


def cases(orders: Sequence[Order], processes: Processes) -> list[Case]:
    """Write the networks and return the trips in them that SUMO's own driver completes."""

    def one(order: Order, runner: Runner) -> list[Case]:
        ending, ready, _ = runner.call("roads.trips:prepared", order, TIMEOUT_S)
        if ending is not Ending.DONE:
            return []
        return [Case(Trip(ready.place, ego, ready.bridges), run.duration_s) for ego, run in ready.trips.items()]

    return [case for found in processes.each(orders, one) for case in found]


def cost(found: Sequence[Case], parameters: Parameters, processes: Processes) -> float:
    """Return the mean cost of the trips of a driver with these parameters."""

    def one(case: Case, runner: Runner) -> float:
        ending, run, _ = runner.call("roads.trips:driven", case.trip._replace(parameters=parameters), TIMEOUT_S)
        return cost_of(run if ending is Ending.DONE else Run(), case.sumo_s)

    return float(np.mean(list(processes.each(found, one))))


def searched(
    search: Search, known: float, found: Sequence[Case], evaluations: int, processes: Processes
) -> tuple[float, ...]:
    """Return the powers of two that cost least on the trips; `known` is what the present coefficients cost."""
    best, least = tuple(0.0 for _ in search.names), known

    def tried(powers: Sequence[float]) -> float:
        nonlocal best, least
        bounded = tuple(float(min(max(power, -FARTHEST), FARTHEST)) for power in powers)
        value = known if not any(bounded) else cost(found, search.parameters(bounded), processes)
        print(f"{_name(search)}: {_factors(search.names, bounded)}: {value:.2f}", file=sys.stderr, flush=True)
        if value < least:
            best, least = bounded, value
        return value

    simplex = np.vstack([np.zeros(len(best)), np.eye(len(best))])
    options = {"maxfev": evaluations, "initial_simplex": simplex, "xatol": 0.1, "fatol": 0.01}
    minimize(tried, np.zeros(len(best)), method="Nelder-Mead", options=options)
    return best


def tuned(asked: argparse.Namespace, folder: Path) -> Iterator[Finding]:
    """Search and judge."""
    searches = [Search(None, COEFFICIENTS)] if not asked.only else []
    searches += [Search(one, WEIGHTS) for one in TUNED if not asked.only or one.name.lower() in asked.only]
    with Processes(asked.jobs) as processes:
        here, there = (
            cases([Order(seed, k, _made(folder / f"{seed}_{k}"), asked.egos) for k in range(number)], processes)
            for seed, number in ((asked.seed, asked.number), (asked.seed + 1, asked.judged))
        )
        if not here or not there:
            raise SystemExit("tune: SUMO's own driver completes no trip")
        known, unseen = cost(here, USUAL, processes), cost(there, USUAL, processes)
        for search in searches:
            powers = searched(search, known, here, asked.evaluations, processes)
            parameters = search.parameters(powers)
            after = (cost(trips, parameters, processes) for trips in (here, there)) if any(powers) else (known, unseen)
            at_search, at_judging = after
            yield Finding(search, powers, (known, at_search), (unseen, at_judging))


def table(found: Sequence[Finding], asked: argparse.Namespace) -> str:
    """Return the findings as Markdown."""
    lines = [
        f"Searched on {asked.number} networks of seed {asked.seed}, judged on {asked.judged} of seed {asked.seed + 1}, "
        f"up to {asked.egos} trips in each, at most {asked.evaluations} evaluations a search. The cost is a mean over "
        f"trips: {PER_CONTACT:g} a contact, {PER_VIOLATION:g} a violation, {PER_SHARE_OF_TIME:g} times the duration over "
        f"that of SUMO's own driver, {PER_JERK:g} times the RMS jerk.",
        "",
        "| instruction | factors found | cost where searched | cost where judged | better |",
        "|---|---|---:|---:|---|",
    ]
    for one in found:
        searched_cost, judged_cost = (f"{before:.2f} → {after:.2f}" for before, after in (one.searched, one.judged))
        factors, better = _factors(one.search.names, one.powers), "yes" if one.is_better else "no"
        lines.append(f"| {_name(one.search)} | {factors} | {searched_cost} | {judged_cost} | {better} |")
    return "\n".join(lines)


def _name(search: Search) -> str:
    return "all" if search.instruction is None else search.instruction.value


def _factors(names: Sequence[str], powers: Sequence[float]) -> str:
    symbols: Mapping[str, str] = {
        "valley_share": "w₁", "shadow_share": "w₂", "valley_attraction": "α", "valley_repulsion": "β", "shadow_scale": "k₀"
    }  # fmt: skip
    return ", ".join(f"{symbols[name]} × {2.0**power:.2f}" for name, power in zip(names, powers, strict=True))


def _made(folder: Path) -> Path:
    folder.mkdir()
    return folder


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("seed", type=int, metavar="SEED", help="what the roads are drawn from; the next one judges")
    parser.add_argument("number", type=int, metavar="N", help="networks to search on")
    parser.add_argument("--judged", type=int, metavar="N", help="networks to judge on; default as many")
    parser.add_argument("--egos", type=int, default=2, metavar="N", help="trips in a network at most; default 2")
    parser.add_argument("--evaluations", type=int, default=EVALUATIONS, metavar="N", help="of a search; default 40")
    parser.add_argument(
        "--only", action="append", default=[], metavar="INSTRUCTION", choices=[one.name.lower() for one in TUNED],
        help="search for it alone; repeatable",
    )  # fmt: skip
    parser.add_argument("--jobs", type=int, default=1, metavar="N", help="trips at a time; default 1")
    parser.add_argument("--write", type=Path, metavar="FILE", help="write the table there, too")
    asked = parser.parse_args()
    asked.judged = asked.number if asked.judged is None else asked.judged
    if not 0 <= asked.seed < 2**31 - 1 or min(asked.number, asked.judged, asked.egos, asked.evaluations, asked.jobs) < 1:
        parser.error("SEED is 0 to 2147483646, all numbers are at least 1")
    return asked


def main() -> None:
    """Search, judge, print."""
    asked = _arguments()
    signal.signal(signal.SIGTERM, signal.default_int_handler)  # the temporary folder goes in any case
    folder = Path(tempfile.mkdtemp(prefix="tune_"))
    try:
        text = table(list(tuned(asked, folder)), asked)
    except KeyboardInterrupt:
        raise SystemExit(INTERRUPTED) from None
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    print(text)
    if asked.write:
        asked.write.write_text(f"# Coefficients, searched\n\n{text}\n", encoding="utf-8")


if __name__ == "__main__":
    main()
