"""What SUMO is told for its next step: by all egos from what they have seen at the same moment, carried out in their order.

An order is a function of this package and plain values: whoever has the same simulation in another process carries it out
there, too.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from operator import attrgetter
from typing import Any, NamedTuple

import libsumo


class SumoOrder(NamedTuple):
    """A function that tells SUMO something, and its values; one that `may_fail` is without effect if SUMO refuses it.

    `turn` says when it comes, among those of all egos; what `is_done` has been carried out already where it comes from.
    """

    turn: tuple[int, int]
    function: Callable[..., None]
    values: tuple[Any, ...]
    may_fail: bool = False
    is_done: bool = False
    failed: Callable[[], None] | None = None


class Tell:
    """Carries out what it is told at once."""

    def __call__(self, function: Callable[..., None], *values: Any, failed: Callable[[], None] | None = None) -> None:
        """Have SUMO told something; where it may refuse that, `failed` is called then."""
        _carry_out(SumoOrder((0, 0), function, values, failed is not None, failed=failed))

    def elsewhere(self, function: Callable[..., None], *values: Any) -> None:
        """Have what has been done here done in the same simulation elsewhere, too."""


AT_ONCE = Tell()


class SumoOrders(Tell):
    """Keeps what it is told until all of it is carried out."""

    def __init__(self) -> None:
        self._kept: list[SumoOrder] = []
        self._turn = (0, 0)

    def begin(self, phase: int, number: int) -> None:
        """From here on it is the turn of ego `number` in a phase of the step."""
        self._turn = phase, number

    def __call__(self, function: Callable[..., None], *values: Any, failed: Callable[[], None] | None = None) -> None:
        """Keep an order."""
        self._kept.append(SumoOrder(self._turn, function, values, failed is not None, failed=failed))

    def elsewhere(self, function: Callable[..., None], *values: Any) -> None:
        """Keep an order for others."""
        self._kept.append(SumoOrder(self._turn, function, values, is_done=True))

    def for_others(self) -> tuple[SumoOrder, ...]:
        """Return what is kept as others carry it out."""
        return tuple(order._replace(is_done=False, failed=None) for order in self._kept)

    def carry_out(self, others: Iterable[SumoOrder] = ()) -> None:
        """Tell SUMO all that is kept, and what comes from `others`, in the order of turns."""
        orders, self._kept = self._kept, []
        for order in sorted((*orders, *others), key=attrgetter("turn")):
            if not order.is_done:
                _carry_out(order)


def _carry_out(order: SumoOrder) -> None:
    try:
        order.function(*order.values)
    except libsumo.TraCIException:
        if not order.may_fail:
            raise
        if order.failed is not None:
            order.failed()


def nothing() -> None:
    """What there is to do where SUMO refuses an order, and it does not matter."""
