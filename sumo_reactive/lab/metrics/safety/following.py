"""Times between a follower and the one ahead: time to collision along the way, modified, exposed, integrated, headway."""

from __future__ import annotations

import numpy as np

from sumo_reactive.driver.geometry.polyline import Floats

MOVING_M_S = 0.1
"""m/s; who stands has no headway."""

SHORT_HEADWAY_S = 1.0
"""A shorter headway counts as short."""

EXPOSED_BELOW_S = 3.0
"""A time to collision below this is exposed time; SUMO's own SSM device logs below it, too."""


def ttc_along(gap: Floats, rear_speed: Floats, front_speed: Floats) -> Floats:
    """Return TTC = g / (v_r − v_f) along the way (s, infinite: the gap does not close; Hayward 1972).

    `gap` g in m between the bodies, speeds v_r of the follower and v_f of the one ahead in m/s.
    """
    closing = rear_speed - front_speed
    return np.where(closing > 0.0, gap / np.where(closing > 0.0, closing, 1.0), np.inf)


def modified_ttc(gap: Floats, closing: Floats, closing_faster: Floats) -> Floats:
    """Return MTTC, the first t > 0 with g = Δv t + ½ Δa t² (s, infinite: none; Ozbay et al. 2008).

    `closing` Δv = v_r − v_f in m/s, `closing_faster` Δa = a_r − a_f in m/s², NaN as 0: both keep their accelerations. Of the
    two roots 2 g / (Δv ± √(Δv² + 2 Δa g)) the one with + is the smaller positive one. That a car comes to a stand is not
    considered.
    """
    faster = np.nan_to_num(closing_faster)
    square = closing**2 + 2.0 * faster * gap
    below = closing + np.sqrt(np.maximum(square, 0.0))
    meets = (square >= 0.0) & (below > 0.0)
    return np.where(meets, 2.0 * gap / np.where(meets, below, 1.0), np.inf)


def headways(spacing: Floats, rear_speed: Floats) -> Floats:
    """Return THW = d / v_r (s, NaN: the follower stands), d in m from front to front (Vogel 2003)."""
    moves = rear_speed > MOVING_M_S
    return np.where(moves, spacing / np.where(moves, rear_speed, 1.0), np.nan)


def time_exposed(ttc: Floats, duration: Floats) -> float:
    """Return TET = Σ Δt over steps with TTC < τ, τ = 3 s (s; Minderhoud & Bovy 2001)."""
    return float(duration[ttc < EXPOSED_BELOW_S].sum())


def time_integrated(ttc: Floats, duration: Floats) -> float:
    """Return TIT = Σ (τ − TTC) Δt over steps with TTC < τ, τ = 3 s (s²; Minderhoud & Bovy 2001)."""
    exposed = ttc < EXPOSED_BELOW_S
    return float(((EXPOSED_BELOW_S - ttc[exposed]) * duration[exposed]).sum())


def short_share(headway: Floats, duration: Floats, moving_time: float) -> float | None:
    """Return Σ Δt over steps with THW < 1 s by Σ Δt over those in which the follower moves (0 to 1, None: never)."""
    return float(duration[headway < SHORT_HEADWAY_S].sum()) / moving_time if moving_time > 0.0 else None
