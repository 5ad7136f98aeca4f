"""Front-wheel kinematic model (F&L 1991, §3.1, figure 2)."""

from __future__ import annotations

import math

from sumo_reactive.driver.compilation import kernel
from sumo_reactive.driver.nouns.state import Command, Pose, VehicleState


@kernel
def advance_pose(
    x: float, y: float, heading: float, speed: float, steering_angle: float, wheelbase: float, duration: float
) -> tuple[float, float, float]:
    """Move the rear axle for `duration` s at constant front speed v (m/s) and steering angle φ (rad).

    ẋ = v cosφ cosθ, ẏ = v cosφ sinθ, θ̇ = v sinφ / L, integrated exactly along the arc (F&L 1991, §3.1).
    """
    turn = speed * math.sin(steering_angle) / wheelbase * duration
    chord = speed * math.cos(steering_angle) * duration
    if abs(turn) > 1e-6:
        chord *= math.sin(0.5 * turn) / (0.5 * turn)
    middle = heading + 0.5 * turn
    return x + chord * math.cos(middle), y + chord * math.sin(middle), heading + turn


def advance(
    state: VehicleState, command: Command, wheelbase: float, duration: float, *, lowest: float = 0.0
) -> VehicleState:
    """Return the state after holding v' = v + δt·v̇ and φ' = φ + δt·φ̇ for `duration` δt (F&L 1991, §3.1).

    A speed below `lowest` (m/s) becomes that: the car does not roll back, unless it is to back up.
    """
    speed = max(lowest, state.speed + command.acceleration * duration)
    angle = state.steering_angle + command.steering_rate * duration
    p = state.pose
    x, y, heading = advance_pose(p.x, p.y, p.heading, speed, angle, wheelbase, duration)
    achieved = (speed - state.speed) / duration
    return VehicleState(Pose(x, y, heading), speed, angle, achieved)
