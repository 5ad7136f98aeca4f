"""The labelled oriented graph W that joins lanes, conflict regions and post-conflict regions (F&L 1991, §2)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from sumo_reactive.world.junction import Connection, Junction
from sumo_reactive.world.lane import Lane
from sumo_reactive.world.regions import ConflictRegion


@dataclass(frozen=True, eq=False)
class RoadGraph:
    """The part of the world that a route touches; immutable, built once.

    `lanes` holds normal and internal lanes by id; `edge_lanes` the lanes of an edge, outermost first; `outgoing` and
    `incoming` the connections by lane id; `connection_of` the connection that an internal lane is part of; `regions`
    the conflict regions by the id of the own connection, in order of their start; `opposite` the edge that shares an
    edge's carriageway in the other direction.
    """

    lanes: Mapping[str, Lane]
    edge_lanes: Mapping[str, tuple[Lane, ...]]
    junctions: Mapping[str, Junction]
    connections: Mapping[str, Connection]
    outgoing: Mapping[str, tuple[Connection, ...]]
    incoming: Mapping[str, tuple[Connection, ...]]
    connection_of: Mapping[str, Connection]
    regions: Mapping[str, tuple[ConflictRegion, ...]]
    opposite: Mapping[str, str]
    left_hand: bool
