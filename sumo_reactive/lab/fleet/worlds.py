"""One world for many egos: it grows with their routes, and is shared by all who come later."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from sumo_reactive.driver.world.road_graph import RoadGraph
from sumo_reactive.sumo.net_reader import NetFile


class Worlds:
    """Builds the world around routes like a `NetFile`, but gives one that it has built already where that holds a route.

    What is computed once for a world (conflicts, lanes to watch, foreseen ways) is then computed once for all egos.
    """

    def __init__(self, net: NetFile) -> None:
        self._net = net
        self._routes: list[tuple[str, ...]] = []
        self._held: set[tuple[str, ...]] = set()
        self._graph: RoadGraph | None = None

    def build(self, edges: Sequence[str]) -> RoadGraph:
        """Return a world that holds a route of normal edges; raise NetworkError for an unknown edge."""
        parts = {(edges[-1],), *pairwise(edges)}
        if self._graph is None or not parts <= self._held:
            graph = self._net.build(*self._routes, edges)
            self._routes.append(tuple(edges))
            self._held |= parts | {(edge,) for edge in edges}
            self._graph = graph
        return self._graph

    def end_of(self, edge_id: str) -> str:
        """Return the junction that a normal edge leads to."""
        return self._net.end_of(edge_id)
