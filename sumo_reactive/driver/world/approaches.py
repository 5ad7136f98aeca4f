"""The lanes on which vehicles come to a stop line: found backwards along the lanes of a network."""

from __future__ import annotations

import heapq
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Protocol


@dataclass(frozen=True, slots=True)
class Approach:
    """A lane (normal or internal) from which a vehicle can reach a connection's stop line.

    `distance` is the spine length from the lane's START to the stop line, m. `edges` are the normal edges still to drive,
    from the lane's own edge (from the next one, if the lane is internal) up to and including the edge behind the
    connection; a vehicle comes this way if its remaining route begins with them.
    """

    lane_id: str
    distance: float
    edges: tuple[str, ...]


class Upstream(Protocol):
    """What the search backwards along the lanes asks of a network."""

    def edge_of(self, lane_id: str) -> str:
        """Return the edge that a lane belongs to."""

    def ends_of(self, edge_id: str) -> tuple[str, str]:
        """Return the junctions where an edge starts and ends."""

    def spine_length(self, lane_id: str) -> float:
        """Return the length of a lane's spine, m."""

    def arrivals(self, lane_id: str) -> Iterable[tuple[str, Sequence[str]]]:
        """Yield (lane before the junction, internal lanes in driving order) of the connections into a lane."""

    def detours(self, lane_id: str, edge_id: str) -> Iterable[str]:
        """Yield the lanes beside `lane_id` that do not themselves lead to `edge_id`: who drives there must change lanes."""


def approaches_to(from_lane: str, to_edge: str, net: Upstream, horizon: float) -> tuple[Approach, ...]:
    """Return the approaches of the connection from `from_lane` to `to_edge`, nearest first.

    A lane belongs to them if its end is less than `horizon` m from the stop line. Ways that pass a junction twice before
    the stop line (turn around, drive round the block) are left out: no route does so, and they are many.
    """
    found: dict[tuple[str, tuple[str, ...]], float] = {}
    passed_first = frozenset(net.ends_of(net.edge_of(from_lane))[1:])
    queue: list[tuple[float, str, tuple[str, ...], frozenset[str]]]  # a lane's end, edges and junctions behind it
    queue = [(0.0, from_lane, (to_edge,), passed_first)]
    while queue:
        ahead, lane, onward, passed = heapq.heappop(queue)
        edge = net.edge_of(lane)
        start = net.ends_of(edge)[0]
        if start in passed:
            continue
        for beside in (lane, *net.detours(lane, onward[0])):
            key = (beside, (edge, *onward))
            distance = ahead + net.spine_length(beside)
            if found.get(key, math.inf) <= distance:
                continue
            found[key] = distance
            for reached, before in _upstream(beside, distance, key[1], net, horizon, found):
                heapq.heappush(queue, (reached, before, key[1], passed | {start}))
    ordered = sorted(found.items(), key=lambda item: item[1])
    return tuple(Approach(lane, distance, edges) for (lane, edges), distance in ordered)


def _upstream(
    lane: str, distance: float, edges: tuple[str, ...], net: Upstream, horizon: float,
    found: dict[tuple[str, tuple[str, ...]], float],
) -> Iterator[tuple[float, str]]:  # fmt: skip
    """Note the internal lanes that lead into `lane` and yield the lanes before them with their end's distance (m)."""
    if distance >= horizon:
        return
    for before, parts in net.arrivals(lane):
        reached = distance
        for part in reversed(parts):
            if reached >= horizon:
                break
            reached += net.spine_length(part)
            key = (part, edges)
            found[key] = min(reached, found.get(key, math.inf))
        if reached < horizon:
            yield reached, before
