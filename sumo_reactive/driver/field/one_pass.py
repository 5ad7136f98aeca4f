"""Between events there are only numbers: from P⁺ and what is seen to the next state in one compiled pass."""

from __future__ import annotations

import math

import numpy as np

from sumo_reactive.driver.compilation import kernel
from sumo_reactive.driver.field.command_grid import ROUNDS, lattice_axes, steering_rate_limit
from sumo_reactive.driver.field.demands import manner_in
from sumo_reactive.driver.field.desired_speed import OnCurve, room_left, wished, without_jerk
from sumo_reactive.driver.field.field import choose_command
from sumo_reactive.driver.geometry.curve import located
from sumo_reactive.driver.geometry.polyline import Floats
from sumo_reactive.driver.vehicle.safe_speed import HARD_STOP_MARGIN_M

STANDS = 3
"""Verdict beside those of the field: the ego stands and is to stand, there is nothing to choose."""


@kernel
def car_in(car: Floats, x: float, y: float, heading: float, speed: float, angle: float) -> Floats:
    """Return `car` (17), as `choose_command` takes it, with a state in it."""
    full = car.copy()
    full[0], full[1], full[2], full[3], full[4] = x, y, heading, speed, angle
    full[10] = max(full[10], abs(angle))
    full[13] = abs(speed * speed * math.sin(angle) / full[5])
    return full


@kernel
def commanded(
    time: float, s: float, d: float, front: float, x: float, y: float, heading: float, speed: float, angle: float,
    acceleration: float, period: float, manner_row: Floats, car: Floats, driver: Floats, timed: Floats, speeds: Floats,
    cx: Floats, cy: Floats, ch: Floats, curvature: Floats, bends: Floats, limits_along: Floats, times: Floats, step: float,
    hard: Floats, slots: Floats, static: Floats, boxes: Floats, left: float, right: float,
) -> tuple[int, float, int, float, float, float, float, float, float, float, float, float, float, float, float, float]:
    """Return the verdict, v_d (m/s), the hazard (see `wished`), acceleration, steering rate, U, U₁, U₂, U₃ of the command
    from the lattice, and x, y, heading, speed, steering angle, s and d (m) where it leads.

    The ego's front axle is at `s` of C, `d` m to its left, its front bumper at `front` m, its rear axle at (x, y). The rows
    are those of `demands`, C that of `wished`, the rest what `choose_command` takes.
    """
    ego, manner = OnCurve(time, s, d, front, heading, speed, angle, acceleration), manner_in(manner_row)
    wish, is_pressing, hazard = wished(
        ego, manner, period, hard, timed, speeds, slots, ch, curvature, bends, limits_along, times, step
    )
    wanted = without_jerk(wish, is_pressing, ego, period, manner.jerk)
    if wanted <= 0.0 and speed == 0.0:
        s, d = located(x, y, heading, car[5], cx, cy, step, s)
        return STANDS, wanted, hazard, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, x, y, heading, 0.0, angle, s, d
    room = room_left(hard, front, HARD_STOP_MARGIN_M) if manner.has_room > 0.0 else np.inf
    full = car_in(car, x, y, heading, speed, angle)
    top = steering_rate_limit(manner.steering_rate, manner.lateral_jerk, full[5], speed)
    accelerations, rates = lattice_axes(
        acceleration, manner.jerk * period, manner.planned, manner.emergency, manner.most, top
    )
    lowest = min(wanted, speed - manner.planned * period)
    gain, rate, best = choose_command(
        full, accelerations, rates, ROUNDS, period, room, wanted, lowest, cx, cy, ch, step, s, static,
        np.empty((0, 1, 1)), 0.0, 0.0, 1.0, boxes, left, right, driver,
    )  # fmt: skip
    verdict, _, u1, u2, u3, x, y, heading, faster, turned = best
    total = full[14] * u1 + full[15] * u2 + full[16] * u3
    s, d = located(x, y, heading, full[5], cx, cy, step, s)
    return verdict, wanted, hazard, gain, rate, total, u1, u2, u3, x, y, heading, faster, turned, s, d
