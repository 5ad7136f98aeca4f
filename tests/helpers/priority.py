"""Who has taken whose right of way, told from SUMO and the network file alone."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections import deque
from dataclasses import dataclass, field
from pathlib import Path

import libsumo

EGO = "ego"
HARD_M_S2 = -3.0
"""Braking is hard from here on, averaged over…"""
AVERAGED_S = 0.5
APPROACH_M = 50.0
"""A car this near to its line is about to cross it."""


class Rules:
    """The right of way at each junction as netconvert has written it: `<request response>`, its bits from right to left."""

    def __init__(self, net_file: Path) -> None:
        net = ET.parse(net_file).getroot()
        self._responses: dict[tuple[str, int], str] = {}
        self._links: dict[str, tuple[str, int]] = {}
        for junction in net.iter("junction"):
            name = junction.get("id", "")
            for request in junction.iter("request"):
                self._responses[name, int(request.get("index", "0"))] = request.get("response", "")[::-1]
            for index, lane in enumerate(junction.get("intLanes", "").split()):
                if not name.startswith(":"):
                    self._links[lane] = name, index
        onward = {f"{c.get('from')}_{c.get('fromLane')}": c.get("via", "") for c in net.iter("connection")}
        self._first: dict[tuple[str, str], str] = {}
        self._straight: set[tuple[str, int]] = set()
        for way in net.iter("connection"):
            via, edge = way.get("via", ""), way.get("from", "")
            if via and not edge.startswith(":"):
                self._first[f"{edge}_{way.get('fromLane')}", way.get("to", "")] = via
                last = onward.get(via, "") or via  # the part behind the place to wait in the junction
                link = self._links.setdefault(via, self._links.get(last, ("", -1)))
                if way.get("dir") == "s" and not way.get("tl"):
                    self._straight.add(link)

    def link(self, lane: str, onward: tuple[str, ...]) -> tuple[str, int] | None:
        """Return junction and link of a car on a lane that goes on to these edges; None: it is on no way through one."""
        found = self._links.get(lane) or self._links.get(self._first.get((lane, onward[0] if onward else ""), ""))
        return found if found is not None and found[0] else None

    def goes_first(self, other: tuple[str, int], own: tuple[str, int]) -> bool:
        """Whether the way `own` yields to the way `other` of the same junction, and not the other way round.

        Only ways straight on where no light rules: on others cars brake for the bend, or for the light.
        """
        yields = other in self._straight and other[0] == own[0] and self._responses[own][other[1]] == "1"
        return yields and self._responses[other][own[1]] == "0"


@dataclass
class Priority:
    """Sees who brakes hard while the ego is in the junction though his way goes first; not who, by SUMO's own word, has
    another leader near."""

    rules: Rules
    taken: list[tuple[float, str]] = field(default_factory=list)
    _speeds: deque[tuple[float, dict[str, float]]] = field(default_factory=deque)

    def __call__(self, _: object = None) -> None:
        """Look once, after a step."""
        vehicle, time = libsumo.vehicle, libsumo.simulation.getTime()
        names = vehicle.getIDList()
        self._speeds.append((time, {name: vehicle.getSpeed(name) for name in names}))
        while len(self._speeds) > 1 and self._speeds[1][0] <= time - AVERAGED_S + 1e-6:
            self._speeds.popleft()
        own = self.rules.link(vehicle.getLaneID(EGO), ()) if EGO in names else None
        if own is not None:
            self.taken += [(round(time, 2), name) for name in names if name != EGO and self._suffers(name, own)]

    def _suffers(self, name: str, own: tuple[str, int]) -> bool:
        vehicle, (since, before) = libsumo.vehicle, self._speeds[0]
        now = self._speeds[-1][0]
        if name not in before or now - since < AVERAGED_S - 1e-6:
            return False
        if (vehicle.getSpeed(name) - before[name]) / (now - since) >= HARD_M_S2:
            return False
        lane, route = vehicle.getLaneID(name), vehicle.getRoute(name)[vehicle.getRouteIndex(name) + 1 :]
        other = self.rules.link(lane, route)
        if other is None or not self.rules.goes_first(other, own):
            return False
        is_near = lane.startswith(":") or libsumo.lane.getLength(lane) - vehicle.getLanePosition(name) < APPROACH_M
        leader = vehicle.getLeader(name, APPROACH_M)
        return is_near and (not leader or leader[0] == EGO or leader[1] > APPROACH_M)
