"""A vehicle in the hands of a driver of the user's: what is around it along the lanes, and motion on their rails."""

from __future__ import annotations

import libsumo

from sumo_reactive.driver.nouns.surroundings import LaneAround, NextLight, NextUser, Surroundings

LOOK_AHEAD_M, LOOK_BACK_M = 200.0, 100.0
"""So far others on the lanes around are looked for."""

_UNCHECKED, _CHECKED = 32, 31
"""SUMO's modes of speed: whatever is commanded; at most what its own checks allow."""

_BLIND, _CAREFUL = 0, 512
"""SUMO's modes of lane changing: as commanded; as commanded where the others leave the gap."""

_Found = tuple[str, float] | None
"""Somebody, and the gap (m)."""

_INNER, _OUTER, _AHEAD, _BEHIND = 0, 1, 2, 0
"""Bits of what `getNeighbors` is asked for."""


class LanesAround:
    """Sees what is around one vehicle along the lanes."""

    def __init__(self, vehicle_id: str) -> None:
        self._id = vehicle_id
        self._min_gaps: dict[str, float] = {}

    def look(self, lane_id: str, driven: float) -> Surroundings | None:
        """Return what is around the vehicle, `driven` m along a lane; None while it is on none."""
        vehicle, name = libsumo.vehicle, self._id
        edge, _, number = lane_id.rpartition("_")
        index, best = int(number or -1), vehicle.getBestLanes(name)
        if not 0 <= index < len(best):
            return None

        def lane(at: int, leader: _Found, follower: _Found) -> LaneAround:
            ahead = self._next(leader, name) if leader and leader[0] else None
            behind = self._next(follower, follower[0]) if follower and follower[0] else None
            return LaneAround(at, best[at][1] - driven, libsumo.lane.getMaxSpeed(f"{edge}_{at}"), ahead, behind)

        def beside(at: int, side: int) -> LaneAround:
            ahead, behind = vehicle.getNeighbors(name, side | _AHEAD), vehicle.getNeighbors(name, side | _BEHIND)
            return lane(at, ahead[0] if ahead else None, behind[0] if behind else None)

        own = lane(index, vehicle.getLeader(name, LOOK_AHEAD_M), vehicle.getFollower(name, LOOK_BACK_M))
        inner = beside(index + 1, _INNER) if index + 1 < len(best) else None
        outer = beside(index - 1, _OUTER) if index else None
        lights = vehicle.getNextTLS(name)
        return Surroundings(own, inner, outer, NextLight(lights[0][0], lights[0][2], lights[0][3]) if lights else None)

    def _next(self, found: tuple[str, float], behind: str) -> NextUser:
        """Return somebody whom SUMO has found; it counts the gap from where who is `behind` would stop."""
        name, gap = found
        kept = self._min_gaps.get(behind)
        if kept is None:
            kept = self._min_gaps[behind] = libsumo.vehicle.getMinGap(behind)
        return NextUser(name, gap + kept, libsumo.vehicle.getSpeed(name))


def move_on_lane(vehicle_id: str, speed: float, index: int | None, duration: float, *, is_checked: bool) -> None:
    """Have SUMO move a vehicle along its lanes in the next step, to end at `speed` (m/s), and to a lane if one is named."""
    vehicle = libsumo.vehicle
    vehicle.setSpeedMode(vehicle_id, _CHECKED if is_checked else _UNCHECKED)
    vehicle.setLaneChangeMode(vehicle_id, _CAREFUL if is_checked else _BLIND)
    vehicle.setSpeed(vehicle_id, speed)
    if index is None or index == vehicle.getLaneIndex(vehicle_id):
        return
    edge = vehicle.getRoadID(vehicle_id)
    if not edge.startswith(":"):
        if not 0 <= index < libsumo.edge.getLaneNumber(edge):
            raise ValueError(f"edge '{edge}' has no lane {index}")
        vehicle.changeLane(vehicle_id, index, duration)
