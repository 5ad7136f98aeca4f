"""The discretised command space K (F&L 1991, §3.2)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sumo_reactive.driver.compilation import kernel
from sumo_reactive.driver.parameters import (
    COMFORT_JERK,
    MAX_LATERAL_JERK,
    PAPER_LATERAL_STEP,
    PAPER_STEERING_SPEED,
)
from sumo_reactive.driver.vehicle.limits import VehicleLimits

Array = NDArray[np.float64]

_STEERING_LEVELS = np.array([-1.0, -0.42, -0.125, -0.016, 0.0, 0.016, 0.125, 0.42, 1.0])
"""Cubically spaced levels: fine about straight on, where high speed needs it, full at the ends."""

_JERK_LEVELS = np.array([-1.0, -0.5, 0.0, 0.5, 1.0])
"""Levels within the comfortable change of acceleration."""


class CommandGrid(NamedTuple):
    """Accelerations (a,) in m/s² and steering rates (w,) in rad/s; the command space is their product."""

    accelerations: Array
    steering_rates: Array


def steering_rate_limit(limits: VehicleLimits, speed: float) -> float:
    """φ̇max at `speed` (m/s): the car's own, or what keeps the lateral jerk v²φ̇/L bounded, rad/s."""
    return min(limits.max_steering_rate, MAX_LATERAL_JERK * limits.wheelbase / max(speed, 1.0) ** 2)


def gentlest_brake(acceleration: float, period: float) -> float:
    """The lowest next acceleration within the comfortable jerk, m/s²: the throttle may be released at once."""
    return min(acceleration, 0.0) - COMFORT_JERK * period


def paper_grid(limits: VehicleLimits, speed: float, period: float) -> CommandGrid:
    """The nine commands of the paper: {−v̇max, 0, +v̇max} × {−φ̇max, 0, +φ̇max} (F&L 1991, §3.2).

    Reading: φ̇max falls with the square of the speed so that one command cannot use up the centrifugal limit; with a
    constant φ̇max and δt = 0.5 s a car at road speed could not steer at all. `speed` in m/s, `period` δt in s.
    """
    lateral = PAPER_LATERAL_STEP * limits.wheelbase / max(speed, PAPER_STEERING_SPEED) ** 2 / period
    top = min(limits.max_steering_rate, lateral)
    return CommandGrid(
        np.array([-limits.service_deceleration, 0.0, limits.max_acceleration]), top * np.array([-1.0, 0.0, 1.0])
    )


def fine_grid(
    limits: VehicleLimits, speed: float, acceleration: float, wanted: float, steering: float, period: float
) -> CommandGrid:
    """A 9 × 9 grid that is fine where the ego is and reaches everything it can do.

    Five accelerations lie within the comfortable jerk of the present `acceleration`, one is the `wanted` one, three brake
    ever harder. After harder braking than planned they lie about the planned one: an emergency ends at once. Steering
    rates lie around `steering`, the rate that C asks for.
    """
    planned = limits.planned_deceleration
    accelerations, rates = _fine_axes(
        max(acceleration, -planned), wanted, steering, steering_rate_limit(limits, speed), COMFORT_JERK * period,
        planned, limits.emergency_deceleration, limits.max_acceleration,
    )  # fmt: skip
    return CommandGrid(accelerations, rates)


@kernel
def _fine_axes(
    acceleration: float, wanted: float, steering: float, top: float, change: float, planned: float, emergency: float,
    most: float,
) -> tuple[Array, Array]:  # fmt: skip
    """Return both axes of the fine grid; `change` (m/s²) is what the comfortable jerk allows, `top` φ̇max (rad/s)."""
    nodes = np.empty(9)
    nodes[:5] = acceleration + change * _JERK_LEVELS
    nodes[5] = min(wanted, acceleration + change)
    nodes[6], nodes[7], nodes[8] = -planned, -0.5 * (planned + emergency), -emergency
    rates = min(max(steering, -top), top) + top * _STEERING_LEVELS
    return np.minimum(np.maximum(nodes, -emergency), most), np.minimum(np.maximum(rates, -top), top)


def wide_grid(limits: VehicleLimits) -> CommandGrid:
    """A 9 × 21 grid over all that the car can do: the way out of a local minimum of the usual ones."""
    accelerations = np.linspace(-limits.emergency_deceleration, limits.max_acceleration, 9)
    return CommandGrid(accelerations, np.linspace(-limits.max_steering_rate, limits.max_steering_rate, 21))
