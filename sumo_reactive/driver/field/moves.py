"""The moves of a turn where the road is too narrow for one sweep: arcs at walking speed, wheels at full lock."""

from __future__ import annotations

import math

from sumo_reactive.driver.geometry.footprint import boxes_overlap
from sumo_reactive.driver.nouns.plan import MOVE_BACK_SPEED, MOVE_END_M, MOVE_SPEED, WHEELS_TURNED_RAD, Move
from sumo_reactive.driver.nouns.snapshot import Snapshot
from sumo_reactive.driver.nouns.state import Command, Pose, VehicleState
from sumo_reactive.driver.vehicle.bicycle import advance, advance_pose
from sumo_reactive.driver.vehicle.limits import VehicleLimits

MOVE_SIGHT_M = 0.8
"""A move goes on while the ego's body touches nobody this far beyond where it could stop."""

LEAST_SPEED = 0.1
"""m/s; how fast a move comes to its end."""

SIDE_CLEARANCE_M = 0.15
"""Others keep this far from the ego's sides."""

STEP_M = 0.2
"""Poses on the arc ahead are looked at this far apart."""

FORESEEN_S = 1.0
"""Who drives is looked for where he is, and where he will be after this time."""


def moved_on(
    snapshot: Snapshot, move: Move, acceleration: float, limits: VehicleLimits, period: float
) -> tuple[Command, VehicleState]:
    """Return the next command of a move, gaining speed by `acceleration` (m/s²), and the state it leads to.

    The wheels are turned first, at a stand, and straightened after the last move. The ego waits while somebody is in the
    way.
    """
    ego, hard = snapshot.ego, limits.comfort_deceleration
    speed = max(move.gear * ego.speed, 0.0)
    left = max(move.left(ego.pose.heading), 0.0)
    straightens = move.is_last and left < MOVE_END_M
    turn = (0.0 if straightens else move.steering_angle) - ego.steering_angle
    sight = min(left, speed * speed / (2.0 * hard) + MOVE_SIGHT_M)
    wanted = 0.0
    if abs(turn) < WHEELS_TURNED_RAD and _is_free(snapshot, move, sight, limits):
        top = MOVE_SPEED if move.gear > 0 else MOVE_BACK_SPEED
        gentle = max(math.sqrt(2.0 * acceleration * left), LEAST_SPEED)
        wanted = min(top, gentle, speed + acceleration * period, left / period)
    wanted = max(wanted, speed - hard * period)
    rate = max(-limits.max_steering_rate, min(limits.max_steering_rate, turn / period))
    command = Command((move.gear * wanted - ego.speed) / period, rate)
    return command, advance(ego, command, limits.wheelbase, period, lowest=-MOVE_BACK_SPEED)


def _is_free(snapshot: Snapshot, move: Move, way: float, limits: VehicleLimits) -> bool:
    """Whether nobody is touched, now or soon, within `way` m of the arc, whom the ego does not leave."""
    boxes = [where for box in snapshot.boxes.tolist() for where in _places(*box[:6])]
    near = [box for box in boxes if not _touched(snapshot.ego.pose, box, limits)]
    angle, steps = move.steering_angle, max(math.ceil(way / STEP_M), 1)
    pose = snapshot.ego.pose
    for _ in range(steps if near else 0):
        pose = Pose(*advance_pose(*_of(pose), move.gear * way / steps, angle, limits.wheelbase, 1.0))
        if any(_touched(pose, box, limits) for box in near):
            return False
    return True


def _of(pose: Pose) -> tuple[float, float, float]:
    return pose.x, pose.y, pose.heading


_Box = tuple[float, float, float, float, float]
"""Centre (m, m), heading (rad), length, width (m)."""


def _places(x: float, y: float, heading: float, speed: float, length: float, width: float) -> list[_Box]:
    """Return the boxes that a body with its front at (`x`, `y`) covers now and soon."""
    c, s = math.cos(heading), math.sin(heading)
    ways = (0.0,) if speed == 0.0 else (0.0, speed * FORESEEN_S)
    return [(x + (way - 0.5 * length) * c, y + (way - 0.5 * length) * s, heading, length, width) for way in ways]


def _touched(pose: Pose, box: _Box, limits: VehicleLimits) -> bool:
    """Whether the ego at `pose` (of its rear axle) comes too near to a box."""
    middle = limits.front_to_rear_axle - 0.5 * limits.length
    x, y = pose.x + middle * math.cos(pose.heading), pose.y + middle * math.sin(pose.heading)
    return boxes_overlap(x, y, pose.heading, limits.length, limits.width + 2.0 * SIDE_CLEARANCE_M, *box)
