"""Internal lanes that SUMO does not look at when it maps a moved vehicle along its route."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from sumo_reactive.driver.world.road_graph import RoadGraph


def overlooked(graph: RoadGraph, edges: Sequence[str]) -> frozenset[str]:
    """Return the internal lanes of all ways between two consecutive `edges` but the first, by their ids.

    Where several internal edges join the same two edges (two lanes fork to both sides, or two turn beside each other),
    SUMO looks for a vehicle that keeps its route on one of them only.
    """
    return frozenset(lane_id for before, behind in pairwise(edges) for lane_id in _beside_the_first(graph, before, behind))


def _beside_the_first(graph: RoadGraph, before: str, behind: str) -> list[str]:
    ways = [
        connection.parts
        for lane in graph.edge_lanes.get(before, ())
        for connection in graph.outgoing.get(lane.id, ())
        if connection.parts and graph.lanes[connection.to_lane].edge_id == behind
    ]
    known = {graph.lanes[part].edge_id for part in ways[0]} if ways else set()
    return [part for way in ways[1:] for part in way if graph.lanes[part].edge_id not in known]
