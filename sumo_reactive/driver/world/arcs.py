"""The arcs of the labelled oriented graph W (F&L 1991, §2)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum
from itertools import pairwise

from sumo_reactive.driver.world.junction import Connection
from sumo_reactive.driver.world.regions import ConflictRegion


class ArcLabel(Enum):
    """What the source of an arc is to its target."""

    FOLLOWS = "follows"  # the target lane follows the source lane
    LEFT_OF = "left of"  # the source lane lies left of the target lane
    RIGHT_OF = "right of"
    ENTERS = "enters"  # lane → conflict region
    CLEARS = "clears"  # conflict region → the post-conflict region behind it
    LEADS_TO = "leads to"  # post-conflict region → lane
    CONFLICTS = "conflicts"  # conflict region ↔ the connection that shares it


@dataclass(frozen=True, slots=True)
class Arc:
    """A labelled arc between two nodes, each named by its id."""

    source: str
    target: str
    label: ArcLabel


def arcs_of_connection(connection: Connection) -> Iterator[Arc]:
    """Yield the arcs that join a connection's lanes in driving order."""
    lanes = (connection.from_lane, *connection.parts, connection.to_lane)
    for source, target in pairwise(lanes):
        yield Arc(source, target, ArcLabel.FOLLOWS)


def arcs_of_region(region: ConflictRegion, own: Connection) -> Iterator[Arc]:
    """Yield the way through a conflict region and the conflict that makes it one."""
    yield Arc(own.from_lane, region.id, ArcLabel.ENTERS)
    yield Arc(region.id, region.post.id, ArcLabel.CLEARS)
    yield Arc(region.post.id, own.to_lane, ArcLabel.LEADS_TO)
    yield Arc(region.id, region.other_id, ArcLabel.CONFLICTS)
    yield Arc(region.other_id, region.id, ArcLabel.CONFLICTS)
