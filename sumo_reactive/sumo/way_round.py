"""SUMO's own routing: the quickest way to a goal that begins with one of the edges the ego can still reach."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise

import libsumo

Way = tuple[str, ...]


def quickest_way(vehicle_id: str, firsts: Iterable[str], goals: Sequence[str]) -> Way:
    """Return the edges of the quickest way from one of the edges `firsts` by all `goals` in order; empty: there is none."""
    ways = [way for first in dict.fromkeys(firsts) if (way := _through(vehicle_id, (first, *goals)))]
    return min(ways, key=lambda way: way[1], default=((), 0.0))[0]


def _through(vehicle_id: str, places: Sequence[str]) -> tuple[Way, float] | None:
    """Return edges and travel time (s) from place to place; None where a leg has no way."""
    way, time = places[:1], 0.0
    for start, goal in pairwise(places):
        leg = _leg(vehicle_id, start, goal)
        if leg is None:
            return None
        way, time = (*way, *leg[0][1:]), time + leg[1]
    return tuple(way), time


def _leg(vehicle_id: str, start: str, goal: str) -> tuple[Way, float] | None:
    if start == goal:
        return (start,), 0.0
    now, kind = libsumo.simulation.getTime(), libsumo.vehicle.getTypeID(vehicle_id)
    try:
        found = libsumo.simulation.findRoute(start, goal, kind, now)
    except libsumo.TraCIException:
        return None
    return (tuple(found.edges), float(found.travelTime)) if found.edges else None
