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

_INNER, _OUTER, _AHEAD, _BEHIND = 0, 1, 2, 0
"""Bits of what `getNeighbors` is asked for."""


def surroundings_of(vehicle_id: str) -> Surroundings | None:
    """Return what is around a vehicle; None while it is on no lane."""
    vehicle, index = libsumo.vehicle, libsumo.vehicle.getLaneIndex(vehicle_id)
    driven = float(vehicle.getLanePosition(vehicle_id))
    ways = {int(lane[0].rpartition("_")[2]): float(lane[1]) - driven for lane in vehicle.getBestLanes(vehicle_id)}
    if index not in ways:
        return None
    edge, min_gap = vehicle.getRoadID(vehicle_id), vehicle.getMinGap(vehicle_id)

    def lane(at: int, leader: NextUser | None, follower: NextUser | None) -> LaneAround:
        return LaneAround(at, ways[at], float(libsumo.lane.getMaxSpeed(f"{edge}_{at}")), leader, follower)

    def beside(at: int, side: int) -> LaneAround | None:
        if at not in ways:
            return None
        ahead, behind = (vehicle.getNeighbors(vehicle_id, side | way) for way in (_AHEAD, _BEHIND))
        return lane(at, _next(ahead[0], min_gap) if ahead else None, _next(behind[0]) if behind else None)

    leader, follower = vehicle.getLeader(vehicle_id, LOOK_AHEAD_M), vehicle.getFollower(vehicle_id, LOOK_BACK_M)
    own = lane(index, _next(leader, min_gap) if leader else None, _next(follower) if follower[0] else None)
    return Surroundings(own, beside(index + 1, _INNER), beside(index - 1, _OUTER), _light(vehicle_id))


def _next(found: tuple[str, float], min_gap: float | None = None) -> NextUser:
    """Return somebody whom SUMO has found; it counts the gap from where whoever follows would stop."""
    name, gap = found
    kept = libsumo.vehicle.getMinGap(name) if min_gap is None else min_gap
    return NextUser(name, float(gap) + float(kept), float(libsumo.vehicle.getSpeed(name)))


def _light(vehicle_id: str) -> NextLight | None:
    lights = libsumo.vehicle.getNextTLS(vehicle_id)
    return NextLight(lights[0][0], float(lights[0][2]), lights[0][3]) if lights else None


def move_on_lane(vehicle_id: str, speed: float, index: int | None, duration: float, *, is_checked: bool) -> None:
    """Have SUMO move a vehicle along its lanes in the next step, to end at `speed` (m/s), and to a lane if one is named."""
    vehicle = libsumo.vehicle
    vehicle.setSpeedMode(vehicle_id, _CHECKED if is_checked else _UNCHECKED)
    vehicle.setLaneChangeMode(vehicle_id, _CAREFUL if is_checked else _BLIND)
    vehicle.setSpeed(vehicle_id, speed)
    edge = vehicle.getRoadID(vehicle_id)
    if index is not None and index != vehicle.getLaneIndex(vehicle_id) and not edge.startswith(":"):
        if not 0 <= index < libsumo.edge.getLaneNumber(edge):
            raise ValueError(f"edge '{edge}' has no lane {index}")
        vehicle.changeLane(vehicle_id, index, duration)
