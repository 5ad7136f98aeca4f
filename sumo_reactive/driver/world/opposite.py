"""Which edge shares an edge's carriageway in the other direction."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from sumo_reactive.driver.parameters import OPPOSITE_SLACK_M
from sumo_reactive.driver.world.lane import Lane

_SAMPLES = np.linspace(0.1, 0.9, 5)  # fractions of the spine; its ends may fan out at the junctions


def nearest_opposite(inner: Lane, candidates: Iterable[Lane]) -> Lane | None:
    """Return the oncoming inner lane that lies right beside `inner`, or None.

    `candidates` are the inner lanes of edges that join the same junctions the other way round; one counts if vehicles of
    some class may use both and if on average at most `OPPOSITE_SLACK_M` lies between them.
    """
    beside = [(separation(inner, lane), lane) for lane in candidates if lane.allowed & inner.allowed]
    near = [(gap, lane) for gap, lane in beside if gap <= OPPOSITE_SLACK_M]
    return min(near, key=lambda item: (abs(item[0]), item[1].id))[1] if near else None


def separation(inner: Lane, other: Lane) -> float:
    """Return the mean room between the borders of two lanes, m; negative where they overlap."""
    offsets = [other.spine.project(*inner.spine.at(float(f) * inner.spine.length))[1] for f in _SAMPLES]
    return float(np.mean(np.abs(offsets))) - 0.5 * (inner.width + other.width)
