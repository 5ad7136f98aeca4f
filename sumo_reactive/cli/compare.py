"""`sumo-reactive compare`: the same trips under SUMO's own driver and under others."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from sumo_reactive.cli.app import (
    DRIVER_HELP,
    JOBS,
    DriverOptions,
    ParameterOption,
    SeedsOption,
    app,
    compile_first,
    drivers_named,
    figures_kept,
    parameters_with,
    seeds_named,
    show_table,
    status_shown,
    with_options,
)
from sumo_reactive.cli.egos import ClassOption, RegionOption, ShareOption, TypeOption, rule_asked

if TYPE_CHECKING:
    from sumo_reactive.lab.comparison.comparison import Comparison
    from sumo_reactive.lab.drivers.choice import DriverChoice
    from sumo_reactive.lab.ego_rule import EgoRule
    from sumo_reactive.lab.scenario import Scenario

_HORIZON_S = 600.0
"""Ten minutes: most trips in a town are over, and a jam that one car has caused is gone or has shown."""

_Horizon = Annotated[float, typer.Option(min=1.0, help="end both runs this long after the ego's departure, s")]

_EXAMPLE = "Example: sumo-reactive compare my.sumocfg --ego veh_12 --out DIR"


@app.command("compare", epilog=f"Options after -- go to SUMO unchanged, in both runs. {_EXAMPLE}")
def compare_drivers(
    context: typer.Context,
    config: Annotated[Path, typer.Argument(help="a .sumocfg, or a scenario .toml")],
    ego: Annotated[list[str] | None, typer.Option(help="vehicle to drive, repeatable; else as for 'run'")] = None,
    ego_type: TypeOption = None,
    ego_class: ClassOption = None,
    ego_region: RegionOption = None,
    ego_probability: ShareOption = None,
    seed: SeedsOption = None,
    step_length: Annotated[float | None, typer.Option(help="simulation step, s")] = None,
    until: Annotated[float | None, typer.Option(help="end both runs at this simulation time, s")] = None,
    parameter: ParameterOption = None,
    driver: Annotated[list[str] | None, typer.Option(help=f"{DRIVER_HELP} (repeatable)")] = None,
    driver_option: DriverOptions = None,
    horizon: _Horizon = _HORIZON_S,
    jobs: Annotated[int | None, typer.Option(*JOBS, min=1, metavar="N", help="runs at a time; else cores")] = None,
    time_limit: Annotated[float, typer.Option(min=1.0, help="wall-clock time that a run may take, s")] = 3600.0,
    out: Annotated[Path | None, typer.Option(help="folder for comparison.json and comparison.csv")] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="replace another comparison in that folder")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="print no table")] = False,
) -> int:
    """Let SUMO's own driver and another drive the same trips, and tell the differences, for the ego and for the others."""
    from sumo_reactive.lab.comparison.comparison import compare
    from sumo_reactive.lab.comparison.record import write

    rule = rule_asked((), ego_type, ego_class, ego_region, ego_probability)
    options = {"step_length_s": step_length, "until_s": until, "sumo_options": tuple(context.obj or ())}
    named = _scenarios(config, ego or [], seeds_named(seed or []), rule)
    scenarios = [with_options(one, parameters=parameters_with(one, parameter or []), **options) for one in named]
    drivers = _challengers(scenarios[0], driver or [], driver_option or [])
    folders = _folders(out, drivers, overwrite)
    compile_first()
    driven = partial(compare, horizon_s=horizon, jobs=jobs or os.cpu_count() or 1, wall_limit_s=time_limit)
    with _counted((1 + len(drivers)) * len(scenarios), quiet) as progress:
        comparisons = driven(scenarios, drivers=drivers, progress=progress)
    _show_all(comparisons, quiet)
    for comparison, folder in zip(comparisons, folders, strict=False):
        with figures_kept(quiet, partial(_show_all, comparisons, False)):
            write(comparison, folder)
    return max(comparison.exit_code for comparison in comparisons)


@contextmanager
def _counted(runs: int, quiet: bool) -> Iterator[Callable[[object], None] | None]:
    """Give a function that tells how many of the runs have ended; None where nobody looks."""
    numbers = count(1)
    with status_shown(quiet, f"0 of {runs} runs") as show:
        yield None if show is None else lambda _: show(f"{next(numbers)} of {runs} runs")


def _challengers(scenario: Scenario, names: Sequence[str], options: Sequence[str]) -> list[DriverChoice]:
    """Return who is compared with SUMO's own driver: those named, else the scenario's, else this project's."""
    from sumo_reactive.lab.drivers.choice import REACTIVE, SUMO
    from sumo_reactive.lab.drivers.loading import require_driver

    found = drivers_named(names, options) or [REACTIVE if scenario.driver == SUMO else scenario.driver]
    for one in found:
        require_driver(one)
    if SUMO in found or len(set(found)) < len(found):
        raise typer.BadParameter("--driver: each once; SUMO's own driver is there anyway")
    return found


def _folders(out: Path | None, drivers: Sequence[DriverChoice], overwrite: bool) -> list[Path]:
    """Return the folder of each comparison, which can be written: the one asked for, or in it one a driver of several."""
    from sumo_reactive.lab.comparison.record import require_usable
    from sumo_reactive.lab.recorder import EgoFolders

    names = EgoFolders(())
    found = [] if out is None else [out] if len(drivers) == 1 else [out / names.of(str(driver)) for driver in drivers]
    for folder in found:
        require_usable(folder, overwrite)
    return found


def _show_all(comparisons: Sequence[Comparison], quiet: bool) -> None:
    for comparison in comparisons:
        if len(comparisons) > 1:
            typer.echo(f"\n{comparison.driver}")
        _show(comparison, quiet)


def _scenarios(config: Path, egos: Sequence[str], seeds: Sequence[int], rule: EgoRule | None) -> list[Scenario]:
    """Return a scenario for each ego, or each rule for several, and seed; what the command line leaves out is as the file
    says."""
    from sumo_reactive.lab.scenario import load_scenario, load_scenario_file

    if rule and egos:
        raise typer.BadParameter("--ego: one trip each; several egos at once are chosen by kind and share")
    if len(set(egos)) < len(egos):
        raise typer.BadParameter("--ego: a value is given twice")
    if config.suffix == ".toml":
        scenario, own_seeds, _, own_rules = load_scenario_file(config)
    else:
        scenario, own_rules = load_scenario(config), ()
        own_seeds = (scenario.seed,)
    rules = () if egos else (rule,) if rule else own_rules
    if rules:
        return [replace(scenario, ego=None, egos=rule, seed=seed) for rule in rules for seed in seeds or own_seeds]
    chosen = egos or (scenario.ego,)
    return [replace(scenario, ego=ego, egos=None, seed=seed) for ego in chosen for seed in seeds or own_seeds]


def _show(comparison: Comparison, quiet: bool) -> None:
    from sumo_reactive.lab.comparison.record import comparison_rows, head_of, notes_of

    if not quiet:
        rows = comparison_rows(comparison)
        if rows:
            show_table(rows, head_of(comparison))
        typer.echo("\n".join(notes_of(comparison)))
    driven = len(comparison.pairs) - len(comparison.failed)
    typer.echo(f"{driven} of {len(comparison.pairs)} {'pair' if len(comparison.pairs) == 1 else 'pairs'} driven by both")
