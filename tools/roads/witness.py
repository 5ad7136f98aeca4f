"""A witness sees a trip through SUMO alone, whoever drives: contacts, red lights, time off the road."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import libsumo
import shapely
import sumolib

from sumo_reactive.driver.geometry.footprint import Footprint

STAND_IN = "reactive.ghost."
"""Their ids begin so; they are no bodies."""

SHRINK_M = 0.05
"""Boxes are smaller by this on every side: positions are no more exact."""

LEVEL_M = 3.0
"""Bodies that differ more in height are on different levels."""

NEAR_M = 40.0
"""Two bodies whose fronts are farther apart do not touch."""

NO_GO = "ru"
"""Letters of a light that forbid to go."""

LINE_M = 0.5
"""Whoever enters a junction has come from a line no farther away than his way in the step and this."""


class Seen(NamedTuple):
    """What a witness has seen of a trip: with whom there was contact and when (s), when a red light was run (s), s."""

    contacts: tuple[tuple[float, str], ...]
    red: tuple[float, ...]
    off_road_s: float


class Witness:
    """Looks after each step at one vehicle and at all near it. `bridges`: pairs of edges on different levels."""

    def __init__(self, vehicle_id: str, bridges: frozenset[frozenset[str]] = frozenset()) -> None:
        self.id, self._bridges = vehicle_id, bridges
        self._contacts: list[tuple[float, str]] = []
        self._red: list[float] = []
        self._off_road = 0.0
        self._touching: set[str] = set()
        self._edge = ""
        self._light: tuple[str, int, float, str] | None = None

    def look(self) -> None:
        """Look once."""
        if self.id not in libsumo.vehicle.getIDList():
            return
        time, lane = float(libsumo.simulation.getTime()), libsumo.vehicle.getLaneID(self.id)
        if not lane and not libsumo.vehicle.isStoppedParking(self.id):
            self._off_road += float(libsumo.simulation.getDeltaT())
        self._see_light(time, libsumo.vehicle.getRoadID(self.id) if lane else "")
        touching = set(self._touched())
        self._contacts += [(round(time, 2), name) for name in sorted(touching - self._touching)]
        self._touching = touching

    @property
    def seen(self) -> Seen:
        """What it has come to."""
        return Seen(tuple(self._contacts), tuple(self._red), round(self._off_road, 3))

    def _see_light(self, time: float, edge: str) -> None:
        """Note a line crossed that was red before the step and in it."""
        before, own = self._light, libsumo.vehicle
        if before is not None and edge and edge != self._edge and not self._edge.startswith(":"):
            light, index, distance, letter = before
            way = own.getSpeed(self.id) * libsumo.simulation.getDeltaT()
            if distance < 1.5 * way + LINE_M and letter in NO_GO and _letter(light, index) in NO_GO:
                self._red.append(round(time, 2))
        self._edge = edge or self._edge
        ahead = own.getNextTLS(self.id) if edge else ()
        self._light = (*ahead[0][:3], ahead[0][3]) if ahead else None

    def _touched(self) -> Iterator[str]:
        """Yield who touches the vehicle now."""
        own = libsumo.vehicle
        (x, y, z), edge = own.getPosition3D(self.id), own.getRoadID(self.id)
        box = None
        for kind, name in _bodies():
            other = kind.getPosition3D(name)
            if name == self.id or math.dist((x, y), other[:2]) > NEAR_M or abs(other[2] - z) > LEVEL_M:
                continue
            box = box or _box(own, self.id)
            if box.intersects(_box(kind, name)) and frozenset((edge, kind.getRoadID(name))) not in self._bridges:
                yield name


def _bodies() -> Iterator[tuple[Any, str]]:
    """Yield all vehicles but stand-ins, and the pedestrians on crossings."""
    for name in libsumo.vehicle.getIDList():
        if not name.startswith(STAND_IN):
            yield libsumo.vehicle, name
    for name in libsumo.person.getIDList():
        if "_c" in (road := libsumo.person.getRoadID(name)) and road.startswith(":"):
            yield libsumo.person, name


def _letter(light: str, index: int) -> str:
    return str(libsumo.trafficlight.getRedYellowGreenState(light)[index]).lower()


def _box(kind: Any, name: str) -> shapely.Polygon:
    (x, y), heading = kind.getPosition(name), math.radians(90.0 - kind.getAngle(name))
    x, y = x - SHRINK_M * math.cos(heading), y - SHRINK_M * math.sin(heading)
    length, width = (max(one - 2.0 * SHRINK_M, SHRINK_M) for one in (kind.getLength(name), kind.getWidth(name)))
    return shapely.polygons(Footprint(x, y, heading, length, width).corners())


def bridges_of(net_file: Path) -> frozenset[frozenset[str]]:
    """Return the pairs of edges that cross in the plane without a junction between them."""
    net = sumolib.net.readNet(str(net_file))
    return frozenset(_crossing(net.getEdges()))


def _crossing(edges: Iterable[Any]) -> Iterator[frozenset[str]]:
    lines = [(one, shapely.LineString(one.getShape())) for one in edges if len(one.getShape()) > 1]
    for (one, a), (other, b) in itertools.combinations(lines, 2):
        ends = {one.getFromNode().getID(), one.getToNode().getID()}
        if not ends & {other.getFromNode().getID(), other.getToNode().getID()} and a.intersects(b):
            yield frozenset((one.getID(), other.getID()))
