"""Every figure of a trial and of a comparison, once: its key, what people read in place of it, its unit, what it means."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial

from sumo_reactive.driver.nouns.event import EventKind


@dataclass(frozen=True, slots=True)
class Metric:
    """One figure: `key` in files and queries, `label` and `unit` (empty: none) for people, `meaning` in a line.

    `digits` are those after the point of a single value; None: it is a count, or 1 for yes and 0 for no, and `one` is what
    one of those counted is called. `is_shown`: a run tells it on the terminal, unasked, as it does all that needs no chosen
    threshold or model to be read; the rest is in files, stores and reports.
    """

    key: str
    label: str
    unit: str
    meaning: str
    digits: int | None = 2
    one: str = ""
    is_shown: bool = True

    @property
    def is_count(self) -> bool:
        """Whether it counts something, or says yes (1) or no (0)."""
        return self.digits is None

    @property
    def title(self) -> str:
        """The title of a column or an axis."""
        return f"{self.label} ({self.unit})" if self.unit else self.label

    def text(self, value: float | None) -> str:
        """Return a value with its unit; None: there is none."""
        if value is None:
            return "none"
        number = f"{value:.0f}" if self.digits is None else f"{value:.{self.digits}f}"
        return f"{number} {self.unit}".rstrip()

    def counted(self, count: int) -> str:
        """Return how many there are: "1 emergency", "2 emergencies"."""
        return f"{count} {self.one if count == 1 else self.label}"


def event_key(kind: EventKind) -> str:
    """Return the key of the figure that counts a kind of event."""
    return f"events_{kind.name.lower()}"


_model = partial(Metric, is_shown=False)
"""A figure that needs a threshold or a model to be read, or one of too many."""


def _by_key(*metrics: Metric) -> dict[str, Metric]:
    return {metric.key: metric for metric in metrics}


_EMERGENCY = "harder than planned, or with no admissible command left"
"""Planned: 3 m/s², at most the type's `decel`; with the paper's nine commands that `decel`."""

METRICS: Mapping[str, Metric] = _by_key(
    Metric("arrived", "arrived", "", "1 if the ego has arrived, else 0", None, is_shown=False),
    Metric("duration_s", "duration", "s", "time from departure to arrival, or to the end of the run", 1),
    Metric("time_loss_s", "time loss", "s", "time lost by driving slower than the road allows", 1),
    Metric("distance_m", "distance", "m", "way driven", 0),
    _model("driving_score", "driving score", "", "0 to 1, after nuPlan's closed-loop score: its parts by their weights"),
    _model("progress_score", "score of progress", "", "share of the time that is not lost, 0 to 1"),
    Metric("collisions", "collisions", "", "contacts of the ego's box with another", None, "collision"),
    Metric("violations", "violations", "", "red lights run and rights of way taken", None, "violation", False),
    Metric("red_lights_run", "red lights run", "", "stop lines crossed on a letter that forbids it", None, "red light run"),
    Metric(
        "right_of_way_violations", "rights of way taken", "", "users with priority that the ego obstructed", None,
        "right of way taken",
    ),
    Metric("min_time_to_collision_s", "smallest time to collision", "s", "if both kept their velocities; below 10 s"),
    Metric(
        "min_time_to_collision_at_s", "time of the smallest time to collision", "s", "simulation time at which that was", 1,
        is_shown=False,
    ),
    _model(
        "near_misses_by_ttc", "near misses by time to collision", "",
        "users with whom it was below 1.5 s while the ego moved, but for oncoming ones", None,
    ),
    Metric(
        "min_post_encroachment_s", "smallest post-encroachment time", "s",
        "from when one leaves a place to when the other enters it; below 10 s",
    ),
    _model(
        "near_misses_by_pet", "near misses by post-encroachment time", "", "users with whom it was below 1.5 s", None,
    ),
    _model(
        "min_modified_ttc_s", "smallest modified time to collision", "s",
        "behind the one ahead, if both kept their accelerations; below 10 s",
    ),
    Metric("max_drac_m_s2", "largest DRAC", "m/s²", "needed to avoid a crash with the one ahead who keeps his speed"),
    _model("max_mdrac_m_s2", "largest MDRAC", "m/s²", "the same after a reaction time of 1 s; 99: nothing is enough"),
    _model("max_dst_m_s2", "largest deceleration to safety time", "m/s²", "to come no nearer than 1 s behind the one ahead"),
    _model("max_drac_of_follower_m_s2", "follower's largest DRAC", "m/s²", "what the ego asks of who follows it"),
    Metric("min_time_headway_s", "smallest time headway", "s", "front to front behind the one ahead, while the ego moves"),
    _model("short_headway_share", "share of short headways", "", "of the time in which the ego moves, 0 to 1; below 1 s"),
    _model("time_exposed_ttc_s", "time-exposed time to collision", "s", "time with less than 3 s to the one ahead"),
    _model("time_integrated_ttc_s2", "time-integrated time to collision", "s²", "what it lacks of 3 s, over time"),
    _model(
        "min_rss_longitudinal_margin_m", "smallest RSS margin ahead", "m", "gap less the distance that RSS asks for",
    ),
    _model("min_rss_lateral_margin_m", "smallest RSS margin beside", "m", "room less the distance that RSS asks for"),
    _model("rss_violation_s", "time in violation of RSS", "s", "time with one of them negative while the ego moves"),
    Metric(
        "hard_braking_caused", "hard brakings caused", "", "vehicles behind the ego that began to brake below −4.6 m/s²",
        None, "hard braking caused",
    ),
    Metric("max_acceleration_m_s2", "largest acceleration", "m/s²", "from step to step"),
    Metric("max_braking_m_s2", "hardest braking", "m/s²", "from step to step, positive"),
    Metric("max_lateral_acceleration_m_s2", "largest lateral acceleration", "m/s²", "at the front axle"),
    Metric("rms_jerk_m_s3", "RMS jerk", "m/s³", "root mean square of the change of the acceleration from step to step"),
    Metric("standstill_s", "standstill", "s", "time slower than 0.1 m/s"),
    Metric("off_road_s", "time on no lane", "s", "as SUMO maps the ego"),
    Metric("emergencies", "emergencies", "", f"times that the ego began to brake {_EMERGENCY}", None, "emergency"),
    Metric("emergency_s", "time in emergencies", "s", f"time during which the ego braked {_EMERGENCY}"),
    _model("max_yaw_rate_rad_s", "largest yaw rate", "rad/s", "smoothed over 15 steps"),
    _model("max_yaw_acceleration_rad_s2", "largest yaw acceleration", "rad/s²", "smoothed over 15 steps"),
    _model("max_longitudinal_jerk_m_s3", "largest longitudinal jerk", "m/s³", "smoothed over 15 steps"),
    _model("max_jerk_m_s3", "largest jerk", "m/s³", "smoothed over 15 steps, along and across"),
    _model("comfort_score", "score of comfort", "", "1 if all is within nuPlan's bounds, else 0", None),
    _model("ttc_score", "score of the time to collision", "", "1 if it is never below 0.95 s to one in front, else 0", None),
    _model("speed_limit_score", "score of the speed limit", "", "1 less the overspeed by 2.23 m/s, on average, 0 to 1"),
    Metric("pilot_activations", "activations of the pilot", "", "runs of the pilot, and so of the highway code", None),
    Metric("pilot_free_share", "steps without the pilot", "", "share in which it did not run, 0 to 1"),
    *(_model(event_key(kind), f"event: {kind.value}", "", "how often this activated the pilot", None) for kind in EventKind),
)  # fmt: skip
"""What a trial gives again with the same seed, in the order in which it is shown."""

BASELINE: Mapping[str, Metric] = _by_key(
    Metric("teleports", "teleports of the ego", "", "times that SUMO moved its own driver's car out of a jam", None),
)
"""What only SUMO's own driver has."""

OTHERS: Mapping[str, Metric] = _by_key(
    Metric("others_vehicles", "other vehicles", "", "on the road when the ego departs, or later", None),
    Metric("others_arrived", "others arrived", "", "by the end of the window", None),
    Metric("others_time_loss_s", "others' time loss", "s", "sum"),
    Metric("others_insertion_delay_s", "others' waiting to depart", "s", "sum"),
    Metric("others_mean_duration_s", "others' mean duration", "s", "mean of those who arrived in both runs"),
    Metric("others_mean_waiting_s", "others' mean standstill", "s", "mean of those who arrived in both runs"),
    Metric("others_stops", "others' stops", "", "times that one came to a stand", None),
    Metric("others_distance_km", "others' distance", "km", "sum"),
    Metric("others_co2_kg", "others' CO₂", "kg", "sum"),
    Metric("others_co2_g_per_km", "others' CO₂ per km", "g/km", "sum over sum"),
    Metric("others_fuel_kg", "others' fuel", "kg", "sum"),
    Metric("others_nox_g", "others' NOx", "g", "sum"),
    Metric("others_collisions", "others' collisions", "", "among themselves", None),
    Metric("others_teleports", "others' teleports", "", "as SUMO counts them", None),
)
"""What a comparison says of everybody but the ego, from its departure to the end of the window."""

NETWORK: Mapping[str, Metric] = _by_key(
    Metric("egos", "egos", "", "vehicles driven by this project's driver", None),
    Metric("egos_arrived", "egos arrived", "", "by the end of the run", None),
    Metric("egos_mean_duration_s", "egos' mean duration", "s", "mean of those who arrived", 1),
    Metric("egos_mean_time_loss_s", "egos' mean time loss", "s", "mean of those who arrived", 1),
    Metric("egos_collisions", "egos' collisions", "", "contacts of egos with others, each once", None, "ego's collision"),
    Metric("egos_violations", "egos' violations", "", "red lights run and rights of way taken", None, "ego's violation"),
    Metric("egos_hard_braking_caused", "egos' hard brakings caused", "", "by all egos, of vehicles behind them", None),
    Metric("egos_near_misses_by_ttc", "egos' near misses by TTC", "", "by all egos: time to collision below 1.5 s", None),
    Metric("egos_near_misses_by_pet", "egos' near misses by PET", "", "by all egos: post-encroachment below 1.5 s", None),
    Metric("egos_near_misses_per_km", "egos' near misses per km", "1/km", "of both kinds, by the way that all egos drove"),
    Metric("network_vehicles", "vehicles", "", "that have departed by the end of the run, egos included", None),
    Metric("network_arrived", "vehicles arrived", "", "by the end of the run", None),
    Metric("network_arrivals_per_h", "arrivals", "1/h", "throughput of the network, over the whole run", 1),
    Metric("network_mean_duration_s", "mean duration", "s", "mean of the vehicles that arrived", 1),
    Metric("network_mean_speed_m_s", "mean speed", "m/s", "way by time, summed over all that have departed"),
    Metric("network_mean_time_loss_s", "mean time loss", "s", "mean of all that have departed", 1),
    Metric("network_mean_waiting_s", "mean standstill", "s", "mean of all that have departed", 1),
    Metric("network_mean_insertion_delay_s", "mean waiting to depart", "s", "mean of all that were due", 1),
    Metric("network_stops_per_vehicle", "stops a vehicle", "", "times that it came to a stand"),
    Metric("network_co2_g_per_km", "CO₂ per km", "g/km", "sum over sum, by SUMO's own models", 1),
    Metric("network_fuel_g_per_km", "fuel per km", "g/km", "sum over sum, by SUMO's own models", 1),
    Metric("network_collisions", "collisions in the network", "", "as SUMO counts them", None),
    Metric("network_teleports", "teleports", "", "as SUMO counts them", None),
)
"""What a run with a share of egos says of them all, and of all vehicles together."""

DIAGRAM: Mapping[str, Metric] = _by_key(
    Metric("flow_per_h", "flow", "veh/h per lane", "way driven by time watched and length of the lanes", 1),
    Metric("density_per_km", "density", "veh/km per lane", "time spent by time watched and length of the lanes", 1),
    Metric("speed_m_s", "space-mean speed", "m/s", "way driven by time spent"),
)
"""What the fundamental diagram tells of a group of edges in an interval."""

IN_BATCHES: Mapping[str, Metric] = {**METRICS, **NETWORK}
"""What a trial of a batch may have."""

TIMINGS: Mapping[str, Metric] = _by_key(
    Metric("control_step_mean_us", "control step, mean", "µs", "wall-clock time", 0),
    Metric("control_step_p99_us", "control step, 99th percentile", "µs", "wall-clock time", 0),
    Metric("control_step_max_us", "control step, longest", "µs", "wall-clock time", 0),
    Metric("real_time_factor", "real-time factor", "", "simulated time by wall-clock time", 1),
)
"""Wall-clock figures, which differ from run to run."""

EVERY: Mapping[str, Metric] = {**METRICS, **BASELINE, **OTHERS, **NETWORK, **TIMINGS}
"""All of them by key."""

UNITS: Mapping[str, str] = {
    "_g_per_km": "g/km", "_per_km": "1/km", "_per_h": "1/h", "_m_s2": "m/s²", "_m_s3": "m/s³", "_m_s": "m/s",
    "_rad_s2": "rad/s²", "_rad_s": "rad/s", "_rad": "rad", "_s2": "s²",
    "_us": "µs", "_km": "km", "_kg": "kg", "_s": "s", "_m": "m", "_g": "g",
}  # fmt: skip
"""Units by the ending of a key; a longer ending comes first."""

_UNITS_OF_WORDS = {
    "deceleration": "m/s²", "acceleration": "m/s²", "_in_plan": "m/s²", "_jerk": "m/s³", "_speed": "m/s",
    "_tolerance": "m/s", "_by": "m/s", "_rate": "rad/s", "_attraction": "1/m", "_scale": "s", "_growth": "s²/m",
}  # fmt: skip


def unit_of_parameter(name: str) -> str:
    """Return the unit of a parameter of the driver, told by the end of its name; empty for a share, a factor, a number."""
    return next((unit for ending, unit in {**UNITS, **_UNITS_OF_WORDS}.items() if name.endswith(ending)), "")


_CUT = re.compile(r"cut_(\w+)_per_h")


def cut_key(name: str) -> str:
    """Return the key of the metric that tells of the throughput of a cut through a network."""
    return f"cut_{name}_per_h"


def metric_of(key: str) -> Metric:
    """Return the metric of a key; one of a user's own is called by its name, which ends in its unit."""
    if key in EVERY:
        return EVERY[key]
    if cut := _CUT.fullmatch(key):
        return Metric(key, f"throughput of '{cut[1]}'", "1/h", "vehicles that pass the middle of its edges", 1)
    ending = next((one for one in UNITS if key.endswith(one)), "")
    return Metric(key, key, UNITS.get(ending, ""), "a metric of one's own", 3)
