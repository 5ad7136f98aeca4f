"""Several processes with the same simulation, each of which drives some of the egos: before each step they agree."""

from __future__ import annotations

import pickle
from collections.abc import Iterable
from multiprocessing.connection import Connection
from typing import NamedTuple

from sumo_reactive.errors import SimulationError
from sumo_reactive.sumo.orders import SumoOrder

_GONE = "a process that drives a part of the egos has ended"


class PeerMessage(NamedTuple):
    """What a process tells the others before a step: the orders of its egos, how many of them are on their way, how many
    have ended or could not be taken over, and whether one has just left the road."""

    orders: tuple[SumoOrder, ...] = ()
    on_their_way: int = 0
    ended: int = 0
    has_left: bool = False


class Peers:
    """All processes of a simulation, of which this is `index`: here it is alone."""

    index, number = 0, 1

    def others(self, told: PeerMessage) -> list[PeerMessage]:
        """Tell the others; return what they tell."""
        return []


ALONE = Peers()


class Failure(NamedTuple):
    """What another process has failed of."""

    error: Exception


class Hub(Peers):
    """The first of the processes, which hands on what each of them tells; `spokes` lead to the others."""

    def __init__(self, spokes: list[Connection]) -> None:
        self._spokes, self.number = spokes, 1 + len(spokes)

    def others(self, told: PeerMessage) -> list[PeerMessage]:
        """Tell the others; return what they tell. Raises what one has raised, and SimulationError if one is gone."""
        parts = [pickle.dumps(told), *(spoke_told(spoke) for spoke in self._spokes)]
        found = [pickle.loads(part) for part in parts[1:]]
        raise_failure(found)
        for spoke in self._spokes:
            tell(spoke, parts)
        return found


class Spoke(Peers):
    """Another of the processes, with a connection to the first."""

    def __init__(self, connection: Connection, index: int, number: int) -> None:
        self._connection, self.index, self.number = connection, index, number

    def others(self, told: PeerMessage) -> list[PeerMessage]:
        """Tell the others; return what they tell. Raises EOFError if the first is gone."""
        self._connection.send_bytes(pickle.dumps(told))
        parts = self._connection.recv()
        return [pickle.loads(part) for k, part in enumerate(parts) if k != self.index]


def tell(spoke: Connection, what: object) -> None:
    """Tell another process something; raise SimulationError if it is gone."""
    try:
        spoke.send(what)
    except OSError as error:
        raise SimulationError(_GONE) from error


def spoke_told(spoke: Connection) -> bytes:
    """Return what another process tells; raise SimulationError if it is gone."""
    try:
        return spoke.recv_bytes()
    except (EOFError, OSError) as error:
        raise SimulationError(_GONE) from error


def raise_failure(told: Iterable[object]) -> None:
    """Raise what the first process that has failed has raised, if one has."""
    for one in told:
        if isinstance(one, Failure):
            raise one.error
