"""What a worker does: it hands a task to a process of its own, again after a crash, and reports."""

from __future__ import annotations

import os
from threading import Lock
from typing import NamedTuple

from sumo_reactive.driver.overrides import VARIABLE
from sumo_reactive.errors import ClusterError
from sumo_reactive.lab.process.runner import Runner
from sumo_reactive.lab.process.task import Ending, Outcome, Task


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
    from sumo_reactive.lab.batch.trial_key import release

    if (here := release()["sources"]) != order.sources:
        raise ClusterError(f"a worker has sumo_reactive with sources {here}, this process {order.sources}: install the same")
    os.environ.pop(VARIABLE, None)  # the task names every parameter that counts
    return run_order(order)


def stop_batch(batch: str) -> None:
    """End every process that runs a trial of a batch, and begin no more."""
    with _lock:
        _stopped.add(batch)
        runners = [*_idle.pop(batch, []), *_busy.pop(batch, [])]
    for runner in runners:
        runner.close()


def _run(order: Order) -> Outcome:
    with _lock:
        if order.batch in _stopped:
            return Outcome(order.task, Ending.CRASHED, reason="the batch was stopped")
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
