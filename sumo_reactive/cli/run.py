"""`sumo-reactive run`: one trip, judged."""

from __future__ import annotations

import json
import os
import sys
from dataclasses import replace
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from sumo_reactive.cli.app import app, figures_kept, note_compiling, progress_shown

if TYPE_CHECKING:
    from sumo_reactive.lab.recorder import Recorder
    from sumo_reactive.lab.result import TrialResult
    from sumo_reactive.lab.scenario import Scenario


class ProfileName(StrEnum):
    """The values of `--profile`."""

    DEFAULT = "default"
    PAPER = "paper"


class DelaysName(StrEnum):
    """The values of `--delays`."""

    SHIFT = "shift"
    REPLAN = "replan"


@app.command(epilog="Options after -- go to SUMO unchanged.")
def run(
    context: typer.Context,
    config: Annotated[Path, typer.Argument(help="a .sumocfg, or a scenario .toml")],
    ego: Annotated[
        list[str] | None, typer.Option(help="vehicle to drive (repeatable); else one named 'ego', else the first car")
    ] = None,
    ego_type: Annotated[list[str] | None, typer.Option(help="drive every vehicle of this type")] = None,
    ego_probability: Annotated[
        float | None, typer.Option(min=0.0, max=1.0, help="drive this share of all cars, drawn by id and seed")
    ] = None,
    seed: Annotated[int | None, typer.Option(min=0, help="seed of the random numbers; else the scenario's, else 42")] = None,
    step_length: Annotated[float | None, typer.Option(help="simulation step, s")] = None,
    profile: Annotated[ProfileName | None, typer.Option(help="the paper's nine commands, or the finer default")] = None,
    delays: Annotated[DelaysName | None, typer.Option(help="shift times by a delay, as in the paper, or re-plan")] = None,
    until: Annotated[float | None, typer.Option(help="end at this simulation time, s")] = None,
    until_end: Annotated[bool, typer.Option("--until-end", help="play on after the ego has arrived")] = False,
    out: Annotated[Path | None, typer.Option(help="folder for summary, trajectory and decisions")] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="replace another run in that folder")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="print the verdict only")] = False,
) -> int:
    """Let the ego drive to its goal in a SUMO scenario, and judge the trip; or several egos at once."""
    from sumo_reactive.cli.fleet import asked_for, run_several
    from sumo_reactive.lab.recorder import Recorder
    from sumo_reactive.lab.scenario import load_scenario

    scenario = load_scenario(config)
    _start_with_parameters(scenario)
    named = ego or []
    scenario = _with_options(scenario, named[0] if len(named) == 1 else None, seed, step_length, profile, delays, until)
    scenario = replace(scenario, until_end=until_end, sumo_options=tuple(context.obj or ()))
    several = asked_for(scenario, named, ego_type or [], ego_probability)
    if several:
        return run_several(scenario, several, out, overwrite, quiet)
    recorder = Recorder(out, overwrite=overwrite) if out else None
    result = _drive(scenario, recorder, quiet)
    _show(result, quiet)
    if recorder:
        with figures_kept(quiet, lambda: _show(result, False)):
            recorder.write(result)
    return result.exit_code


def _start_with_parameters(scenario: Scenario) -> None:
    """Start this program again, in place of this process, if the scenario asks for other parameters than it started with."""
    from sumo_reactive.driver.overrides import VARIABLE, overrides
    from sumo_reactive.lab.scenario import parameters_missing

    if parameters_missing(scenario):
        os.environ[VARIABLE] = json.dumps({**scenario.parameters, **overrides()})
        sys.stdout.flush()
        os.execv(sys.executable, [sys.executable, "-m", "sumo_reactive", *sys.argv[1:]])


def _with_options(
    scenario: Scenario,
    ego: str | None,
    seed: int | None,
    step_length: float | None,
    profile: ProfileName | None,
    delays: DelaysName | None,
    until: float | None,
) -> Scenario:
    """Return the scenario with what the command line says in place of what the file says."""
    from sumo_reactive.driver.controller import Profile
    from sumo_reactive.driver.pilot.schedule import Delays

    return replace(
        scenario,
        ego=scenario.ego if ego is None else ego,
        seed=scenario.seed if seed is None else seed,
        step_length_s=scenario.step_length_s if step_length is None else step_length,
        profile=scenario.profile if profile is None else Profile(profile.value),
        delays=scenario.delays if delays is None else Delays(delays.value),
        until_s=scenario.until_s if until is None else until,
    )


def _drive(scenario: Scenario, recorder: Recorder | None, quiet: bool) -> TrialResult:
    from sumo_reactive.lab.simulation import run_trial
    from sumo_reactive.sumo.crash import crashes_told

    note_compiling()
    with progress_shown(quiet) as progress, crashes_told():
        if recorder is None:
            return run_trial(scenario, progress=progress)
        return run_trial(scenario, observer=recorder.see, progress=progress, survey=recorder.survey)


def _show(result: TrialResult, quiet: bool) -> None:
    from sumo_reactive.lab.result import rows_of

    if quiet:
        typer.echo(f"{result.ego}: {result.verdict}")
        return
    rows = rows_of(result)
    if not sys.stdout.isatty():
        wide = max(len(label) for label, _ in rows)
        typer.echo("\n".join(f"{label:<{wide}}  {text}" for label, text in rows))
        return
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    table = Table(title=Text(result.scenario), show_header=False)
    for label, text in rows:
        table.add_row(Text(label), Text(text, style="bold" if label == "verdict" else ""))
    Console().print(table)
