"""Everybody within sight of a place, whether or not a driver looks at him: for the record alone."""

from __future__ import annotations

import math
from collections.abc import Iterable

import libsumo

from sumo_reactive.driver.nouns.record import Bystander
from sumo_reactive.sumo.stand_ins import is_stand_in
from sumo_reactive.sumo.vehicle_type import heading_of, size_of_body

CLOSING_SPEED = 120.0
"""m/s; nobody comes nearer faster: who is far away is not looked at until he could be in sight."""

UNSEEN_S = 10.0
"""Who has been put elsewhere without being teleported is missed for no longer than this."""

_Domain = type[libsumo.vehicle] | type[libsumo.person]


class Everybody:
    """Sees all vehicles and pedestrians of a running simulation, stand-ins left out; it goes on unchanged."""

    def __init__(self) -> None:
        self._vehicles, self._persons = _Kind(libsumo.vehicle), _Kind(libsumo.person)
        self._listed = self._looked = -math.inf

    def within(self, reach: float, ego_id: str, x: float, y: float) -> tuple[Bystander, ...]:
        """Return who is nearer than `reach` to a place (m), the ego left out; `reach` is the same every time."""
        simulation = libsumo.simulation
        now = float(simulation.getTime())
        if now >= self._listed + UNSEEN_S or now > self._looked + 1.5 * simulation.getDeltaT():
            self._listed = now
            self._vehicles.list_all(now)
            self._persons.list_all(now)
        else:
            self._vehicles.expect((*simulation.getDepartedIDList(), *simulation.getEndingTeleportIDList()), now)
            self._persons.expect(simulation.getDepartedPersonIDList(), now)
        self._looked = now
        near = (*self._vehicles.within(reach, x, y, now), *self._persons.within(reach, x, y, now))
        return tuple(one for one in near if one.id != ego_id)


class _Kind:
    """All vehicles, or all persons: when each has to be looked at again (s), and how long and wide each is that was near."""

    def __init__(self, domain: _Domain) -> None:
        self._domain, self._signals = domain, getattr(domain, "getSignals", None)
        self._due: dict[str, float] = {}
        self._sizes: dict[str, tuple[float, float]] = {}

    def list_all(self, now: float) -> None:
        """Look at all of them next."""
        self._due.clear()
        self.expect(self._domain.getIDList(), now)

    def expect(self, names: Iterable[str], now: float) -> None:
        """Look at these next."""
        self._due.update((name, now) for name in names if not is_stand_in(name))

    def within(self, reach: float, x: float, y: float, now: float) -> list[Bystander]:
        """Return who is nearer than `reach` to a place, m."""
        domain, due, sizes, found = self._domain, self._due, self._sizes, list[Bystander]()
        position, angle, speed, signals = domain.getPosition, domain.getAngle, domain.getSpeed, self._signals
        for name in [name for name, when in due.items() if when <= now]:
            try:
                his_x, his_y = position(name)
            except libsumo.TraCIException:  # he has left
                del due[name]
                continue
            away = math.hypot(his_x - x, his_y - y) - reach
            if away >= 0.0:
                due[name] = now + away / CLOSING_SPEED
                continue
            length, width = sizes.get(name) or self._size(name)
            heading, shown = heading_of(angle(name)), signals(name) if signals else 0
            found.append(Bystander(name, his_x, his_y, heading, speed(name), length, width, shown))
        return found

    def _size(self, name: str) -> tuple[float, float]:
        found = self._sizes[name] = size_of_body(name, self._domain.getLength(name), self._domain.getWidth(name))
        return found
