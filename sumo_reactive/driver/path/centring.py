"""Long bodies in bends: the front keeps to the outside, so that the rear, which cuts the inside, stays in the lane too."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d, minimum_filter1d, uniform_filter1d

from sumo_reactive.driver.geometry.polyline import Points, Polyline, moved_aside
from sumo_reactive.driver.geometry.swept import off_tracking
from sumo_reactive.driver.parameters import CURVE_STEP_M, MAX_CENTRING_M
from sumo_reactive.driver.vehicle.limits import VehicleLimits

Floats = NDArray[np.float64]

BEYOND_M = 0.2
"""Rear and, on the side of oncoming traffic, front may leave the lane by this: who drives in the middle of a lane of 3.2 m
leaves 0.7 m."""

LEAST_M = 1e-4
"""Less is rounding."""

BUMPER_SPARE_M = 0.3
"""The front bumper covers at least this much of its lane, which is what maps it to the lane."""


def centred(line: Points, half_widths: Floats, limits: VehicleLimits, left_hand: bool) -> Points:
    """Return `line` (n, 2), sampled every CURVE_STEP_M, moved to the outside of bends where the rear would leave the lane.

    `half_widths` (n,) are the lanes', m. It is moved by what the rear axle leaves the lane by, at most by half of what the
    axle is inside (then front and rear leave it alike), at most by MAX_CENTRING_M, and only as far as the front bumper
    stays near the lane: on the side of oncoming traffic (the right if `left_hand`) within it, but for BEYOND_M.
    """
    ahead = np.gradient(line, axis=0)
    headings, (xs, ys) = np.arctan2(ahead[:, 1], ahead[:, 0]), Polyline(line).columns
    rear, bumper = off_tracking(xs, ys, headings, CURVE_STEP_M, headings[0], limits.wheelbase, limits.front_overhang)
    half = 0.5 * limits.width
    excess = np.abs(rear) + half - BEYOND_M - half_widths
    if not (excess > 0.0).any():
        return line
    oncoming = rear < 0.0 if not left_hand else rear > 0.0  # the outside of the bend
    room = half_widths + np.where(oncoming, BEYOND_M - half, half - BUMPER_SPARE_M) - np.abs(bumper)
    most = np.minimum(0.5 * np.abs(rear), np.minimum(room, MAX_CENTRING_M))
    reach = 2 * int(0.5 * limits.wheelbase / CURVE_STEP_M) + 1
    shift = -np.sign(rear) * np.clip(excess, 0.0, np.maximum(minimum_filter1d(most, 2 * reach + 1), 0.0))
    return moved_aside(line, eased_in(shift, reach))


def eased_in(shift: Floats, reach: int) -> Floats:
    """Return `shift` (n,), m, kept up for half of `reach` samples before and behind a bend, and led there within as many."""
    left, right = (maximum_filter1d(np.maximum(side, 0.0), reach) for side in (shift, -shift))
    found = np.asarray(left - right)
    for _ in range(2):
        found = uniform_filter1d(found, reach, mode="nearest")
    return np.where(np.abs(found) < LEAST_M, 0.0, found)
