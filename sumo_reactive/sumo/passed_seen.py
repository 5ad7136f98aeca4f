"""What those behind the ego have to see while it passes somebody on its lane: SUMO has the ego between them."""

from __future__ import annotations

import libsumo

from sumo_reactive.sumo.stand_ins import OCCUPIED_LANE_M, UNSEEN_REAR_M, Occupant, OccupiedLane, is_stand_in


def passed_seen(by: Occupant, ego_id: str, user_id: str, edges: tuple[str, ...], duration: float) -> OccupiedLane | None:
    """Return the place right behind the rear that those behind an ego have to look at while it passes a user: its own or
    his, whichever asks them to drive slower; None: he is on no lane of a road. `edges`: its route from its lane segment on;
    `duration`: of the next step, s.

    In the order of SUMO the ego is between them: who follows it would not see him, and follow it until he touches him.
    """
    vehicle, lane = libsumo.vehicle, by.graph.lanes.get(libsumo.vehicle.getLaneID(user_id))
    if lane is None or lane.is_internal:
        return None
    own, his = (vehicle.getLanePosition(name) - vehicle.getLength(name) for name in (ego_id, user_id))
    places = {name: vehicle.getLanePosition(name) for name in libsumo.lane.getLastStepVehicleIDs(lane.id)}
    behind = [name for name, place in places.items() if place < min(own, his) and not is_stand_in(name)]
    follower = max(behind, key=places.__getitem__, default="")
    if follower:
        kept = places[follower] + vehicle.getMinGap(follower)
        is_his = _followed(follower, his - kept, user_id) < _followed(follower, own - kept, ego_id)
    else:
        is_his = his < own
    if is_his:
        speed = vehicle.getSpeed(user_id) * lane.scale
        rear = his * lane.scale + speed * duration
    else:
        rear, speed = lane.spine.project(*by.behind_front(by.limits.length))[0], by.ego.speed
    return OccupiedLane(lane, *lane.spine.at(rear - OCCUPIED_LANE_M), speed, edges, length=UNSEEN_REAR_M)


def _followed(name: str, gap: float, leader: str) -> float:
    """Return how fast a vehicle would drive in its next step with `gap` m to spare behind a leader, m/s."""
    vehicle = libsumo.vehicle
    speeds = vehicle.getSpeed(name), vehicle.getSpeed(leader)
    return float(vehicle.getFollowSpeed(name, speeds[0], gap, speeds[1], vehicle.getApparentDecel(leader)))
