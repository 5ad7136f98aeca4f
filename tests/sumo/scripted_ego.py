"""An ego of whom SUMO says what a script says."""

from __future__ import annotations

import libsumo
from scripted import Domain, script

from sumo_reactive.driver.nouns.state import VehicleState
from sumo_reactive.sumo.ego import Ego
from sumo_reactive.sumo.vehicle_type import pose_of

TYPE = {
    "getVehicleClass": "passenger", "getLength": 4.0, "getWidth": 1.8, "getDecel": 4.5, "getEmergencyDecel": 9.0,
    "getMaxSpeed": 50.0, "getAccel": 2.6, "getTau": 1.0, "getMinGap": 2.5, "getTypeID": "car", "getParameter": "",
}  # fmt: skip
ON_ROAD = {
    "getDeparture": 3.0, "getSpeedFactor": 1.1, "getApparentDecel": 4.5, "getLaneID": "w_0", "getLanePosition": 20.0,
    "getAngle": 90.0, "getRoute": ("w", "e"), "getRouteIndex": 0, "getStops": (), "getPosition": (38.4, -1.6),
    "getSpeed": 8.0, "getLeader": None, "getDistance": 0.0, "getTimeLoss": 4.5,
}  # fmt: skip
LENGTHS = {"w_0": 50.0, "e_0": 96.0, ":j_0_0": 8.0}


def scripted(monkeypatch, after: float = -1.0, **said):
    """An ego of whom SUMO says this, with all that SUMO has been told of it since it was seen."""
    vehicle = Domain(**TYPE, **(ON_ROAD | said))
    failed = libsumo.TraCIException("cannot be saved")
    script(
        monkeypatch,
        vehicle=vehicle,
        vehicletype=Domain(getParameter=""),
        lane=Domain(getAngle=lambda lane_id, position: 90.0, getLength=LENGTHS, getLinks=(), getLastStepVehicleIDs=()),
        edge=Domain(getLaneNumber={"w": 1, "e": 3}),
        simulation=Domain(getOption={"time-to-teleport": str(after)}, saveState=failed, getTime=7.0),
    )
    return Ego("ego"), vehicle


def state_at(ego, x=38.4, y=-1.6, heading=0.0, speed=8.0, acceleration=0.0):
    """The ego with the middle of its front bumper at (x, y)."""
    return VehicleState(pose_of(x, y, heading, ego.limits), speed, 0.0, acceleration)
