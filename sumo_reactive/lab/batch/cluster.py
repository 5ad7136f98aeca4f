"""Workers that a dask scheduler has, on whatever machines."""

from __future__ import annotations

import contextlib
import logging
import uuid
from collections.abc import Iterator, Sequence
from concurrent.futures import CancelledError
from contextlib import contextmanager
from typing import Any

import dask
from distributed import Client, Future, KilledWorker, as_completed

from sumo_reactive.errors import ClusterError, ReactiveError
from sumo_reactive.lab.batch.engine import Order, Report, run_order_apart, stop_batch
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


class Cluster:
    """Workers that take orders; `batch` names this use of them."""

    def __init__(self, client: Client) -> None:
        self._client = client
        self.batch = uuid.uuid4().hex

    @property
    def workers(self) -> int:
        """How many trials run at the same time."""
        threads: dict[str, int] = self._client.nthreads()
        return sum(threads.values())

    def reports(self, orders: Sequence[Order]) -> Iterator[tuple[int, Report]]:
        """Yield the number of an order and what became of it, as they come in; raise ClusterError if the cluster is lost."""
        futures = self._client.map(run_order_apart, list(orders), key=[f"{self.batch}-{k}" for k in range(len(orders))])
        numbers = {future.key: k for k, future in enumerate(futures)}
        waiting = as_completed(futures, raise_errors=False)
        futures.clear()
        try:
            for future in waiting:
                number = numbers[future.key]
                yield number, self._report(future, orders[number])
        except (OSError, TimeoutError, CancelledError) as error:
            raise ClusterError(_LOST) from error

    def stop(self) -> None:
        """End the trials of this batch wherever they run."""
        with contextlib.suppress(Exception):
            self._client.run(stop_batch, self.batch, on_error="ignore")

    def _report(self, future: Future[Any], order: Order) -> Report:
        if future.status == "finished":
            report: Report = future.result()
            return report
        if future.status != "error":
            raise ClusterError(_LOST)
        error = future.exception()
        if isinstance(error, KilledWorker):
            reason = "every worker that ran it died"
            return Report(Outcome(order.task, Ending.CRASHED, reason=reason), dask.config.get(_ALLOWED) + 1)
        if isinstance(error, ReactiveError):
            raise error
        raise ClusterError(f"a worker cannot run this package: {type(error).__name__}: {error}") from error


@contextmanager
def cluster(scheduler: str) -> Iterator[Cluster]:
    """Give the workers of a scheduler that runs at an address; their trials end with it. Raises ClusterError."""
    for name in ("distributed", *(one for one in logging.root.manager.loggerDict if one.startswith("distributed."))):
        logging.getLogger(name).setLevel(logging.CRITICAL)
    with dask.config.set(_QUIET), _reached(scheduler) as client:
        found = Cluster(client)
        try:
            yield found
        finally:
            found.stop()


def _reached(scheduler: str) -> Client:
    try:
        return Client(scheduler, timeout=SCHEDULER_PATIENCE_S)
    except (OSError, ValueError, TypeError, RuntimeError, TimeoutError) as error:
        raise ClusterError(f"no scheduler at '{scheduler}': {' '.join(str(error).split())}") from error
