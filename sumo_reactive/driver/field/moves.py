"""The moves of a turn where the road is too narrow for one sweep: arcs at walking speed, wheels at full lock."""

from __future__ import annotations

import math

from sumo_reactive.driver.geometry.footprint import boxes_overlap
from sumo_reactive.driver.nouns.plan import MOVE_BACK_SPEED, MOVE_END_M, MOVE_SPEED, TURNED_ON_M, WHEELS_TURNED_RAD, Move
from sumo_reactive.driver.nouns.snapshot import Snapshot
from sumo_reactive.driver.nouns.state import Command, Pose, VehicleState
from sumo_reactive.driver.vehicle.bicycle import advance, advance_pose
from sumo_reactive.driver.vehicle.body import Box, box_of, own_box
from sumo_reactive.driver.vehicle.limits import VehicleLimits

MOVE_SIGHT_M = 0.8
"""A move goes on while the ego's body touches nobody this far beyond where it could stop."""

WHEELS_READY_RAD = 0.6
"""A move begins when the wheels are this near to its steering angle: meanwhile it drives half a metre, and turns as much as
it would in 0.15 m less."""

TURN_ON_M = 0.4
"""The wheels are turned on to the next move's angle this far before the end, while the car comes to a stand there: some
0.1 m of the way is left then."""

STRAIGHTENING_SHARE = 0.8
"""Share of the largest steering rate with which the wheels are straightened on the way out."""

LEAST_SPEED = 0.1
"""m/s; how fast a move comes to its end."""

SIDE_CLEARANCE_M = 0.15
"""Others keep this far from the ego's sides."""

STEP_M = 0.2
"""Poses on the arc ahead are looked at this far apart."""

FORESEEN_S = 1.0
"""Who drives is looked for where he is, and as far as he comes within this time."""


def moved_on(
    snapshot: Snapshot, move: Move, acceleration: float, limits: VehicleLimits, period: float
) -> tuple[Command, VehicleState]:
    """Return the next command of a move, gaining speed by `acceleration` (m/s²), and the state it leads to.

    The wheels are turned as it stops and as it begins, and straightened after the last move, or on the way where it rolls
    out. The ego waits while somebody is in the way.
    """
    ego, hard = snapshot.ego, limits.comfort_deceleration
    speed = max(move.gear * ego.speed, 0.0)
    left = max(move.left(ego.pose.heading), 0.0)
    ends = _ends(move, left, ego, limits)
    turn = (move.then if ends else _wheels(move, left, speed, limits)) - ego.steering_angle
    sight = min(speed * speed / (2.0 * hard) + MOVE_SIGHT_M, math.inf if move.rolls_out else left)
    wanted = 0.0
    if not ends and abs(turn) < WHEELS_READY_RAD and _is_free(snapshot, move, left, sight, limits):
        top = MOVE_SPEED if move.gear > 0 else MOVE_BACK_SPEED
        wanted = min(top, speed + acceleration * period)
        if not move.rolls_out:
            wanted = min(wanted, max(math.sqrt(2.0 * acceleration * left), LEAST_SPEED), left / period)
    wanted = max(wanted, speed - hard * period)
    rate = max(-limits.max_steering_rate, min(limits.max_steering_rate, turn / period))
    command = Command((move.gear * wanted - ego.speed) / period, rate)
    return command, advance(ego, command, limits.wheelbase, period, lowest=-MOVE_BACK_SPEED)


def _ends(move: Move, left: float, ego: VehicleState, limits: VehicleLimits) -> bool:
    """Whether a car with `left` m to the end of a move stops there, its wheels turned on to the next one's angle."""
    speed = max(move.gear * ego.speed, 0.0)
    is_turned_on = abs(ego.steering_angle - move.steering_angle) > WHEELS_TURNED_RAD
    stops_in = speed * speed / (2.0 * limits.comfort_deceleration) + (TURNED_ON_M if is_turned_on else 0.0)
    return not move.is_last and left < min(stops_in, TURN_ON_M)


def _wheels(move: Move, left: float, speed: float, limits: VehicleLimits) -> float:
    """Return the steering angle (rad) to turn the wheels to, `left` m before the end: straight where the last move is over;
    where it rolls out at `speed` (m/s), so that they are straight when the car is."""
    if not move.is_last or not move.rolls_out:
        return 0.0 if move.is_last and left < MOVE_END_M else move.steering_angle
    way = speed * abs(move.steering_angle) / (2.0 * STRAIGHTENING_SHARE * limits.max_steering_rate)
    return move.steering_angle * (math.sqrt(left / way) if left < way else float(left >= MOVE_END_M))


def _is_free(snapshot: Snapshot, move: Move, left: float, way: float, limits: VehicleLimits) -> bool:
    """Whether nobody is touched, now or soon, within `way` m, of which the arc has `left`, whom the ego does not leave."""
    boxes = [_covered(*box[:6]) for box in snapshot.boxes.tolist()]
    near = [box for box in boxes if not _touched(snapshot.ego.pose, box, limits)]
    steps = max(math.ceil(way / STEP_M), 1)
    pose = snapshot.ego.pose
    for k in range(steps if near else 0):
        angle = move.steering_angle if k * way / steps < left or not move.rolls_out else 0.0
        pose = Pose(*advance_pose(*_of(pose), move.gear * way / steps, angle, limits.wheelbase, 1.0))
        if any(_touched(pose, box, limits) for box in near):
            return False
    return True


def _of(pose: Pose) -> tuple[float, float, float]:
    return pose.x, pose.y, pose.heading


def _covered(x: float, y: float, heading: float, speed: float, length: float, width: float) -> Box:
    """Return the box of what a body with its front at (`x`, `y`) covers now and soon."""
    way = speed * FORESEEN_S
    return box_of(x + way * math.cos(heading), y + way * math.sin(heading), heading, length + way, width)


def _touched(pose: Pose, box: Box, limits: VehicleLimits) -> bool:
    """Whether the ego at `pose` (of its rear axle) comes too near to a box."""
    return boxes_overlap(*own_box(pose, limits, beside=SIDE_CLEARANCE_M), *box)
