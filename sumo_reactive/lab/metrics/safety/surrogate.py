"""The judge that keeps every encounter, and sums up a trip in the extremes, shares and times of its measures."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sumo_reactive.driver.geometry.polyline import Floats
from sumo_reactive.lab.metrics.encounters import NO_CONFLICT_S
from sumo_reactive.lab.metrics.moment import Figures, Moment
from sumo_reactive.lab.metrics.safety.following import MOVING_M_S, short_share, time_exposed, time_integrated
from sumo_reactive.lab.metrics.safety.pairs import AHEAD, BEHIND, BESIDE, PairLog, Pairs
from sumo_reactive.lab.metrics.safety.rss import lateral_distance
from sumo_reactive.lab.metrics.safety.series import Columns, encounter_columns, following_columns


class SurrogateSafety:
    """What the ego is as a follower, what it asks of who follows it, and how long it is nearer than RSS allows."""

    def __init__(self, length: float, width: float) -> None:
        self._size, self._log = (length, width), PairLog()

    def see(self, moment: Moment) -> None:
        """Keep one step."""
        self._log.see(moment)

    @property
    def encounters(self) -> Columns:
        """Every measure of every encounter over time."""
        return encounter_columns(self._log, *self._size)

    def figures(self) -> Figures:
        """Return the figures of the trip: no smallest, None, and no deceleration needed, 0, where nobody was met so."""
        pairs = self._log.pairs(*self._size)
        ahead, behind, beside = (pairs.that_are(relation) for relation in (AHEAD, BEHIND, BESIDE))
        own = following_columns(ahead)
        lasted = np.nan_to_num(ahead.duration)
        exposed = np.nan_to_num(own["ttc_along_s"], nan=np.inf)
        rss_ahead = ahead.gap - own["rss_distance_m"]
        rss_beside = beside.lateral_gap - lateral_distance(beside.approach)
        headway, modified = own["time_headway_s"], own["modified_ttc_s"]
        time, speed = self._log.ego[:, 5], self._log.ego[:, 4]
        moving_time = float(np.nan_to_num(time[speed > MOVING_M_S]).sum())
        return {
            "min_modified_ttc_s": _least(modified[modified < NO_CONFLICT_S]),
            "max_drac_m_s2": _most(own["drac_m_s2"]),
            "max_mdrac_m_s2": _most(own["mdrac_m_s2"]),
            "max_dst_m_s2": _most(own["dst_m_s2"]),
            "max_drac_of_follower_m_s2": _most(following_columns(behind)["drac_m_s2"]),
            "min_time_headway_s": _least(headway),
            "short_headway_share": _rounded(short_share(headway, lasted, moving_time)),
            "time_exposed_ttc_s": _rounded(time_exposed(exposed, lasted)),
            "time_integrated_ttc_s2": _rounded(time_integrated(exposed, lasted)),
            "min_rss_longitudinal_margin_m": _least(rss_ahead[ahead.ego_speed > MOVING_M_S]),
            "min_rss_lateral_margin_m": _least(rss_beside[beside.ego_speed > MOVING_M_S]),
            "rss_violation_s": _time_of((ahead, rss_ahead < 0.0), (beside, rss_beside < 0.0)),
        }


def _time_of(*found: tuple[Pairs, NDArray[np.bool_]]) -> float:
    """Return the time (s) of the steps in which the ego moves and one of the pairs is among those marked."""
    marked = [pairs.only(those & (pairs.ego_speed > MOVING_M_S)) for pairs, those in found]
    steps, first = np.unique(np.concatenate([pairs.step for pairs in marked]), return_index=True)
    durations = np.concatenate([pairs.duration for pairs in marked])[first]
    return round(float(np.nan_to_num(durations).sum()), 3) if len(steps) else 0.0


def _least(values: Floats) -> float | None:
    known = values[np.isfinite(values)]
    return _rounded(float(known.min())) if len(known) else None


def _most(decelerations: Floats) -> float:
    return round(float(np.nanmax(decelerations, initial=0.0)), 3)


def _rounded(value: float | None) -> float | None:
    return None if value is None else round(value, 3)
