"""`sumo-reactive compare`: the same trips under SUMO's own driver and under this one."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from sumo_reactive.cli.app import app, figures_kept, note_compiling

if TYPE_CHECKING:
    from sumo_reactive.lab.comparison.comparison import Comparison
    from sumo_reactive.lab.runner import Outcome
    from sumo_reactive.lab.scenario import Scenario

DEFAULT_HORIZON_S = 600.0
"""Ten minutes: most trips in a town are over, and a jam that one car has caused is gone or has shown."""

DEFAULT_LIMIT_S = 3600.0
MAX_SEED = 2**31 - 1


@app.command(epilog="Options after -- go to SUMO unchanged, in both runs.")
def compare(
    context: typer.Context,
    config: Annotated[Path, typer.Argument(help="a .sumocfg, or a scenario .toml")],
    ego: Annotated[list[str] | None, typer.Option(help="vehicle to drive, repeatable; else as for 'run'")] = None,
    seed: Annotated[
        list[str] | None, typer.Option(metavar="N", help="a number or a range as 1-10, repeatable; else the scenario's")
    ] = None,
    step_length: Annotated[float | None, typer.Option(help="simulation step, s")] = None,
    until: Annotated[float | None, typer.Option(help="end both runs at this simulation time, s")] = None,
    horizon: Annotated[
        float, typer.Option(min=1.0, help="end both runs this long after the ego's departure, s")
    ] = DEFAULT_HORIZON_S,
    jobs: Annotated[int | None, typer.Option("--jobs", "-j", min=1, metavar="N", help="runs at a time; else cores")] = None,
    time_limit: Annotated[float, typer.Option(min=1.0, help="wall-clock time that a run may take, s")] = DEFAULT_LIMIT_S,
    out: Annotated[Path | None, typer.Option(help="folder for comparison.json and comparison.csv")] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="replace another comparison in that folder")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="print no table")] = False,
) -> int:
    """Let SUMO's own driver and this one drive the same trips, and tell the differences, for the ego and for the others."""
    from sumo_reactive.lab.comparison.comparison import compare as compared
    from sumo_reactive.lab.comparison.record import require_usable, write

    scenarios = _scenarios(config, ego or [], [number for text in seed or [] for number in _seeds(text)])
    scenarios = [_with_options(one, step_length, until, tuple(context.obj or ())) for one in scenarios]
    if out is not None:
        require_usable(out, overwrite)
    note_compiling()
    with _told(2 * len(scenarios), quiet) as progress:
        comparison = compared(
            scenarios, horizon_s=horizon, jobs=jobs or os.cpu_count() or 1, wall_limit_s=time_limit, progress=progress
        )
    _show(comparison, quiet)
    if out is not None:
        with figures_kept(quiet, lambda: _show(comparison, False)):
            write(comparison, out)
    return comparison.exit_code


def _scenarios(config: Path, egos: Sequence[str], seeds: Sequence[int]) -> list[Scenario]:
    """Return a scenario for each ego and seed; what the command line leaves out is as the file says."""
    from sumo_reactive.lab.scenario import load_scenario, load_scenario_file

    for option, values in (("--ego", egos), ("--seed", seeds)):
        if len(set(values)) < len(values):
            raise typer.BadParameter(f"{option}: a value is given twice")
    if config.suffix == ".toml":
        file = load_scenario_file(config)
        scenario, own_seeds = file.scenario, file.seeds
    else:
        scenario = load_scenario(config)
        own_seeds = (scenario.seed,)
    chosen = egos or (scenario.ego,)
    return [replace(scenario, ego=ego, seed=seed) for ego in chosen for seed in seeds or own_seeds]


def _seeds(text: str) -> range:
    """Return the seeds that a number or a range stands for."""
    first, is_range, last = text.partition("-")
    if not first.isdecimal() or (is_range and not last.isdecimal()):
        raise typer.BadParameter(f"--seed: '{text}' is neither a whole number nor a range such as 1-10")
    seeds = range(int(first), int(last if is_range else first) + 1)
    if not seeds or seeds[-1] > MAX_SEED:
        raise typer.BadParameter(f"--seed: '{text}' is empty or goes beyond {MAX_SEED}")
    return seeds


def _with_options(
    scenario: Scenario, step_length: float | None, until: float | None, sumo_options: tuple[str, ...]
) -> Scenario:
    """Return the scenario with what the command line says in place of what the file says."""
    return replace(
        scenario,
        step_length_s=scenario.step_length_s if step_length is None else step_length,
        until_s=scenario.until_s if until is None else until,
        sumo_options=sumo_options,
    )


@contextmanager
def _told(number: int, quiet: bool) -> Iterator[Callable[[Outcome], None] | None]:
    """Give a function that shows on the terminal how many runs have ended; None where nobody looks."""
    if quiet or not sys.stderr.isatty():
        yield None
        return
    from itertools import count

    from rich.console import Console

    numbers = count(1)
    with Console(stderr=True).status(f"0 of {number} runs") as status:
        yield lambda outcome: status.update(f"{next(numbers)} of {number} runs")


def _show(comparison: Comparison, quiet: bool) -> None:
    from sumo_reactive.lab.comparison.record import HEAD, notes_of, rows_of

    if not quiet:
        _show_table(HEAD, rows_of(comparison))
        typer.echo("\n".join(notes_of(comparison)))
    driven = len(comparison.pairs) - len(comparison.failed)
    typer.echo(f"{driven} of {len(comparison.pairs)} {'pair' if len(comparison.pairs) == 1 else 'pairs'} driven by both")


def _show_table(head: tuple[str, ...], rows: Sequence[tuple[str, ...]]) -> None:
    if not rows:
        return
    if not sys.stdout.isatty():
        wide = [max(len(row[k]) for row in (head, *rows)) for k in range(len(head))]
        for row in (head, *rows):
            cells = [f"{cell:{'<' if k == 0 else '>'}{wide[k]}}" for k, cell in enumerate(row)]
            typer.echo("  ".join(cells).rstrip())
        return
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    table = Table()
    for k, title in enumerate(head):
        table.add_column(title, justify="left" if k == 0 else "right")
    for row in rows:
        table.add_row(*map(Text, row))
    Console().print(table)
