"""Everybody within sight of a place, whether or not a driver looks at him: for the record alone."""

from __future__ import annotations

import math

import libsumo

from sumo_reactive.driver.nouns.record import Bystander
from sumo_reactive.sumo.stand_ins import is_stand_in
from sumo_reactive.sumo.vehicle_type import heading_of, size_of_body


class Everybody:
    """Sees all vehicles and pedestrians of a running simulation, stand-ins left out; it goes on unchanged."""

    def __init__(self) -> None:
        self._sizes: dict[str, tuple[float, float]] = {}

    def within(self, reach: float, ego_id: str, x: float, y: float) -> tuple[Bystander, ...]:
        """Return who is nearer than `reach` to a place (m), the ego left out."""
        found = []
        for domain in (libsumo.vehicle, libsumo.person):
            for name in domain.getIDList():
                there = domain.getPosition(name)
                if math.dist(there, (x, y)) < reach and name != ego_id and not is_stand_in(name):
                    signals = libsumo.vehicle.getSignals(name) if domain is libsumo.vehicle else 0
                    heading, speed = heading_of(domain.getAngle(name)), domain.getSpeed(name)
                    length, width = self._size(domain, name)
                    found.append(Bystander(name, there[0], there[1], heading, speed, length, width, signals))
        return tuple(found)

    def _size(self, domain: type[libsumo.vehicle] | type[libsumo.person], name: str) -> tuple[float, float]:
        if name not in self._sizes:
            self._sizes[name] = size_of_body(name, domain.getLength(name), domain.getWidth(name))
        return self._sizes[name]
