"""`sumo-reactive batch`: an experiment's trials, on this machine or a cluster, into a store; a live table on a terminal."""

from __future__ import annotations

import os
import sys
import time as clock
from collections import deque
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from sumo_reactive.cli.app import app, compile_first
from sumo_reactive.errors import ExitCode

if TYPE_CHECKING:
    from rich.console import Group

    from sumo_reactive.lab.batch.engine import Report
    from sumo_reactive.lab.batch.experiment import Experiment
    from sumo_reactive.lab.batch.trials import Trial

_FAILURES_SHOWN = 8
"""So many of the last trials without a result are shown."""


@app.command(epilog="Example: sumo-reactive batch EXPERIMENT.toml --workers 4")
def batch(
    file: Annotated[Path, typer.Argument(metavar="EXPERIMENT.toml", help="the experiment file")],
    workers: Annotated[
        int | None, typer.Option("--workers", "--jobs", "-j", min=1, help="processes on this machine; else one a core")
    ] = None,
    scheduler: Annotated[str | None, typer.Option(metavar="ADDRESS", help="a dask scheduler that runs already")] = None,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="list the trials and run none")] = False,
    retry_failed: Annotated[bool, typer.Option("--retry-failed", help="run trials again that came to no result")] = False,
) -> int:
    """Run the trials of an experiment that its store does not hold yet; stopped at any time, it goes on where it was."""
    from sumo_reactive.lab.batch.engine import run_batch, scouted
    from sumo_reactive.lab.batch.experiment import load_experiment
    from sumo_reactive.lab.batch.store import Store
    from sumo_reactive.lab.batch.trials import trials_of

    experiment = load_experiment(file)
    if dry_run:
        return _list(trials_of(experiment, lambda scenario: scouted(experiment, scenario, None)))
    with Store(experiment.store) as store:
        trials = trials_of(experiment, lambda scenario: scouted(experiment, scenario, store))
        finished = store.plan(trials, experiment.keys.metrics, forget_failed=retry_failed)
        left = [trial for trial in trials if trial.key not in finished]
        there = f", {len(trials) - len(left)} of them in {experiment.store} already" if len(left) < len(trials) else ""
        typer.echo(f"{len(trials)} trials{there}")
        compile_first()
        with _shown(len(left)) as progress:
            run_batch(experiment, left, store, workers or len(os.sched_getaffinity(0)), scheduler, progress)
        failed = store.without_result()
    return _conclude(experiment, trials, failed)


def _list(trials: list[Trial]) -> int:
    for trial in trials:
        typer.echo(f"{trial.key[:12]}  {trial}")
    typer.echo(f"{len(trials)} trials")
    return 0


def _conclude(experiment: Experiment, trials: list[Trial], failed: list[tuple[str, str, str]]) -> int:
    labels = {trial.key: str(trial) for trial in trials}
    for key, reason, replay in failed:
        typer.echo(f"no result: {labels[key]}: {reason}\n  {replay}")
    there = len(trials) - len(failed)
    typer.echo(f"{there} of {len(trials)} trials have a result: sumo-reactive results {experiment.store}")
    return ExitCode.WANTING if failed else ExitCode.DONE


class BatchProgress:
    """Counts what has ended of `number` trials, and how fast; tells a line a trial if it `speaks`."""

    def __init__(self, number: int, speaks: bool) -> None:
        self._number, self._speaks = number, speaks
        self._ended = self._failed = self._workers = 0
        self._began = clock.monotonic()
        self._failures: deque[tuple[str, str]] = deque(maxlen=_FAILURES_SHOWN)

    def started(self, workers: int) -> None:
        """Workers are there: the clock starts."""
        self._workers, self._began = workers, clock.monotonic()

    def ended(self, trial: Trial, report: Report) -> None:
        """Count a trial."""
        outcome = report.outcome
        self._ended += 1
        became = outcome.judged.verdict if outcome.judged else f"{outcome.ending.value}: {outcome.reason}"
        if outcome.judged is None:
            self._failed += 1
            self._failures.append((str(trial), became))
        if self._speaks:
            typer.echo(f"{self.line}: {trial}: {became}")

    @property
    def line(self) -> str:
        """Where the batch stands, in words."""
        if not self._workers:
            return f"0 of {self._number}, starting workers"
        took = clock.monotonic() - self._began
        rate = self._ended / took if took > 0.0 else 0.0
        left = f", about {_duration((self._number - self._ended) / rate)} left" if rate else ""
        return (
            f"{self._ended} of {self._number}, {60.0 * rate:.1f} a minute on {self._workers} workers{left},"
            f" {self._failed} without a result"
        )

    def __rich__(self) -> Group:
        from rich.console import Group
        from rich.progress_bar import ProgressBar
        from rich.table import Table
        from rich.text import Text

        failures = Table("without a result", "why", box=None, show_header=bool(self._failures))
        for label, reason in self._failures:
            failures.add_row(Text(label), Text(reason))
        return Group(ProgressBar(self._number, self._ended, width=60), Text(self.line), failures)


@contextmanager
def _shown(number: int) -> Iterator[BatchProgress]:
    """Give what counts, and show it."""
    progress = BatchProgress(number, speaks=not sys.stdout.isatty())
    if not sys.stdout.isatty():
        yield progress
        return
    from rich.console import Console
    from rich.live import Live

    with Live(progress, console=Console(), refresh_per_second=4):
        yield progress


def _duration(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    if minutes < 60:
        return f"{minutes} min {rest:02d} s" if minutes else f"{rest} s"
    return f"{minutes // 60} h {minutes % 60:02d} min"
