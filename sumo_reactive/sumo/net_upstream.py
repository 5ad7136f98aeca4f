"""A parsed network as the search for approaches sees it: which lanes lead to which, and how long they are."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from itertools import pairwise

from sumo_reactive.driver.world.lane import Lane
from sumo_reactive.sumo.net_connections import parts_of
from sumo_reactive.sumo.net_file import RawNet, edge_id_of, from_lane_id


class NetUpstream:
    """Answers `world.approach.Upstream` from a parsed network; what it has computed it keeps."""

    def __init__(self, raw: RawNet, lane_of: Callable[[str], Lane]) -> None:
        self._raw = raw
        self._lane_of = lane_of
        self._lengths: dict[str, float] = {}
        self._arrivals: dict[str, tuple[tuple[str, tuple[str, ...]], ...]] = {}
        self._detours: dict[tuple[str, str], tuple[str, ...]] = {}

    def edge_of(self, lane_id: str) -> str:
        """Return the edge that a lane belongs to."""
        return edge_id_of(lane_id)

    def ends_of(self, edge_id: str) -> tuple[str, str]:
        """Return the junctions where an edge starts and ends."""
        edge = self._raw.edge(edge_id).attrib
        return edge["from"], edge["to"]

    def spine_length(self, lane_id: str) -> float:
        """Return the length of a lane's spine, m."""
        if lane_id not in self._lengths:
            points = self._lane_of(lane_id).spine.points.tolist()
            self._lengths[lane_id] = sum(math.dist(a, b) for a, b in pairwise(points))
        return self._lengths[lane_id]

    def arrivals(self, lane_id: str) -> tuple[tuple[str, tuple[str, ...]], ...]:
        """Return (lane before the junction, internal lanes in driving order) of the connections into a lane."""
        if lane_id not in self._arrivals:
            links = self._raw.arriving.get(lane_id, ())
            self._arrivals[lane_id] = tuple((from_lane_id(link), parts_of(self._raw, link)) for link in links)
        return self._arrivals[lane_id]

    def detours(self, lane_id: str, edge_id: str) -> tuple[str, ...]:
        """Return the lanes beside `lane_id` from which no connection leads to `edge_id`."""
        key = (lane_id, edge_id)
        if key not in self._detours:
            self._detours[key] = tuple(self._lanes_without_way(lane_id, edge_id))
        return self._detours[key]

    def _lanes_without_way(self, lane_id: str, edge_id: str) -> Iterator[str]:
        own = self._lane_of(lane_id)
        for beside in self._raw.lane_ids(edge_id_of(lane_id)):
            leads_there = any(link["to"] == edge_id for link in self._raw.leaving.get(beside, ()))
            if beside != lane_id and not leads_there and own.allowed & self._lane_of(beside).allowed:
                yield beside
