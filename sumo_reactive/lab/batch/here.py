"""Workers on this machine: threads of this process, each with a trial process at the end of a pipe, and no port open."""

from __future__ import annotations

import uuid
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import contextmanager

from sumo_reactive.lab.batch.worker import Order, Report, run_order, stop_batch


class Here:
    """So many trials at the same time; `batch` names this use of them."""

    def __init__(self, workers: int) -> None:
        self.workers = workers
        self.batch = uuid.uuid4().hex
        self._threads = ThreadPoolExecutor(workers)

    def reports(self, orders: Sequence[Order]) -> Iterator[tuple[int, Report]]:
        """Yield the number of an order and what became of it, as they come in."""
        numbers = {self._threads.submit(run_order, order): k for k, order in enumerate(orders)}
        for future in as_completed(numbers):
            yield numbers[future], future.result()

    def stop(self) -> None:
        """End the trials that run, and begin no more."""
        self._threads.shutdown(wait=False, cancel_futures=True)
        stop_batch(self.batch)
        self._threads.shutdown()


@contextmanager
def here(workers: int) -> Iterator[Here]:
    """Give so many workers; their trials end with it."""
    found = Here(workers)
    try:
        yield found
    finally:
        found.stop()
