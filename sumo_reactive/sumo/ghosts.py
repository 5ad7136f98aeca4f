"""Ghosts: stand-ins on a lane that the ego's body covers but SUMO does not map it to, so that others see it there."""

from __future__ import annotations

import contextlib

import libsumo

from sumo_reactive.driver.world.lane import Lane
from sumo_reactive.sumo.straddling import Haunt
from sumo_reactive.sumo.units import KEEP_ROUTE_EXACT, angle_of

PREFIX = "reactive.ghost."
"""Ids of ghosts begin with this; no figure counts them."""

_VAPORIZED = 3
_NO_LIMIT = 100.0
_SPEED_FACTOR = 2.0
"""Enough for every ego; a large one makes each of SUMO's steps ten times slower."""

_SILENT_DEVICES = ("tripinfo", "fcd", "vehroute", "ssm", "emissions", "battery")


def is_ghost(vehicle_id: str) -> bool:
    """Whether a vehicle id is a ghost's."""
    return vehicle_id.startswith(PREFIX)


class Ghosts:
    """At most one ghost of the ego, created when it is needed and removed when it is not; `label` tells it from others."""

    def __init__(self, ego_id: str, label: str = "") -> None:
        self._ego_id = ego_id
        self._name = f"{PREFIX}{ego_id}{label}"
        self._type = f"{PREFIX}type.{ego_id}{label}"
        self._made = 0
        self._ghost = ""
        self._edges: tuple[str, ...] = ()

    @property
    def made(self) -> int:
        """How many ghosts have been created."""
        return self._made

    def show(
        self, lane: Lane, x: float, y: float, speed: float, edges: tuple[str, ...], waits: bool = False
    ) -> None:
        """Put the ghost on `lane` beside the ego's front (x, y) at `speed` m/s; `edges`: the route from the lane on.

        One that `waits` is not made where somebody is.
        """
        s, _ = lane.spine.project(x, y)
        gx, gy = lane.spine.at(s)
        if self._ghost and not lane.is_internal and lane.edge_id not in self._edges:
            self.hide()
        if not self._ghost:
            if waits and _is_taken(lane, s / lane.scale, libsumo.vehicle.getLength(self._ego_id)):
                return
            self._edges = edges
        angle = angle_of(lane.spine.heading_at(s))
        try:
            if not self._ghost:
                self._create(lane, s / lane.scale, speed, edges)
            libsumo.vehicle.setSpeed(self._ghost, speed)
            libsumo.vehicle.moveToXY(self._ghost, "", -1, gx, gy, angle, KEEP_ROUTE_EXACT)
        except libsumo.TraCIException:  # taken off the road: the next step makes another; or its class may not be there
            self._ghost = ""

    def appear(self, haunt: Haunt | None) -> None:
        """Show the ghost where it has to be, or hide it where it need not (None)."""
        if haunt is None:
            self.hide()
        else:
            self.show(*haunt)

    def hide(self) -> None:
        """Remove the ghost, if there is one."""
        if self._ghost:
            with contextlib.suppress(libsumo.TraCIException):  # SUMO has already taken it off the road
                libsumo.vehicle.remove(self._ghost, _VAPORIZED)
            self._ghost = ""

    def _create(self, lane: Lane, position: float, speed: float, edges: tuple[str, ...]) -> None:
        if not self._made:
            self._make_type()
        self._made += 1
        self._ghost = f"{self._name}.{self._made}"
        libsumo.route.add(self._ghost, edges)
        starts_there = lane.edge_id == edges[0]  # from an internal lane it is moved there at once
        index, at = (str(lane.index), round(position, 2)) if starts_there else ("best", 0.0)
        libsumo.vehicle.add(
            self._ghost, self._ghost, self._type, depart="now", departLane=index,
            departPos=str(at), departSpeed=str(round(speed, 2)),
        )  # fmt: skip
        libsumo.vehicle.setSpeedMode(self._ghost, 32)
        libsumo.vehicle.setLaneChangeMode(self._ghost, 0)

    def _make_type(self) -> None:
        libsumo.vehicletype.copy(libsumo.vehicle.getTypeID(self._ego_id), self._type)
        libsumo.vehicletype.setMaxSpeed(self._type, _NO_LIMIT)  # SUMO inserts no vehicle above its own limit
        libsumo.vehicletype.setSpeedDeviation(self._type, 0.0)  # SUMO would draw for ever for a factor within its bounds
        libsumo.vehicletype.setSpeedFactor(self._type, _SPEED_FACTOR)
        for device in _SILENT_DEVICES:
            libsumo.vehicletype.setParameter(self._type, f"has.{device}.device", "false")


def _is_taken(lane: Lane, position: float, length: float) -> bool:
    """Whether somebody is on `lane` where a body of `length` m with its front at `position` (m) would be."""
    vehicle = libsumo.vehicle
    for other in libsumo.lane.getLastStepVehicleIDs(lane.id):
        front = vehicle.getLanePosition(other)
        if front > position - length and front - vehicle.getLength(other) < position:
            return True
    return False
