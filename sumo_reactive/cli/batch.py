"""`sumo-reactive batch`: an experiment's trials, on this machine or a cluster, into a store."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from sumo_reactive.cli.app import app, note_compiling

if TYPE_CHECKING:
    from sumo_reactive.lab.batch.experiment import Experiment
    from sumo_reactive.lab.batch.trials import Trial


@app.command()
def batch(
    file: Annotated[Path, typer.Argument(metavar="EXPERIMENT.toml", help="the experiment file")],
    workers: Annotated[int | None, typer.Option(min=1, help="processes on this machine; else one a core")] = None,
    scheduler: Annotated[str | None, typer.Option(metavar="ADDRESS", help="a dask scheduler that runs already")] = None,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="list the trials and run none")] = False,
    retry_failed: Annotated[bool, typer.Option("--retry-failed", help="run trials again that came to no result")] = False,
) -> int:
    """Run the trials of an experiment that its store does not hold yet; stopped at any time, it goes on where it was."""
    from sumo_reactive.lab.batch.experiment import load_experiment

    experiment = load_experiment(file)
    if dry_run:
        return _list(experiment)
    return _run(experiment, workers or len(os.sched_getaffinity(0)), scheduler, retry_failed)


def _list(experiment: Experiment) -> int:
    from sumo_reactive.lab.batch.engine import scouted
    from sumo_reactive.lab.batch.trials import trials_of

    trials = trials_of(experiment, lambda scenario: scouted(experiment, scenario, None))
    for trial in trials:
        typer.echo(f"{trial.key[:12]}  {trial}")
    typer.echo(f"{len(trials)} trials")
    return 0


def _run(experiment: Experiment, workers: int, scheduler: str | None, retry_failed: bool) -> int:
    from sumo_reactive.cli.batch_progress import shown
    from sumo_reactive.lab.batch.engine import run_batch, scouted
    from sumo_reactive.lab.batch.store import Store
    from sumo_reactive.lab.batch.trials import trials_of

    with Store(experiment.store) as store:
        trials = trials_of(experiment, lambda scenario: scouted(experiment, scenario, store))
        finished = store.plan(trials, experiment.keys.metrics, forget_failed=retry_failed)
        left = [trial for trial in trials if trial.key not in finished]
        typer.echo(_intent(experiment, trials, left))
        note_compiling()
        with shown(len(left)) as progress:
            run_batch(experiment, left, store, workers, scheduler, progress)
        failed = store.without_result()
    return _conclude(experiment, trials, failed)


def _intent(experiment: Experiment, trials: list[Trial], left: list[Trial]) -> str:
    there = f", {len(trials) - len(left)} of them in {experiment.store} already" if len(left) < len(trials) else ""
    return f"{len(trials)} trials{there}"


def _conclude(experiment: Experiment, trials: list[Trial], failed: list[tuple[str, str, str]]) -> int:
    labels = {trial.key: str(trial) for trial in trials}
    for key, reason, replay in failed:
        typer.echo(f"no result: {labels[key]}: {reason}\n  {replay}")
    there = len(trials) - len(failed)
    typer.echo(f"{there} of {len(trials)} trials have a result: sumo-reactive results {experiment.store}")
    return 1 if failed else 0

