#!/usr/bin/env python3
"""Drive on roads that nobody has seen: networks and traffic drawn at random, each trip by SUMO's own driver and by this one.

    python tools/random_roads.py SEED N [--first INDEX] [--egos N] [--kind TEXT] [--jobs N] [--json FILE] [--timeout S]
                                 [--together] [--parameter NAME=VALUE …]
    python tools/random_roads.py SEED N --only INDEX [--ego ID] [--together] [--keep DIR]

N networks with their traffic, each fully determined by SEED and its INDEX; up to `--egos` trips in each, drawn among those
that SUMO's own driver completes. Prints a table by kind, "this driver / SUMO's own", then the trips where this driver is
worse (contact, red light, failure, no arrival, more hard brakings caused, more than 1.5 times as long), smallest network
first, each with the command that replays it. With `--together` the egos of a network drive in one simulation, each among the
others, which takes a fraction of the time; a contact between two of them counts for both. `--keep` writes the files of one
network and drives nothing: it prints the `sumo-reactive run` command of each ego, or of all together. Both drivers are
judged alike: contacts, red lights and time off the road by a witness that looks at SUMO alone, the rest by the lab's judges.
Exit codes: 0, 1 after a contact, a red light run or a trip that failed, 2 for wrong input, 130 after an interrupt.
"""

from __future__ import annotations

import argparse
import json
import shlex
import shutil
import signal
import sys
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

sys.path.insert(0, str(Path(__file__).parent))

from digests import in_processes
from roads.kinds import kind_at
from roads.table import Row, as_data, faults, table, worse
from roads.trips import Order, Prepared, Run, Trip, prepared, scenario_of

from sumo_reactive.driver.parameters import USUAL, Parameters
from sumo_reactive.errors import ParameterError, ReactiveError
from sumo_reactive.lab.runner import Runner
from sumo_reactive.lab.task import Ending, Task, replay_command

EGOS = 8
TIMEOUT_S = 900.0
SUMO_FAILED, INTERNAL_ERROR, TOO_LONG, INTERRUPTED = 3, 70, 124, 130


class Found(NamedTuple):
    """What came of a network: its trips, or why there are none."""

    number: int
    rows: tuple[Row, ...] = ()
    reason: str = ""


def main() -> None:
    """Drive, or keep the files of a network; print."""
    asked = _arguments()
    if asked.keep:
        raise SystemExit(_keep(asked))
    signal.signal(signal.SIGTERM, signal.default_int_handler)  # the temporary folders go in any case
    try:
        found = list(driven(_orders(asked), asked.jobs, asked.timeout, asked.together))
    except KeyboardInterrupt:
        raise SystemExit(INTERRUPTED) from None
    rows = [row for one in found for row in one.rows]
    if asked.json:
        data = {"seed": asked.seed, "trips": [as_data(row) for row in rows], "not driven": _not_driven(found)}
        asked.json.write_text(json.dumps(data, indent=2, ensure_ascii=False) + "\n", encoding="utf-8")
    _show(asked.seed, found, rows, asked.parameters, asked.egos if asked.together else 0)
    raise SystemExit(int(any(row.is_harmful for row in rows)))


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("seed", type=int, metavar="SEED", help="what all is drawn from")
    parser.add_argument("number", type=int, metavar="N", help="how many networks")
    parser.add_argument("--first", type=int, default=0, metavar="INDEX", help="number of the first network; default 0")
    parser.add_argument("--egos", type=int, default=EGOS, metavar="N", help=f"trips in a network at most; default {EGOS}")
    parser.add_argument("--kind", default="", metavar="TEXT", help="networks whose kind holds this text")
    parser.add_argument("--only", type=int, metavar="INDEX", help="only the network with this number")
    parser.add_argument("--ego", default="", metavar="ID", help="only this ego; needs --only")
    parser.add_argument("--together", action="store_true", help="the egos of a network in one simulation")
    parser.add_argument("--keep", type=Path, metavar="DIR", help="write the scenario there, and drive nothing; needs --only")
    parser.add_argument("--jobs", type=int, default=1, metavar="N", help="networks at a time; default 1")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write all trips there, too")
    parser.add_argument("--timeout", type=float, default=TIMEOUT_S, metavar="S", help="of a trip, wall clock; default 900")
    parser.add_argument("--parameter", action="append", default=[], metavar="NAME=VALUE", help="this driver's; repeatable")
    asked = parser.parse_args()
    try:
        asked.parameters = _parameters(asked.parameter)
    except (ParameterError, ValueError) as error:
        parser.error(f"--parameter: {error}")
    if not 0 <= asked.seed < 2**31 or asked.number < 1 or asked.first < 0 or asked.egos < 1:
        parser.error("SEED is 0 to 2147483647, N and --egos are at least 1, --first at least 0")
    if asked.jobs < 1 or not asked.timeout > 0.0:
        parser.error("--jobs and --timeout are greater than 0")
    if (asked.ego or asked.keep) and asked.only is None:
        parser.error("--ego and --keep need --only")
    if asked.only is not None and not 0 <= asked.only - asked.first < asked.number:
        parser.error(f"--only is one of the {asked.number} networks from {asked.first}")
    if asked.json and not asked.json.parent.is_dir():
        parser.error(f"{asked.json}: not a file in a folder that exists")
    return asked


def _parameters(said: Sequence[str]) -> Parameters:
    """Return this driver's parameters, those with other values said as NAME=VALUE."""
    pairs = (one.partition("=") for one in said)
    return Parameters.of({name: float(value) for name, _, value in pairs})


def _orders(asked: argparse.Namespace) -> list[Order]:
    """Return what is asked for; the folders are chosen when they are needed."""
    numbers = range(asked.first, asked.first + asked.number) if asked.only is None else [asked.only]
    chosen = [k for k in numbers if asked.kind in kind_at(k)]
    return [Order(asked.seed, k, Path(), asked.egos, asked.ego, asked.parameters) for k in chosen]


def _keep(asked: argparse.Namespace) -> int:
    """Write the files of a network and print how its trips are driven."""
    asked.keep.mkdir(parents=True, exist_ok=True)
    order = Order(asked.seed, asked.only, asked.keep, asked.egos, asked.ego, asked.parameters)
    try:
        ready = prepared(order)
    except ReactiveError as error:
        print(f"random_roads: {error}", file=sys.stderr)
        return error.exit_code
    for egos in [(*ready.trips,)] if asked.together and ready.trips else [(ego,) for ego in ready.trips]:
        print(_run_command(ready, egos, order.parameters))
    return 0


def _run_command(ready: Prepared, egos: Sequence[str], parameters: Parameters) -> str:
    """Return the command that drives one ego, or several together."""
    one, more = (egos[0], ()) if len(egos) == 1 else ("", [word for ego in egos for word in ("--ego", ego)])
    command = replay_command(Task(scenario_of(ready.place, one, parameters)))
    folder = ready.place.config.parent / (one or "together")
    return shlex.join([*shlex.split(command), *more, "--out", str(folder), "--overwrite"])


def driven(orders: Sequence[Order], jobs: int, timeout: float, together: bool = False) -> Iterator[Found]:
    """Drive so many networks at a time, each trip or all `together` in a process; yield what came of them in their order."""

    def one(order: Order, runner: Runner) -> Found:
        folder = Path(tempfile.mkdtemp(prefix="random_roads_"))
        try:
            return _driven_network(order._replace(folder=folder), runner, timeout, together)
        finally:
            shutil.rmtree(folder, ignore_errors=True)

    yield from in_processes(orders, one, jobs)


def _driven_network(order: Order, runner: Runner, timeout: float, together: bool = False) -> Found:
    """Drive the trips of a network, and tell of each on stderr."""
    kind = kind_at(order.index)
    ending, ready, _ = runner.call("roads.trips:prepared", order, timeout)
    if ending is not Ending.DONE or not ready.trips:
        reason = "SUMO's own driver completes no trip" if ending is Ending.DONE else str(ready)
        print(f"[{order.index} {kind}] {reason}", file=sys.stderr, flush=True)
        return Found(order.index, (), reason)
    trips, rows = [Trip(ready.place, ego, ready.bridges, order.parameters) for ego in ready.trips], []
    for some in [trips] if together else [[trip] for trip in trips]:
        for ego, ours, wall_s in _driven_trips(some, runner, timeout):
            rows.append(Row(order.index, kind, ready.place.edges, ego, ours, ready.trips[ego]))
            told = "; ".join(faults(rows[-1])) or "well"
            print(f"[{order.index} {kind}] {ego}: {told} ({wall_s:.0f} s)", file=sys.stderr, flush=True)
    return Found(order.index, (*rows,))


def _driven_trips(trips: Sequence[Trip], runner: Runner, timeout: float) -> Iterator[tuple[str, Run, float]]:
    """Drive one trip, or several together, each alone where that fails; yield each ego, what came of it, and its share of
    the s that it took."""
    if len(trips) > 1:
        ending, runs, wall_s = runner.call("roads.trips:driven_together", trips, timeout * len(trips))
        if ending is Ending.DONE:
            yield from ((ego, run, wall_s / len(runs)) for ego, run in runs.items())
            return
    for trip in trips:
        ending, value, wall_s = runner.call("roads.trips:driven", trip, timeout)
        yield trip.ego, value if ending is Ending.DONE else _failed(ending, str(value)), wall_s


def _failed(ending: Ending, reason: str) -> Run:
    """Return what stands for a trip that could not be driven to its end, with the exit code that `run` has."""
    code = INTERNAL_ERROR if reason.startswith("internal error") else SUMO_FAILED
    return Run(exit_code=TOO_LONG if ending is Ending.TIMEOUT else code, error=reason)


def _not_driven(found: Sequence[Found]) -> list[dict[str, Any]]:
    return [{"index": one.number, "kind": kind_at(one.number), "reason": one.reason} for one in found if one.reason]


def _show(seed: int, found: Sequence[Found], rows: Sequence[Row], parameters: Parameters = USUAL, together: int = 0) -> None:
    """Print the table, what was not driven, and the trips where this driver is worse; so many egos drove `together`."""
    print(table(rows))
    missed = _not_driven(found)
    print(f"\n{len(found)} networks, {len(missed)} without a trip; {len(rows)} trips; this driver / SUMO's own")
    for one in missed:
        print(f"   {one['index']} {one['kind']}: {one['reason']}")
    bad = worse(rows)
    print(f"\n{len(bad)} trips where this driver is worse, smallest network first:")
    for row in bad:
        print(f"{row.kind} ({row.edges} edges), {row.ego}: {'; '.join(faults(row))}")
        print(f"   {replay(seed, row, parameters, together)}")
    for row in rows:
        if row.disagrees:
            print(f"the program's own judges disagree with the witness: {row.kind}, {row.ego}: {row.ours.told}")
            print(f"   {replay(seed, row, parameters, together)}")


def replay(seed: int, row: Row, parameters: Parameters, together: int = 0) -> str:
    """Return the command that writes the scenario of a trip and tells how it is driven, alone or among so many egos."""
    where = f"runs/random_{seed}_{row.index}"
    words = ["python", "tools/random_roads.py", str(seed), str(row.index + 1), "--only", str(row.index)]
    words += ["--together", "--egos", str(together)] if together else ["--ego", row.ego]
    words += (word for name, value in parameters.varied.items() for word in ("--parameter", f"{name}={value!r}"))
    return shlex.join([*words, "--keep", where])


if __name__ == "__main__":
    main()
