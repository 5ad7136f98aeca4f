"""The discretised command space K (F&L 1991, §3.2)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from sumo_reactive.driver.compilation import kernel
from sumo_reactive.driver.geometry.polyline import Floats
from sumo_reactive.driver.vehicle.limits import VehicleLimits

PAPER_LATERAL_STEP = 1.1
"""m/s²; most that one of the nine commands changes the lateral acceleration: coarser, it weaves; finer, it turns late."""

PAPER_STEERING_SPEED = 4.0
"""m/s; below it φ̇max of the nine commands no longer grows: a tight turn is driven about so fast."""


STEERING_LEVELS = np.array([-1.0, -0.3, -0.06, 0.0, 0.06, 0.3, 1.0])
"""Cubically spaced levels: fine about a held wheel, where high speed needs it, full at the ends."""

ROUNDS = 3
"""The nodes of the last lattice lie 27 times as close as those of the first."""


class CommandGrid(NamedTuple):
    """Accelerations (a,) in m/s² and steering rates (w,) in rad/s, both rising; the command space is their product.

    It is searched `rounds` times more, each time by a finer lattice around the best command so far.
    """

    accelerations: Floats
    steering_rates: Floats
    rounds: int = 0


@kernel
def steering_rate_limit(most: float, lateral_jerk: float, wheelbase: float, speed: float) -> float:
    """φ̇max at `speed` (m/s): the car's own, `most`, or what keeps the `lateral_jerk` v²φ̇/L (m/s³) bounded, rad/s."""
    return min(most, lateral_jerk * wheelbase / max(speed, 1.0) ** 2)


@kernel
def gentlest_brake(acceleration: float, period: float, jerk: float) -> float:
    """The lowest next acceleration within the comfortable `jerk` (m/s³), m/s²: the throttle may be released at once."""
    return min(acceleration, 0.0) - jerk * period


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


def lattice(limits: VehicleLimits, speed: float, acceleration: float, period: float) -> CommandGrid:
    """Return the lattice of `lattice_axes` for a car, made finer in `ROUNDS`."""
    p = limits.parameters
    numbers = p.comfort_jerk * period, limits.planned_deceleration, limits.emergency_deceleration, limits.max_acceleration
    top = steering_rate_limit(limits.max_steering_rate, p.max_lateral_jerk, limits.wheelbase, speed)
    return CommandGrid(*lattice_axes(acceleration, *numbers, top), ROUNDS)


@kernel
def lattice_axes(
    acceleration: float, change: float, planned: float, emergency: float, most: float, top: float
) -> tuple[Floats, Floats]:
    """Return the axes of a lattice over what the car can do, whatever C and v_d ask for: at most 6 × 7 commands.

    Three accelerations (m/s²) span the comfortable jerk about the present one, by a `change` to both sides, three brake ever
    harder. After harder braking than `planned` they lie about the planned one: an emergency ends at once. The steering rates
    reach to `top` rad/s.
    """
    return accelerations_about(acceleration, change, planned, emergency, most), top * STEERING_LEVELS


@kernel
def accelerations_about(acceleration: float, change: float, planned: float, emergency: float, most: float) -> Floats:
    """Return the accelerations (a,) of a lattice, m/s², rising: the present one, `change` to both sides of it, and from the
    `planned` deceleration to that of an `emergency`; none beyond the latter, none above `most`."""
    gentle = max(acceleration, -planned)  # plus 0, of which there is but one then
    nodes = np.array([-emergency, -0.5 * (planned + emergency), -planned, gentle - change, gentle + 0.0, gentle + change])
    n = 0
    for node in nodes:
        one = min(max(node, -emergency), most)
        k = n
        while k > 0 and nodes[k - 1] > one:
            k -= 1
        if k > 0 and nodes[k - 1] == one:
            continue
        for later in range(n, k, -1):
            nodes[later] = nodes[later - 1]
        nodes[k] = one
        n += 1
    return nodes[:n]


def wide_grid(limits: VehicleLimits) -> CommandGrid:
    """A 9 × 21 grid over all that the car can do: the way out of a local minimum of the usual ones."""
    accelerations = np.linspace(-limits.emergency_deceleration, limits.max_acceleration, 9)
    return CommandGrid(accelerations, np.linspace(-limits.max_steering_rate, limits.max_steering_rate, 21), ROUNDS)
