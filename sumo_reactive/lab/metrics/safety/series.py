"""Every measure of every encounter over time, as columns of one table."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sumo_reactive.driver.geometry.polyline import Floats
from sumo_reactive.lab.metrics.encounters import NO_CONFLICT_S
from sumo_reactive.lab.metrics.moment import meetings
from sumo_reactive.lab.metrics.safety.deceleration import drac, mdrac, safety_time_deceleration
from sumo_reactive.lab.metrics.safety.following import headways, modified_ttc, ttc_along
from sumo_reactive.lab.metrics.safety.pairs import AHEAD, BEHIND, BESIDE, OTHERWISE, RELATIONS, PairLog, Pairs
from sumo_reactive.lab.metrics.safety.rss import RSS, lateral_distance, longitudinal_distance

Columns = Mapping[str, NDArray[Any]]
"""Arrays of one length by name, units in the names."""

ENCOUNTER_MEANINGS = {
    "time_s": "simulation time at the end of the step",
    "user_id": "id of the other",
    "relation": "how he meets the ego: ahead, behind, beside or otherwise",
    "gap_m": "room along the way between both bodies, of who is ahead or behind",
    "lateral_gap_m": "room to the side between both bodies",
    "ego_speed_m_s": "speed along the way",
    "user_speed_m_s": "speed along the way",
    "time_to_collision_s": "until the bodies touch in the plane if both keep their velocities; below 10 s",
    "ttc_along_s": "the same along the way, of who is ahead or behind, as are the next five",
    "modified_ttc_s": "if both keep their accelerations",
    "drac_m_s2": "deceleration that avoids a crash",
    "mdrac_m_s2": "the same after a reaction time of 1 s; 99: nothing is enough",
    "dst_m_s2": "deceleration that keeps 1 s to the one ahead",
    "time_headway_s": "front to front",
    "rss_distance_m": "what RSS asks for: along the way, of who is beside to the side",
    "rss_margin_m": "what there is, less that",
}
"""Columns of an encounter's row; NULL where a pair has no such measure."""


def following_columns(pairs: Pairs) -> dict[str, Floats]:
    """Return the measures of pairs of which one follows the other (NaN: there is none)."""
    follows = pairs.relation == AHEAD
    rear_speed = np.where(follows, pairs.ego_speed, pairs.user_speed)
    front_speed = np.where(follows, pairs.user_speed, pairs.ego_speed)
    faster = (pairs.ego_acceleration - pairs.user_acceleration) * np.where(follows, 1.0, -1.0)
    gap, closing = pairs.gap, rear_speed - front_speed
    return {
        "ttc_along_s": _finite(ttc_along(gap, rear_speed, front_speed)),
        "modified_ttc_s": _finite(modified_ttc(gap, closing, faster)),
        "drac_m_s2": drac(gap, closing),
        "mdrac_m_s2": mdrac(gap, closing),
        "dst_m_s2": safety_time_deceleration(gap, closing, front_speed),
        "time_headway_s": headways(np.abs(pairs.spacing), rear_speed),
        "rss_distance_m": np.where(
            follows,
            longitudinal_distance(rear_speed, front_speed, RSS.ego_response_s),
            longitudinal_distance(rear_speed, front_speed, RSS.other_response_s),
        ),
    }


def encounter_columns(log: PairLog, length: float, width: float) -> Columns:
    """Return a row a pair and step for an ego of this size (m), by time and user; NaN where a pair has no such measure.

    Pairs: whom the ego follows, who follows it, who is beside it, and with whom it is on collision course.
    """
    pairs, boxes = log.pairs(length, width), log.boxes
    ego = log.ego[pairs.step.astype(np.int64), 1:5]
    times = meetings(np.column_stack((ego, np.tile((length, width), (len(ego), 1)))), boxes)
    shown = (pairs.relation != OTHERWISE) | (times < NO_CONFLICT_S)
    pairs, times, ids = pairs.only(shown), times[shown], log.ids
    follow = (pairs.relation == AHEAD) | (pairs.relation == BEHIND)
    columns = {name: np.where(follow, column, np.nan) for name, column in following_columns(pairs).items()}
    beside = pairs.relation == BESIDE
    columns["rss_distance_m"] = np.where(beside, lateral_distance(pairs.approach), columns["rss_distance_m"])
    return {
        "time_s": pairs.time,
        "user_id": np.array([ids[int(row)] for row in pairs.row], dtype=object),
        "relation": np.array([RELATIONS[int(one)] for one in pairs.relation], dtype=object),
        "gap_m": np.where(follow, pairs.gap, np.nan),
        "lateral_gap_m": pairs.lateral_gap,
        "ego_speed_m_s": pairs.ego_speed,
        "user_speed_m_s": pairs.user_speed,
        "time_to_collision_s": np.where(times < NO_CONFLICT_S, times, np.nan),
        **columns,
        "rss_margin_m": np.where(beside, pairs.lateral_gap, pairs.gap) - columns["rss_distance_m"],
    }


def _finite(times: Floats) -> Floats:
    return np.where(np.isfinite(times), times, np.nan)
