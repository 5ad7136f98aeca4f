"""Routes that pass a place twice: SUMO maps a moved vehicle to any pass, so it gets to know only the present one."""

from __future__ import annotations

import contextlib
from collections.abc import Callable

import libsumo


class RouteWindow:
    """Keeps SUMO's route of the ego free of edges and junctions that occur twice."""

    def __init__(self, ego_id: str, edges: tuple[str, ...], end_of: Callable[[str], str], number: int = 1) -> None:
        """`number`: which route of the ego's this is, for SUMO keeps the names of all."""
        self._ego_id = ego_id
        self._number = number
        self._edges = edges
        self._ends = tuple(end_of(edge) for edge in edges)
        self._needed = len(set(edges)) < len(edges) or len(set(self._ends)) < len(self._ends)
        self._index = -1
        self._added: set[str] = set()

    def follow(self, index: int) -> None:
        """Show SUMO the route from edge `index` on, up to where it would come to the same place again.

        SUMO takes a route only on one of its edges; where roads are shorter than a step or the car, it may still count the
        ego on the one before. Then the next step shows it.
        """
        if not self._needed or index == self._index or libsumo.vehicle.getRoadID(self._ego_id) != self._edges[index]:
            return
        last = index + 1
        while last < len(self._edges) and not self._returns(index, last):
            last += 1
        name = f"reactive.route.{self._ego_id}.{self._number}.{index}"
        if name not in self._added:
            libsumo.route.add(name, self._edges[index:last])
            self._added.add(name)
        with contextlib.suppress(libsumo.TraCIException):
            libsumo.vehicle.setRouteID(self._ego_id, name)
            self._index = index

    def _returns(self, first: int, last: int) -> bool:
        """Whether edge `last` or its end has been passed since edge `first`."""
        return self._edges[last] in self._edges[first:last] or self._ends[last] in self._ends[first:last]
