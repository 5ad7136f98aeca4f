"""Decelerations that a follower needs behind one who keeps his speed: DRAC, MDRAC, deceleration to safety time."""

from __future__ import annotations

import numpy as np

from sumo_reactive.driver.geometry.polyline import Floats

UNAVOIDABLE_M_S2 = 99.0
"""m/s²; stands for "no deceleration is enough", and is never passed."""

REACTION_S = 1.0
"""Until the follower brakes, in MDRAC; SUMO's own SSM device has the same."""

SAFETY_TIME_S = 1.0
"""Behind the one ahead, in the deceleration to safety time."""


def drac(gap: Floats, closing: Floats) -> Floats:
    """Return DRAC = Δv² / (2 g), 0 where the gap does not close (m/s²; Cooper & Ferguson 1976, Almqvist et al. 1991).

    `gap` g in m between the bodies, `closing` Δv = v_r − v_f in m/s.
    """
    return _needed(closing, gap)


def mdrac(gap: Floats, closing: Floats) -> Floats:
    """Return MDRAC = Δv / (2 (TTC − R)) with TTC = g / Δv and the reaction time R = 1 s (m/s²; Fu & Sayed 2021).

    99 where TTC ≤ R: whoever reacts so late cannot avoid it.
    """
    return _needed(closing, gap - closing * REACTION_S)


def safety_time_deceleration(gap: Floats, closing: Floats, front_speed: Floats) -> Floats:
    """Return DST = Δv² / (2 (g − v_f t_s)): to come down to v_f no less than t_s = 1 s behind (m/s²; Hupfer 1997).

    NaN where he is nearer already: that is lost, whatever he does.
    """
    room = gap - front_speed * SAFETY_TIME_S
    return np.where(room > 0.0, _needed(closing, room), np.nan)


def _needed(closing: Floats, room: Floats) -> Floats:
    """Return the deceleration (m/s²) that takes off `closing` (m/s) within `room` (m)."""
    is_enough = room > 0.0
    needed = np.where(is_enough, closing**2 / (2.0 * np.where(is_enough, room, 1.0)), UNAVOIDABLE_M_S2)
    return np.where(closing > 0.0, np.minimum(needed, UNAVOIDABLE_M_S2), 0.0)
