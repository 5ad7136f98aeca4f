"""Traffic drawn at random for a network: vehicles of all classes, stops, pedestrians; from an empty road to gridlock."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from random import Random
from typing import Any, NamedTuple

from roads.plain import element
from roads.vehicles import SORTS, VARIANTS

WINDOW_S = 240.0
"""Vehicles depart within this time from the begin."""

DENSITIES = (1.0, 40.0)
"""Vehicles on each km of lane, were all as fast as free: an empty road, gridlock."""

MOST = 350
"""Vehicles of a network at most."""

FRINGE = 8.0
"""A trip is so many times as likely to begin, or to end, where a road enters or leaves the network."""

FAST = 20.0
"""m/s; where a road is faster nobody cycles in the network."""

SHORTEST_M = 80.0
"""A trip is no shorter."""

TURNS_ROUND = 0.1
"""Of the trips that turn round on their way, so many are kept."""

FREE_SPEED = 9.0
"""m/s over a trip on free roads, as a guess."""


class Place(NamedTuple):
    """Where a sort of vehicles may drive: its edges, and how likely a trip begins and ends at each."""

    edges: list[Any]
    begins: list[float]
    ends: list[float]


class Demand(NamedTuple):
    """A network as sumolib reads it, and what all draw from."""

    net: Any
    rng: Random

    def place(self, vehicle_class: str) -> Place:
        """Return where a class may drive, in the order of the ids."""
        edges = sorted((one for one in self.net.getEdges() if one.allows(vehicle_class)), key=lambda one: one.getID())
        begins = [FRINGE if len(one.getFromNode().getIncoming()) <= 1 else 1.0 for one in edges]
        ends = [FRINGE if len(one.getToNode().getOutgoing()) <= 1 else 1.0 for one in edges]
        return Place(edges, begins, ends)

    def route(self, place: Place, vehicle_class: str) -> list[Any]:
        """Return the edges of a trip, empty if none was found."""
        for _ in range(20):
            first = self.rng.choices(place.edges, place.begins)[0]
            last = self.rng.choices(place.edges, place.ends)[0]
            found, _ = self.net.getOptimalPath(first, last, fastest=True, vClass=vehicle_class)
            if not found or len(found) < 2 or sum(one.getLength() for one in found) < SHORTEST_M:
                continue
            if not _turns_round(found) or self.rng.random() < TURNS_ROUND:
                return list(found)
        return []


def _turns_round(route: Sequence[Any]) -> bool:
    """Whether an edge of a route leads back to where the one before it has begun."""
    return any(one.getFromNode() is other.getToNode() for one, other in pairwise(route))


def vehicles(demand: Demand) -> list[str]:
    """Return the vehicles in the order of their departures."""
    rng, lanes = demand.rng, _lane_km(demand.net)
    is_slow = max(one.getSpeed() for one in demand.net.getEdges()) < FAST
    names = [name for name in SORTS if name != "bicycle" or is_slow]
    places = {name: demand.place(SORTS[name].vehicle_class) for name in names}
    names = [name for name in names if places[name].edges]
    density = math.exp(rng.uniform(*(math.log(one) for one in DENSITIES)))
    number = min(MOST, max(25, round(density * lanes * WINDOW_S / (600.0 / FREE_SPEED))))
    departures, found = sorted(round(rng.uniform(0.0, WINDOW_S), 1) for _ in range(number)), []
    for k, depart in enumerate(departures):
        name = rng.choices(names, [SORTS[one].share for one in names])[0]
        route = demand.route(places[name], SORTS[name].vehicle_class)
        if route:
            found.append(_vehicle(demand, name, k, depart, route))
    return found


def _lane_km(net: Any) -> float:
    return sum(one.getLength() * one.getLaneNumber() for one in net.getEdges()) / 1000.0


def _vehicle(demand: Demand, name: str, number: int, depart: float, route: list[Any]) -> str:
    rng = demand.rng
    said: dict[str, object] = {"id": f"{name}_{number}", "type": f"{name}{rng.randrange(VARIANTS)}", "depart": depart}
    said |= {"departLane": rng.choice(("best", "best", "free", "random", "allowed", "first"))}
    said |= {"departSpeed": rng.choice(("max", "max", "desired", "0", "avg"))}
    said |= {"departPos": rng.choice(("base", "base", "free", "random", "random_free"))}
    if rng.random() < 0.3:
        said["arrivalPos"] = "random" if rng.random() < 0.5 else round(rng.uniform(0.3, 1.0) * route[-1].getLength(), 1)
    stops = _stops(demand, name, route)
    if rng.random() < 0.5:
        edges = " ".join(one.getID() for one in route)
        return element("vehicle", element("route", edges=edges), *stops, **said)
    return element("trip", *stops, **said, from_=route[0].getID(), to=route[-1].getID(), via=_via(stops and route))


def _via(route: list[Any]) -> str | None:
    """Return what keeps a vehicle that stops on its way on it."""
    return " ".join(one.getID() for one in route[1:-1]) or None


def _stops(demand: Demand, name: str, route: list[Any]) -> list[str]:
    """Return the stops of a bus, and of some others: beside the road or on it."""
    rng = demand.rng
    share = {"bus": 0.8, "van": 0.3, "car": 0.06, "truck": 0.1}.get(name, 0.0)
    if rng.random() >= share:
        return []
    halts = [one for one in route[1:-1] if one.getLength() > 45.0]
    chosen = sorted(rng.sample(range(len(halts)), min(len(halts), 2 if name == "bus" else 1)))
    return [_stop(rng, name, halts[k]) for k in chosen]


def _stop(rng: Random, name: str, edge: Any) -> str:
    lane = next(one for one in edge.getLanes() if one.allows(SORTS[name].vehicle_class))
    if name == "bus":
        return element("stop", busStop=f"stop_{edge.getID()}", duration=round(rng.uniform(5.0, 25.0)))
    beside = "true" if name == "car" or rng.random() < 0.3 else None
    at = round(rng.uniform(0.4, 0.8) * lane.getLength(), 1)
    return element("stop", lane=lane.getID(), endPos=at, duration=round(rng.uniform(10.0, 60.0)), parking=beside)


def bus_stops(demand: Demand) -> list[str]:
    """Return a stop on each edge where a bus may have one, on its first lane for buses."""
    found = []
    for edge in demand.place("bus").edges:
        lane = next(one for one in edge.getLanes() if one.allows("bus"))
        end = round(0.7 * lane.getLength(), 1)
        if lane.getLength() > 45.0:
            name = f"stop_{edge.getID()}"
            found.append(element("busStop", id=name, lane=lane.getID(), startPos=max(0.0, end - 25.0), endPos=end))
    return found


def persons(demand: Demand) -> list[str]:
    """Return pedestrians in the order of their departures, none where nobody can walk."""
    rng, edges = demand.rng, demand.place("pedestrian").edges
    if len(edges) < 2:
        return []
    found = []
    for k, depart in enumerate(sorted(round(rng.uniform(0.0, WINDOW_S), 1) for _ in range(rng.randint(20, 150)))):
        first, last = (one.getID() for one in rng.sample(edges, 2))
        walk = element("walk", from_=first, to=last, arrivalPos=1)
        found.append(element("person", walk, id=f"walker_{k}", depart=depart))
    return found
