"""`sumo-reactive run` with several egos at once."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from sumo_reactive.cli.app import figures_kept, note_compiling, progress_shown

if TYPE_CHECKING:
    from sumo_reactive.lab.egos import EgoRule
    from sumo_reactive.lab.result import FleetResult
    from sumo_reactive.lab.scenario import Scenario

SHOWN = 20
"""Egos that are listed at most, those with a fault if there are any; all are in the record."""

PLAIN_WIDTH = 120
"""Columns of the list where no terminal says how many there are."""


def asked_for(
    scenario: Scenario, ids: Sequence[str], types: Sequence[str], probability: float | None
) -> EgoRule | None:
    """Return the rule if several egos are asked for, on the command line or by the equipment of vehicles; else None."""
    from sumo_reactive.lab.egos import EgoRule
    from sumo_reactive.sumo.config import read_config
    from sumo_reactive.sumo.devices import Equipment

    if len(ids) > 1 or types or probability is not None:
        return EgoRule(tuple(ids), tuple(types), probability or 0.0)
    if not ids and scenario.ego is None and Equipment(read_config(scenario.config)).is_named:
        return EgoRule()
    return None


def run_several(scenario: Scenario, rule: EgoRule, out: Path | None, overwrite: bool, quiet: bool) -> int:
    """Drive every vehicle that the rule chooses; return the exit code."""
    from sumo_reactive.lab.recorder import FleetRecorder
    from sumo_reactive.lab.simulation import run_fleet
    from sumo_reactive.sumo.crash import crashes_told

    recorder = FleetRecorder(out, overwrite=overwrite) if out else None
    note_compiling()
    with progress_shown(quiet) as progress, crashes_told():
        if recorder is None:
            fleet = run_fleet(scenario, rule, progress=progress)
        else:
            fleet = run_fleet(scenario, rule, observer=recorder.see, progress=progress, survey=recorder.survey)
    _show(fleet, quiet)
    if recorder:
        with figures_kept(quiet, lambda: _show(fleet, False)):
            recorder.write(fleet)
    return fleet.exit_code


def _show(fleet: FleetResult, quiet: bool) -> None:
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
    if quiet:
        return
    table = Table("ego", "departed (s)", METRICS["duration_s"].title, METRICS["time_loss_s"].title, "verdict", box=None)
    for result in (fleet.faulty or fleet.results)[:SHOWN]:
        is_cut_short = result.ego in fleet.on_their_way and result not in fleet.faulty
        verdict = "on its way" if is_cut_short else result.verdict
        figures = (f"{figure:.1f}" for figure in (result.departure_s, result.duration_s, result.time_loss_s))
        table.add_row(Text(result.ego), *figures, Text(verdict))
    Console(highlight=False, width=None if sys.stdout.isatty() else PLAIN_WIDTH).print(table)
    for label, text in changed_rows(fleet.overrides, fleet.recounts):
        typer.echo(f"{label}  {text}")
    typer.echo(f"driver {fleet.step_us:.0f} µs an ego and step; {fleet.wall_s:.1f} s in all")
