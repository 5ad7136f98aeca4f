"""What SUMO is told for its next step: by all egos from what they have seen at the same moment, carried out in their order.

An order is a function of this package and plain values: whoever has the same simulation in another process can carry it out
there, too.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import libsumo


class Order(NamedTuple):
    """A function that tells SUMO something, and its values; one that `may_fail` is without effect if SUMO refuses it."""

    function: Callable[..., None]
    values: tuple[Any, ...]
    may_fail: bool = False


class Tell:
    """Carries out what it is told at once."""

    def __call__(self, function: Callable[..., None], *values: Any, failed: Callable[[], None] | None = None) -> None:
        """Have SUMO told something; where it may refuse that, `failed` is called then."""
        _carry_out(Order(function, values, failed is not None), failed)


AT_ONCE = Tell()


class Orders(Tell):
    """Keeps what it is told until all of it is carried out."""

    def __init__(self) -> None:
        self._kept: list[tuple[Order, Callable[[], None] | None]] = []

    def __call__(self, function: Callable[..., None], *values: Any, failed: Callable[[], None] | None = None) -> None:
        """Keep an order."""
        self._kept.append((Order(function, values, failed is not None), failed))

    def carry_out(self) -> None:
        """Tell SUMO all that is kept, in the order in which it came."""
        kept, self._kept = self._kept, []
        for order, failed in kept:
            _carry_out(order, failed)


def _carry_out(order: Order, failed: Callable[[], None] | None) -> None:
    try:
        order.function(*order.values)
    except libsumo.TraCIException:
        if not order.may_fail:
            raise
        if failed is not None:
            failed()


def nothing() -> None:
    """What there is to do where SUMO refuses an order, and it does not matter."""
