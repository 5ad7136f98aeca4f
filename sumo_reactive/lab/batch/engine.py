"""A batch: the trials that the store does not hold yet are run, and each is stored as soon as it is there."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager
from dataclasses import replace
from typing import Protocol

from sumo_reactive.errors import ClusterError, ScenarioError
from sumo_reactive.lab.batch.experiment_file import Experiment
from sumo_reactive.lab.batch.here import here
from sumo_reactive.lab.batch.scouting import SCOUT, Departure
from sumo_reactive.lab.batch.store import Store
from sumo_reactive.lab.batch.trial_key import key_of_scouting, release
from sumo_reactive.lab.batch.trials import Trial
from sumo_reactive.lab.batch.worker import Order, Report
from sumo_reactive.lab.process.runner import Runner
from sumo_reactive.lab.process.task import Ending
from sumo_reactive.lab.scenario import Scenario


class Watcher(Protocol):
    """Who looks on: how many trials are at work at once, and each that has ended."""

    def started(self, workers: int) -> None:
        """Workers are there."""

    def ended(self, trial: Trial, report: Report) -> None:
        """A trial has ended, and is stored."""


class Workers(Protocol):
    """Who runs trials; `batch` names this use of them."""

    batch: str

    @property
    def workers(self) -> int:
        """How many trials run at the same time."""

    def reports(self, orders: Sequence[Order]) -> Iterator[tuple[int, Report]]:
        """Yield the number of an order and what became of it, as they come in."""


def scouted(experiment: Experiment, scenario: Scenario, store: Store | None) -> list[Departure]:
    """Return the trips of a scenario: from the store, or from one run of SUMO alone, which the store keeps."""
    key = key_of_scouting(scenario)
    known = store.departures(key) if store else []
    if known:
        return known
    with Runner() as runner:
        ending, found, _ = runner.call(SCOUT, scenario, experiment.keys.wall_limit_s, {})
    if ending is not Ending.DONE:
        raise ScenarioError(f"{scenario.source}: no trips to draw from: {ending.value}: {found}")
    trips: list[Departure] = found
    if store:
        store.put_departures(key, trips)
    return trips


def run_batch(
    experiment: Experiment, trials: Sequence[Trial], store: Store, workers: int, scheduler: str | None, watcher: Watcher
) -> None:
    """Run the trials and store them one by one; raise ClusterError or StoreError if that cannot go on."""
    if not trials:
        return
    keys, sources = experiment.keys, release()["sources"]
    with here(min(workers, len(trials))) if scheduler is None else _cluster(scheduler) as found:
        watcher.started(found.workers)
        orders = [Order(trial.task, keys.wall_limit_s, keys.retries, found.batch, sources) for trial in trials]
        for number, report in found.reports(orders):
            trial, outcome = trials[number], report.outcome
            store.put(trial, replace(outcome, task=trial.task), report.attempts)
            watcher.ended(trial, report)


def _cluster(scheduler: str) -> AbstractContextManager[Workers]:
    try:
        from sumo_reactive.lab.batch.cluster import cluster
    except ModuleNotFoundError as error:
        raise ClusterError("--scheduler needs dask: pip install 'sumo-reactive[cluster]'") from error
    return cluster(scheduler)
