"""`sumo-reactive run`: one trip, or those of several egos at once, judged."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from enum import StrEnum
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from sumo_reactive.cli.app import (
    DRIVER_HELP,
    DriverOptions,
    ParameterOption,
    SeedOption,
    app,
    compile_first,
    drivers_named,
    figures_kept,
    parameters_with,
    progress_shown,
    show_table,
    with_options,
)
from sumo_reactive.cli.egos import ClassOption, RegionOption, ShareOption, TypeOption, rule_asked

if TYPE_CHECKING:
    from sumo_reactive.driver.nouns.record import Scene
    from sumo_reactive.lab.ego_rule import EgoRule
    from sumo_reactive.lab.result import FleetResult, TrialResult
    from sumo_reactive.lab.scenario import Scenario
    from sumo_reactive.lab.simulation import SceneObserver


_EGOS_SHOWN = 20
"""Egos that are listed at most, those with a fault if there are any; all are in the record."""

_PLAIN_WIDTH = 120
"""Columns of the list where no terminal says how many there are."""


class ProfileName(StrEnum):
    """The values of `--profile`."""

    DEFAULT = "default"
    PAPER = "paper"


class DelaysName(StrEnum):
    """The values of `--delays`."""

    SHIFT = "shift"
    REPLAN = "replan"


class RecordName(StrEnum):
    """The values of `--record`."""

    FIELD = "field"


RecordOption = Annotated[
    list[RecordName] | None, typer.Option(help="field: U over the commands at every step, over the ground at decisions")
]

EgoOption = Annotated[
    list[str] | None, typer.Option(help="vehicle to drive (repeatable); else one named 'ego', else the first car")
]

HorizonOption = Annotated[float | None, typer.Option(min=0.1, help="end this long after the departure of the one ego, s")]

PolygonsOption = Annotated[
    str | None, typer.Option(metavar="TYPE", help="polygons of this type stand on the road; else those of 'obstacle'")
]

CoresOption = Annotated[int, typer.Option(min=1, max=64, help="processes that share several egos")]

_EXAMPLE = "Example: sumo-reactive run my.sumocfg --ego veh_12 --out DIR -- --tripinfo-output t.xml"


@app.command(epilog=f"Options after -- go to SUMO unchanged. {_EXAMPLE}")
def run(
    context: typer.Context,
    config: Annotated[Path, typer.Argument(help="a .sumocfg, or a scenario .toml")],
    ego: EgoOption = None,
    ego_type: TypeOption = None,
    ego_class: ClassOption = None,
    ego_region: RegionOption = None,
    ego_probability: ShareOption = None,
    seed: SeedOption = None,
    step_length: Annotated[float | None, typer.Option(help="simulation step, s")] = None,
    profile: Annotated[ProfileName | None, typer.Option(help="the paper's nine commands, or the finer default")] = None,
    delays: Annotated[DelaysName | None, typer.Option(help="shift times by a delay, as in the paper, or re-plan")] = None,
    until: Annotated[float | None, typer.Option(help="end at this simulation time, s")] = None,
    horizon: HorizonOption = None,
    obstacle_polygons: PolygonsOption = None,
    parameter: ParameterOption = None,
    driver: Annotated[str | None, typer.Option(help=DRIVER_HELP)] = None,
    driver_option: DriverOptions = None,
    until_end: Annotated[bool, typer.Option("--until-end", help="play on after the ego has arrived")] = False,
    out: Annotated[Path | None, typer.Option(help="folder for summary, trajectory and decisions")] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="replace another run in that folder")] = False,
    record: RecordOption = None,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="print the verdict only")] = False,
    gui: Annotated[bool, typer.Option("--gui", help="watch it in SUMO's own window")] = False,
    gui_speed: Annotated[float, typer.Option(min=0.01, max=1000.0, help="times faster than life in the window")] = 1.0,
    cores: CoresOption = 1,
) -> int:
    """Let the ego drive to its goal in a SUMO scenario, and judge the trip; or several egos at once."""
    from sumo_reactive.driver.parameters import Delays, Profile
    from sumo_reactive.lab.scenario import load_scenario

    scenario, named = load_scenario(config), ego or []
    scenario = with_options(
        scenario, ego=named[0] if len(named) == 1 else None, seed=seed, step_length_s=step_length, until_s=until,
        profile=profile and Profile(profile.value), horizon_s=horizon, parameters=parameters_with(scenario, parameter or []),
        until_end=until_end or None, driver=next(iter(drivers_named([driver] if driver else [], driver_option or [])), None),
        delays=delays and Delays(delays.value), obstacle_polygons=obstacle_polygons, sumo_options=tuple(context.obj or ()),
    )  # fmt: skip
    rule = rule_asked(named, ego_type, ego_class, ego_region, ego_probability) or _own_rule(scenario, named)
    return _drive(scenario, rule, _kept(scenario, rule, out, overwrite, record), cores, quiet, gui_speed if gui else None)


def _own_rule(scenario: Scenario, ids: Sequence[str]) -> EgoRule | None:
    """Return the rule of the file, or one that leaves it to the equipment of vehicles, if there is such; else None."""
    from sumo_reactive.lab.ego_rule import EgoRule
    from sumo_reactive.sumo.config import read_config
    from sumo_reactive.sumo.vehicle_type import Equipment

    if ids or scenario.ego is not None:
        return None
    return scenario.egos or (EgoRule() if Equipment(read_config(scenario.config)).is_named else None)


def _kept(
    scenario: Scenario, rule: EgoRule | None, out: Path | None, overwrite: bool, record: Sequence[RecordName] | None
) -> Callable[[], Any] | None:
    """Return what makes the recorder of a scenario's one ego, or of several, if there is a folder for the record."""
    if out is None:
        if record:
            raise typer.BadParameter("there is no --out to keep it in", param_hint="--record")
        return None
    from sumo_reactive.lab.recorder import FleetRecorder, Recorder

    asked = {"overwrite": overwrite, "every_field": RecordName.FIELD in (record or ())}
    return partial(FleetRecorder, out, **asked) if rule else partial(Recorder, out, scenario=scenario, **asked)


def _drive(
    scenario: Scenario, rule: EgoRule | None, kept: Callable[[], Any] | None, cores: int, quiet: bool,
    gui_speed: float | None,
) -> int:  # fmt: skip
    """Drive one ego, or those that the rule chooses, by so many processes; show what comes of it, record it by what `kept`
    makes; return the exit code."""
    from sumo_reactive.lab.fleet import Running, run_fleet
    from sumo_reactive.lab.simulation import run_trial
    from sumo_reactive.sumo.crash import crashes_told

    has_window = gui_speed is not None
    if cores > 1 and (rule is None or has_window):
        raise typer.BadParameter("several processes drive several egos, without a window", param_hint="--cores")
    recorder = kept() if kept else None
    show: Callable[[Any, bool], None] = _show_several if rule else _show
    running = Running(has_window, cores, recorder.shelf if recorder and cores > 1 else None)
    run = (
        partial(run_fleet, scenario, rule, running=running) if rule
        else partial(run_trial, scenario, has_window=has_window)
    )  # fmt: skip
    observer = _watched(recorder.see if recorder else None, gui_speed)
    compile_first()
    with progress_shown(quiet) as progress, crashes_told(has_window=has_window):
        result: Any = run(observer=observer, progress=progress)
    show(result, quiet)
    if recorder:
        with figures_kept(quiet, lambda: show(result, False)):
            recorder.write(result)
    return int(result.exit_code)


def _watched(observer: SceneObserver | None, gui_speed: float | None) -> SceneObserver | None:
    """Return an observer that shows each scene in SUMO's window, too, if there is one, `gui_speed` times as fast as life."""
    if gui_speed is None:
        return observer
    from sumo_reactive.show.page import BEHAVIOUR_COLOURS
    from sumo_reactive.sumo.window import Window

    window = Window({behaviour.value: colour for behaviour, colour in BEHAVIOUR_COLOURS.items()}, gui_speed)

    def see(scene: Scene) -> None:
        if observer is not None:
            observer(scene)
        window.see(scene)

    return see


def _show(result: TrialResult, quiet: bool) -> None:
    from sumo_reactive.lab.result import rows_of

    if quiet:
        typer.echo(f"{result.ego}: {result.verdict}")
    else:
        show_table(rows_of(result), title=result.scenario)
    _tell_failures([result])


def _tell_failures(results: Sequence[TrialResult]) -> None:
    """Tell the traceback of each metric of the user's own that failed, once."""
    failures = [failure for result in results for failure in result.metric_failures]
    for traceback in dict.fromkeys(failure.traceback for failure in failures):
        typer.echo("\n".join(traceback), err=True)


def _show_several(fleet: FleetResult, quiet: bool) -> None:
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    from sumo_reactive.lab.metric_names import METRICS
    from sumo_reactive.lab.result import changed_rows

    arrived = sum(result.arrived for result in fleet.results)
    typer.echo(
        f"{len(fleet.results)} egos until {fleet.until:.1f} s: {arrived} arrived, {len(fleet.on_their_way)} on their way, "
        f"{len(fleet.faulty)} with a fault"
    )
    for name, reason in fleet.refused:
        typer.echo(f"not taken over: {name}: {reason}")
    _tell_failures(fleet.results)
    if quiet:
        return
    table = Table("ego", "departed (s)", METRICS["duration_s"].title, METRICS["time_loss_s"].title, "verdict", box=None)
    for result in (fleet.faulty or fleet.results)[:_EGOS_SHOWN]:
        is_cut_short = result.ego in fleet.on_their_way and result not in fleet.faulty
        verdict = "on its way" if is_cut_short else result.verdict
        figures = (f"{figure:.1f}" for figure in (result.departure_s, result.duration_s, result.time_loss_s))
        table.add_row(Text(result.ego), *figures, Text(verdict))
    Console(highlight=False, width=None if sys.stdout.isatty() else _PLAIN_WIDTH).print(table)
    for label, text in changed_rows(fleet):
        typer.echo(f"{label}  {text}")
    typer.echo(f"driver {fleet.step_us:.0f} µs an ego and step; {fleet.wall_s:.1f} s in all")
