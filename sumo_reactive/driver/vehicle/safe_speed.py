"""The speeds from which a driver stops in time: before a place, and behind a leader."""

from __future__ import annotations

import math

from sumo_reactive.driver.compilation import kernel

CURVATURE_WINDOW_M = 2.0
"""Curvature is averaged over this length before it sets a speed: single samples do not brake a car."""

SAFE_GAP_M = 0.5
"""Gap that must remain when ego and leader have both braked as hard as they can."""

HARD_STOP_MARGIN_M = 0.15
"""Distance to a line that no admissible command gives up; a line that asks late is stopped at so near."""


@kernel
def stopping_speed(distance: float, deceleration: float, period: float) -> float:
    """Largest speed after the next `period` (s) from which `deceleration` (m/s²) stops within `distance` m from now."""
    if distance <= 0.0:
        return 0.0
    b = deceleration * period
    return -b + math.sqrt(b * b + 2.0 * deceleration * distance)


@kernel
def following_speed(gap: float, leader_speed: float, deceleration: float, time_headway: float) -> float:
    """Speed that keeps `time_headway` (s) behind a leader (m, m/s) and stops behind it when both brake alike.

    The safe speed of Krauss (1998): v = −bτ + √((bτ)² + v_l² + 2b·gap).
    """
    b = deceleration * time_headway
    root = b * b + leader_speed * leader_speed + 2.0 * deceleration * gap
    return max(0.0, -b + math.sqrt(root)) if root > 0.0 else 0.0
