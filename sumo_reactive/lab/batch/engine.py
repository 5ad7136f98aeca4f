"""A batch: the trials that the store does not hold yet are run by workers, and each is stored as soon as it is there."""

from __future__ import annotations

import uuid
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import AbstractContextManager, contextmanager
from dataclasses import replace
from threading import Lock
from typing import NamedTuple, Protocol

from sumo_reactive.errors import ClusterError, ScenarioError
from sumo_reactive.lab.batch.experiment import Experiment
from sumo_reactive.lab.batch.store import Store
from sumo_reactive.lab.batch.trials import SCOUT, Departure, Trial, key_of_scouting, release
from sumo_reactive.lab.runner import Runner, close_all
from sumo_reactive.lab.scenario import Scenario
from sumo_reactive.lab.task import Ending, Outcome, Task


class Order(NamedTuple):
    """A task for a worker; `batch` names the batch that asks, `sources` the package's sources that it was planned with."""

    task: Task
    wall_limit_s: float
    retries: int
    batch: str
    sources: str


class Report(NamedTuple):
    """What became of an order, and after how many attempts."""

    outcome: Outcome
    attempts: int


_lock = Lock()
_idle: dict[str, list[Runner]] = {}
_busy: dict[str, list[Runner]] = {}
_stopped: set[str] = set()


def run_order(order: Order) -> Report:
    """Run an order."""
    attempts = 0
    while True:
        attempts += 1
        outcome = _run(order)
        again = outcome.ending in (Ending.CRASHED, Ending.TIMEOUT) and attempts <= order.retries
        if not again or order.batch in _stopped:
            return Report(outcome, attempts)


def run_order_apart(order: Order) -> Report:
    """Run an order of another process; raise ClusterError if this one has other sources than whoever gave it."""
    if (here := release()["sources"]) != order.sources:
        raise ClusterError(f"a worker has sumo_reactive with sources {here}, this process {order.sources}: install the same")
    return run_order(order)


def stop_batch(batch: str) -> None:
    """End every process that runs a trial of a batch, and begin no more."""
    with _lock:
        _stopped.add(batch)
        runners = [*_idle.pop(batch, []), *_busy.pop(batch, [])]
    close_all(runners)


def _run(order: Order) -> Outcome:
    with _lock:
        if order.batch in _stopped:
            return Outcome(task=order.task, ending=Ending.CRASHED, reason="the batch was stopped")
        idle = _idle.setdefault(order.batch, [])
        runner = idle.pop() if idle else Runner()
        _busy.setdefault(order.batch, []).append(runner)
    try:
        return runner.run(order.task, order.wall_limit_s)
    finally:
        with _lock:
            if order.batch not in _stopped:
                _busy[order.batch].remove(runner)
                _idle[order.batch].append(runner)


class Workers(NamedTuple):
    """Who runs trials, `number` at the same time, and tells the number of an order and what became of it as they come in.

    `batch` names this use of them.
    """

    batch: str
    number: int
    reports: Callable[[Sequence[Order]], Iterator[tuple[int, Report]]]


@contextmanager
def here(number: int) -> Iterator[Workers]:
    """Give so many workers; their trials end with it."""
    batch, threads = uuid.uuid4().hex, ThreadPoolExecutor(number)

    def reports(orders: Sequence[Order]) -> Iterator[tuple[int, Report]]:
        numbers = {threads.submit(run_order, order): k for k, order in enumerate(orders)}
        return ((numbers[future], future.result()) for future in as_completed(numbers))

    try:
        yield Workers(batch, number, reports)
    finally:
        threads.shutdown(wait=False, cancel_futures=True)
        stop_batch(batch)
        threads.shutdown()


class Watcher(Protocol):
    """Who looks on: how many trials are at work at once, and each that has ended."""

    def started(self, workers: int) -> None:
        """Workers are there."""

    def ended(self, trial: Trial, report: Report) -> None:
        """A trial has ended, and is stored."""


def scouted(experiment: Experiment, scenario: Scenario, store: Store | None) -> list[Departure]:
    """Return the trips of a scenario: from the store, or from one run of SUMO alone, which the store keeps."""
    key = key_of_scouting(scenario)
    known = store.departures(key) if store else []
    if known:
        return known
    with Runner() as runner:
        ending, found, _ = runner.call(SCOUT, scenario, experiment.keys.wall_limit_s)
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
        watcher.started(found.number)
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
