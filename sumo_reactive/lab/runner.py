"""Trials in child processes: a crash, an endless run or a leak ends one trial, never the caller."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import tempfile
import time as clock
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from multiprocessing import Pipe
from pathlib import Path
from queue import SimpleQueue
from types import TracebackType
from typing import Any

import psutil

import sumo_reactive.driver.kernel_folder  # noqa: F401  # made, and named to children, before the first one starts
from sumo_reactive.lab.task import Ending, Outcome, Task
from sumo_reactive.lab.trial_process import new_scratch, remove

MAX_TRIALS = 100
"""Trials that one process runs before another takes its place: its start (1 s) is then 10 ms a trial."""

MAX_MEMORY_MB = 4096.0
"""MB; a process that holds more ends its trial as crashed: ten times what a city network takes."""

RECYCLE_MEMORY_MB = 1536.0
"""MB; a process that holds more after a trial is replaced before the next."""

__all__ = ["Ending", "Outcome", "Runner", "Task", "close_all", "run_all"]

Answer = tuple[Ending, Any, float]
"""How a call ended; its value, or in one line why there is none; wall-clock time, s."""

_RUN = "sumo_reactive.lab.simulation:run_observed"
_RUN_SHARE = "sumo_reactive.lab.penetration:run_share"
_LOOK_S = 0.5
_FAREWELL_S = 1.0
_ONE_THREAD = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")


class Runner:
    """One process that imports once and runs one task after another; a context manager, for one thread at a time.

    The process is replaced when it crashed, outran its limit, has run MAX_TRIALS tasks, or holds too much memory. A
    process whose caller dies ends by itself.

    Temporary files of the tasks go to `scratch`, which the caller removes; else to a folder that ends with the process.
    """

    def __init__(self, scratch: Path | None = None) -> None:
        self._scratch = scratch
        self._child: _Child | None = None
        self._closed = False

    def __enter__(self) -> Runner:
        return self

    def __exit__(self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    def run(self, task: Task, wall_limit_s: float) -> Outcome:
        """Run a task; whatever happens to it is told by the outcome. The limit (s) begins when the process is ready."""
        ending, value, wall_s = self.call(_RUN if task.scenario.egos is None else _RUN_SHARE, task, wall_limit_s)
        if ending is not Ending.DONE:
            return Outcome(task=task, ending=ending, reason=value, wall_s=wall_s)
        return Outcome(task=task, ending=ending, **value, wall_s=wall_s)

    def call(self, function: str, argument: object, wall_limit_s: float) -> Answer:
        """Call a function ("module:name") in the process; return how that ended, its value or why not, wall-clock s."""
        child = self._ready()
        answer = child.call((function, argument), wall_limit_s)
        if answer[0] in (Ending.CRASHED, Ending.TIMEOUT) or child.is_worn_out():
            child.close()
            self._child = None
        return answer

    def close(self) -> None:
        """End the process, also one that is in the middle of a trial; `run` in another thread then tells of a crash."""
        self._closed = True
        if self._child is not None:
            self._child.close()

    def _ready(self) -> _Child:
        if self._child is None:
            self._child = _Child(self._scratch)
        if self._closed:
            self._child.close()
        return self._child


class _Child:
    """A running process, and what it answers."""

    def __init__(self, scratch: Path | None) -> None:
        self._trials = 0
        self._ready = False
        self._log = tempfile.TemporaryFile()  # noqa: SIM115 closed with the process
        self._own_scratch = None if scratch else new_scratch()
        taken, self._orders = Pipe(duplex=False)
        self._answers, given = Pipe(duplex=False)
        with taken, given:
            ends = taken.fileno(), given.fileno()
            told = map(str, (scratch or self._own_scratch, *ends))
            self._process = subprocess.Popen(
                [sys.executable, "-m", "sumo_reactive.lab.trial_process", *told],
                stdin=subprocess.DEVNULL, stdout=self._log, stderr=self._log, pass_fds=ends,
                env=dict.fromkeys(_ONE_THREAD, "1") | dict(os.environ),
            )  # fmt: skip

    def call(self, order: object, wall_limit_s: float) -> Answer:
        """Hand over an order and wait for its answer."""
        began = took = 0.0
        try:
            if not self._ready:
                self._ready = self._answers.recv()
            began = clock.monotonic()
            self._orders.send(order)
            self._trials += 1
            while not self._answers.poll(max(0.0, min(_LOOK_S, wall_limit_s - took))):
                if took >= wall_limit_s:
                    return Ending.TIMEOUT, f"not done after {wall_limit_s:g} s of wall-clock time", took
                if (held := self._memory_mb()) > MAX_MEMORY_MB:
                    return Ending.CRASHED, f"the process held {held:.0f} MB, more than {MAX_MEMORY_MB:.0f}", took
                took = clock.monotonic() - began
            name, value, wall_s = self._answers.recv()
        except (EOFError, OSError):
            return Ending.CRASHED, self._death(), clock.monotonic() - began if began else 0.0
        return Ending[name], value, wall_s

    def is_worn_out(self) -> bool:
        """Whether another process should run the next task."""
        return self._trials >= MAX_TRIALS or self._memory_mb() > RECYCLE_MEMORY_MB

    def close(self) -> None:
        """End the process, and remove what it left behind, also if an interrupt comes meanwhile.

        It is first let go, so that it cleans up by itself even if this process is killed meanwhile.
        """
        self._orders.close()
        try:
            with contextlib.suppress(subprocess.TimeoutExpired):
                self._process.wait(_FAREWELL_S)
        finally:
            self._process.kill()
            self._process.wait()
            if self._own_scratch:
                remove(self._own_scratch)

    def _memory_mb(self) -> float:
        try:
            return float(psutil.Process(self._process.pid).memory_info().rss) / 1e6
        except psutil.Error:
            return 0.0

    def _death(self) -> str:
        from sumo_reactive.sumo.crash import DEADLY  # brings the compiler along

        code = self._process.wait()
        how = f"the process ended with code {code}"
        if code < 0:
            name = signal.Signals(-code).name
            how = f"SUMO died of {name}" if -code in DEADLY else f"the process was killed by {name}"
        self._log.seek(0)
        said = self._log.read().decode(errors="replace").strip().splitlines()
        return how + (f": {said[-1].strip()}" if said else "")


def run_all(
    tasks: Sequence[Task],
    jobs: int,
    wall_limit_s: float,
    progress: Callable[[Outcome], None] | None = None,
    scratch: Path | None = None,
) -> Iterator[Outcome]:
    """Run the tasks in `jobs` processes and yield their outcomes in the order of the tasks; `scratch` as for a `Runner`.

    `progress` gets each outcome as soon as it is there, from the thread that waited for it.
    """
    idle: SimpleQueue[Runner] = SimpleQueue()
    runners = [Runner(scratch) for _ in range(max(1, min(jobs, len(tasks))))]
    for runner in runners:
        idle.put(runner)

    def one(task: Task) -> Outcome:
        runner = idle.get()
        try:
            outcome = runner.run(task, wall_limit_s)
        finally:
            idle.put(runner)
        if progress is not None:
            progress(outcome)
        return outcome

    threads = ThreadPoolExecutor(len(runners))
    try:
        for future in [threads.submit(one, task) for task in tasks]:
            yield future.result()
    finally:
        threads.shutdown(wait=False, cancel_futures=True)
        close_all(runners)
        threads.shutdown()


def close_all(runners: Sequence[Runner]) -> None:
    """Close each of them, also if an interrupt comes meanwhile."""
    with contextlib.ExitStack() as closing:
        for runner in reversed(runners):
            closing.callback(runner.close)
