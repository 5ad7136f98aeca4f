"""Worlds that several egos share, and how they are kept while egos drive."""

from __future__ import annotations

import contextlib
import gc
from collections.abc import Iterator, Sequence
from itertools import pairwise
from weakref import WeakValueDictionary

from sumo_reactive.driver.world.road_graph import RoadGraph
from sumo_reactive.sumo.net_reader import NetFile

SELDOM = 100_000
"""Objects made and not freed until rubbish is looked for while egos drive."""


class Worlds:
    """Builds the world around a route like a `NetFile`, but gives one in which somebody drives already where that holds it.

    What is computed once for a world (conflicts, lanes to watch, foreseen ways) is then computed once for them.
    """

    def __init__(self, net: NetFile) -> None:
        self._net = net
        self._driven: WeakValueDictionary[frozenset[tuple[str, ...]], RoadGraph] = WeakValueDictionary()

    def build(self, edges: Sequence[str]) -> RoadGraph:
        """Return a world that holds a route of normal edges; raise NetworkError for an unknown edge."""
        parts = {(edges[-1],), *pairwise(edges)}
        for held, graph in self._driven.items():
            if parts <= held:
                return graph
        graph = self._net.build(edges)
        self._driven[frozenset(parts | {(edge,) for edge in edges})] = graph
        return graph

    def end_of(self, edge_id: str) -> str:
        """Return the junction that a normal edge leads to."""
        return self._net.end_of(edge_id)


@contextlib.contextmanager
def world_kept() -> Iterator[None]:
    """Keep what has been built out of garbage collection, which would cost tens of milliseconds now and then.

    Steps make no cycles, so that hardly anything is left to collect: it is looked for seldom.
    """
    before = gc.get_threshold()
    gc.freeze()
    gc.set_threshold(SELDOM, *before[1:])
    try:
        yield
    finally:
        gc.set_threshold(*before)
        gc.unfreeze()
