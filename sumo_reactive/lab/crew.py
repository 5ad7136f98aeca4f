"""The other processes of a simulation: how they are started, what they hand over, and how they end."""

from __future__ import annotations

import contextlib
import multiprocessing
import pickle
import signal
import sys
from collections.abc import Callable, Sequence
from multiprocessing.connection import Connection
from types import TracebackType
from typing import Any, NamedTuple

from sumo_reactive.errors import ScenarioError, SimulationError
from sumo_reactive.lab.peers import ALONE, Failure, Hub, Peers, Spoke, raise_failure, spoke_told, tell
from sumo_reactive.lab.result import TrialResult
from sumo_reactive.sumo.muting import mute_descriptor

_ENDS_S = 10.0
"""A process that does not end by itself within this time is ended."""


class Part(NamedTuple):
    """What the egos of one process have come to (`Simulation`), and how many steps they have driven together."""

    results: list[TrialResult]
    refused: list[tuple[str, str]]
    cut_short: set[str]
    placed: set[str]
    ego_steps: int


Shelve = Callable[[Sequence[TrialResult]], None]
"""Keeps what has been recorded of these trips."""

Work = Callable[[Peers, Any], tuple[Part, Shelve | None]]
"""What another process does: a function of this package, which is told which of the processes it is, and an order."""


class Crew:
    """Context manager: so many other processes, which `work` on an order. `hub` is what the first process agrees by."""

    def __init__(self, others: int, work: Work, order: object) -> None:
        self._others, self._work, self._order = others, work, order
        self._processes: list[Any] = []
        self._spokes: list[Connection] = []

    def __enter__(self) -> Crew:
        if self._others and sys.platform != "linux":
            raise ScenarioError("several processes drive the egos of one simulation on Linux alone")
        begin = multiprocessing.get_context("spawn")
        for index in range(1, self._others + 1):
            here, there = begin.Pipe()
            asked = there, index, self._others + 1, self._work, self._order
            process = begin.Process(target=_serve, args=asked, daemon=True)
            process.start()
            there.close()
            self._processes.append(process)
            self._spokes.append(here)
        return self

    @property
    def hub(self) -> Peers:
        """By what the first process agrees with the others."""
        return Hub(self._spokes) if self._spokes else ALONE

    def parts(self) -> list[Part]:
        """Return what the others have come to. Raises what one has raised, and SimulationError if one is gone."""
        return [self._answer(spoke) for spoke in self._spokes]

    def shelve(self, results: Sequence[TrialResult]) -> None:
        """Have the others keep what they have recorded of these trips, as far as it was theirs."""
        for spoke in self._spokes:
            tell(spoke, results)
        for spoke in self._spokes:
            self._answer(spoke)

    def _answer(self, spoke: Connection) -> Any:
        found = pickle.loads(spoke_told(spoke))
        raise_failure([found])
        return found

    def __exit__(self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None) -> None:
        for spoke in self._spokes:
            spoke.close()
        for process in self._processes:
            process.join(_ENDS_S if kind is None else 0.0)
            if process.is_alive():
                process.terminate()
                process.join()


def _serve(connection: Connection, index: int, number: int, work: Work, order: object) -> None:
    """Work in another process, silently; it ends as soon as the first one is gone."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the first process ends the others
    for descriptor in (1, 2):
        mute_descriptor(descriptor)
    try:
        part, shelve = work(Spoke(connection, index, number), order)
        connection.send(part)
        results = connection.recv()
        if shelve is not None:
            shelve(results)
        connection.send(None)
    except (EOFError, BrokenPipeError, ConnectionResetError):
        return
    except Exception as error:
        with contextlib.suppress(OSError):
            connection.send(Failure(_as_told(error)))


def _as_told(error: Exception) -> Exception:
    """Return an error as another process can raise it."""
    try:
        found = pickle.loads(pickle.dumps(error))
    except Exception:  # whatever it holds
        found = None
    return found if isinstance(found, type(error)) else SimulationError(f"{type(error).__name__}: {error}")
