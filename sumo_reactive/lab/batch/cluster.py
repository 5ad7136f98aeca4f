"""Workers that a dask scheduler has, on whatever machines."""

from __future__ import annotations

import contextlib
import logging
import uuid
from collections.abc import Iterator, Sequence
from concurrent.futures import CancelledError
from contextlib import contextmanager
from functools import partial
from typing import Any

import dask
from distributed import Client, Future, KilledWorker, as_completed

from sumo_reactive.errors import ClusterError, ReactiveError
from sumo_reactive.lab.batch.engine import Order, Report, Workers, run_order_apart, stop_batch
from sumo_reactive.lab.task import Ending, Outcome

SCHEDULER_PATIENCE_S = 10.0
"""s; a scheduler that has not answered until then is not there."""

_ALLOWED = "distributed.scheduler.allowed-failures"
_LOST = "the scheduler was lost; run the batch again, finished trials are kept"
_QUIET: dict[str, Any] = {
    "distributed.comm.timeouts.connect": f"{SCHEDULER_PATIENCE_S:g}s",
    "distributed.scheduler.worker-saturation": 1.0,
    "distributed.admin.system-monitor.interval": "10s",
}


@contextmanager
def cluster(scheduler: str) -> Iterator[Workers]:
    """Give the workers of a scheduler that runs at an address; their trials end with it. Raises ClusterError."""
    for name in ("distributed", *(one for one in logging.root.manager.loggerDict if one.startswith("distributed."))):
        logging.getLogger(name).setLevel(logging.CRITICAL)
    batch = uuid.uuid4().hex
    with dask.config.set(_QUIET), _reached(scheduler) as client:
        try:
            yield Workers(batch, sum(client.nthreads().values()), partial(_reports, client, batch))
        finally:
            with contextlib.suppress(Exception):
                client.run(stop_batch, batch, on_error="ignore")


def _reports(client: Client, batch: str, orders: Sequence[Order]) -> Iterator[tuple[int, Report]]:
    """Yield the number of an order and what became of it, as they come in; raise ClusterError if the cluster is lost."""
    futures = client.map(run_order_apart, list(orders), key=[f"{batch}-{k}" for k in range(len(orders))])
    numbers = {future.key: k for k, future in enumerate(futures)}
    waiting = as_completed(futures, raise_errors=False)
    futures.clear()
    try:
        for future in waiting:
            number = numbers[future.key]
            yield number, report_of(future, orders[number])
    except (OSError, TimeoutError, CancelledError) as error:
        raise ClusterError(_LOST) from error


def report_of(future: Future[Any], order: Order) -> Report:
    """Return what became of an order that has ended; raise ClusterError if no worker could run it."""
    if future.status == "finished":
        report: Report = future.result()
        return report
    if future.status != "error":
        raise ClusterError(_LOST)
    error = future.exception()
    if isinstance(error, KilledWorker):
        reason = "every worker that ran it died"
        return Report(Outcome(task=order.task, ending=Ending.CRASHED, reason=reason), dask.config.get(_ALLOWED) + 1)
    if isinstance(error, ReactiveError):
        raise error
    raise ClusterError(f"a worker cannot run this package: {type(error).__name__}: {error}") from error


def _reached(scheduler: str) -> Client:
    try:
        return Client(scheduler, timeout=SCHEDULER_PATIENCE_S)
    except (OSError, ValueError, TypeError, RuntimeError, TimeoutError) as error:
        raise ClusterError(f"no scheduler at '{scheduler}': {' '.join(str(error).split())}") from error
