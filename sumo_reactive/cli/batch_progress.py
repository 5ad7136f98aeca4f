"""How a batch comes on, as a live table on a terminal, as lines elsewhere."""

from __future__ import annotations

import sys
import time as clock
from collections import deque
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

import typer
from rich.console import Console, Group
from rich.live import Live
from rich.progress_bar import ProgressBar
from rich.table import Table
from rich.text import Text

if TYPE_CHECKING:
    from sumo_reactive.lab.batch.engine import Report
    from sumo_reactive.lab.batch.trials import Trial

SHOWN = 8
"""So many of the last trials without a result are shown."""


class BatchProgress:
    """Counts what has ended, and how fast."""

    def __init__(self, number: int) -> None:
        self._number = number
        self._ended = self._failed = self._workers = 0
        self._began = clock.monotonic()
        self._failures: deque[tuple[str, str]] = deque(maxlen=SHOWN)

    def started(self, workers: int) -> None:
        """Workers are there: the clock starts."""
        self._workers, self._began = workers, clock.monotonic()

    def ended(self, trial: Trial, report: Report) -> None:
        """Count a trial."""
        self._ended += 1
        if report.outcome.result is None:
            self._failed += 1
            self._failures.append((str(trial), f"{report.outcome.ending.value}: {report.outcome.reason}"))

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
        failures = Table("without a result", "why", box=None, show_header=bool(self._failures))
        for label, reason in self._failures:
            failures.add_row(Text(label), Text(reason))
        return Group(ProgressBar(self._number, self._ended, width=60), Text(self.line), failures)


class _Lines(BatchProgress):
    """The same as lines, one a trial."""

    def ended(self, trial: Trial, report: Report) -> None:
        super().ended(trial, report)
        outcome = report.outcome
        became = outcome.result.verdict if outcome.result else f"{outcome.ending.value}: {outcome.reason}"
        typer.echo(f"{self.line}: {trial}: {became}")


@contextmanager
def shown(number: int) -> Iterator[BatchProgress]:
    """Give what counts, and show it."""
    if not sys.stdout.isatty():
        yield _Lines(number)
        return
    progress = BatchProgress(number)
    with Live(progress, console=Console(), refresh_per_second=4):
        yield progress


def _duration(seconds: float) -> str:
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    minutes, rest = divmod(whole, 60)
    return f"{minutes} min {rest:02d} s" if minutes < 60 else f"{minutes // 60} h {minutes % 60:02d} min"
