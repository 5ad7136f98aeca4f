"""Responsibility-Sensitive Safety: the distances ahead and to the side that it asks for (Shalev-Shwartz et al. 2017)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sumo_reactive.driver.geometry.polyline import Floats


@dataclass(frozen=True, slots=True)
class RssParameters:
    """What the paper leaves open: response times ρ (s), accelerations (m/s²), lateral margin μ (m).

    The values are those that Intel's ad-rss-lib proposes (its "Parameter Discussion").
    """

    ego_response_s: float = 1.0
    other_response_s: float = 2.0
    accel_max_m_s2: float = 3.5
    brake_min_m_s2: float = 4.0
    brake_max_m_s2: float = 8.0
    lateral_accel_max_m_s2: float = 0.2
    lateral_brake_min_m_s2: float = 0.8
    lateral_margin_m: float = 0.1


RSS = RssParameters()
"""Those that all figures are made with."""


def longitudinal_distance(rear_speed: Floats, front_speed: Floats, response_s: float) -> Floats:
    """Return d = [v_r ρ + ½ a ρ² + (v_r + ρ a)² / (2 b_min) − v_f² / (2 b_max)]₊, the follower's distance
    (m; Shalev-Shwartz et al. 2017).

    Speeds in m/s along the way, ρ the follower's response time, during which he accelerates by a; then he brakes by b_min at
    least, the one ahead by b_max at most.
    """
    speed = rear_speed + response_s * RSS.accel_max_m_s2
    way = rear_speed * response_s + 0.5 * RSS.accel_max_m_s2 * response_s**2 + speed**2 / (2.0 * RSS.brake_min_m_s2)
    return np.maximum(way - np.square(front_speed) / (2.0 * RSS.brake_max_m_s2), 0.0)


def lateral_distance(approach: Floats) -> Floats:
    """Return d = μ + [r(0, ρ_ego) + r(w, ρ_other)]₊, the room to keep to the side (m; Shalev-Shwartz et al. 2017).

    r(w, ρ) = (w + w′) ρ / 2 + w′ |w′| / (2 b), w′ = w + ρ a: how far who nears at w (m/s) still comes, accelerating by a to
    that side for ρ and then braking by b until he does not move sideways. The ego does not move sideways on
    its own way.
    """
    ego, other = _sideways(np.zeros_like(approach), RSS.ego_response_s), _sideways(approach, RSS.other_response_s)
    return RSS.lateral_margin_m + np.maximum(ego + other, 0.0)


def _sideways(speed: Floats, response_s: float) -> Floats:
    then = speed + response_s * RSS.lateral_accel_max_m_s2
    way: Floats = 0.5 * (speed + then) * response_s + then * np.abs(then) / (2.0 * RSS.lateral_brake_min_m_s2)
    return way
