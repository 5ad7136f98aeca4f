"""A trial's result as plain data for files, and as lines for people."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import asdict
from typing import TYPE_CHECKING

from sumo_reactive.experiment.result import Override, TrialResult

if TYPE_CHECKING:
    from sumo_reactive.sumo.recount import Recount

Row = tuple[str, str]

_FIGURE_ROWS = (
    ("smallest time to collision", "min_time_to_collision_s", "s"),
    ("smallest post-encroachment time", "min_post_encroachment_s", "s"),
    ("hard braking caused", "hard_braking_caused", ""),
    ("largest acceleration", "max_acceleration_m_s2", "m/s²"),
    ("hardest braking", "max_braking_m_s2", "m/s²"),
    ("largest lateral acceleration", "max_lateral_acceleration_m_s2", "m/s²"),
    ("jerk (RMS)", "rms_jerk_m_s3", "m/s³"),
    ("standstill", "standstill_s", "s"),
    ("off the road", "off_road_s", "s"),
    ("emergencies", "emergencies", ""),
    ("steps without the pilot", "pilot_free_share", "%"),
)


def summary_of(result: TrialResult) -> dict[str, object]:
    """Return `summary.json` as a dictionary: units in the keys, wall-clock figures under `timing`, null for "none"."""
    plain = asdict(result)
    plain["overrides"] = overrides_of(result.overrides)
    plain["recounts"] = recounts_of(result.recounts)
    plain["collisions"] = [_faulty(one) for one in plain["collisions"]]
    plain["violations"] = [_faulty(one) for one in plain["violations"]]
    plain["hard_brakes"] = [_faulty(one) for one in plain["hard_brakes"]]
    ends = {"duration_s": result.duration_s, "verdict": result.verdict, "exit_code": result.exit_code}
    return {name: _finite(value) for name, value in (ends | plain).items()}


def rows_of(result: TrialResult) -> list[Row]:
    """Return the summary as (label, text) rows."""
    figures = result.figures
    rows = [
        ("verdict", result.verdict),
        ("ego", f"{result.ego} ({result.chosen})"),
        ("arrived", f"yes, at {result.end_s:.1f} s" if result.arrived else f"no ({result.ended})"),
        ("duration", f"{result.duration_s:.1f} s"),
        ("time loss", f"{result.time_loss_s:.1f} s"),
        ("distance", f"{result.distance_m:.0f} m"),
        ("collisions", str(len(result.collisions))),
        ("red lights run", str(figures.get("red_lights_run", 0))),
        ("right-of-way violations", str(figures.get("right_of_way_violations", 0))),
    ]
    rows += [(label, _text(figures[key], unit)) for label, key, unit in _FIGURE_ROWS if key in figures]
    return [*rows, *_timing_rows(result), *changed_rows(result.overrides, result.recounts)]


def _timing_rows(result: TrialResult) -> list[Row]:
    names = [f"control_step_{name}_us" for name in ("mean", "p99", "max")]
    timing = result.timing
    rows = []
    if all(name in timing for name in names):
        rows.append(("control step mean / p99 / max", " / ".join(f"{timing[name]:.0f}" for name in names) + " µs"))
    if "real_time_factor" in timing:
        rows.append(("real-time factor", f"{timing['real_time_factor']:.1f}"))
    return rows


def overrides_of(overrides: Iterable[Override]) -> list[dict[str, str]]:
    """Return overrides as plain data."""
    return [dict(zip(("option", "scenario", "used"), one, strict=True)) for one in overrides]


def recounts_of(recounts: Iterable[Recount]) -> list[dict[str, str]]:
    """Return what was put right in SUMO's own outputs as plain data."""
    return [one._asdict() for one in recounts]


def changed_rows(overrides: Iterable[Override], recounts: Iterable[Recount]) -> list[Row]:
    """Return what was changed in the scenario, and in SUMO's own outputs, as (label, text) rows."""
    rows = [(f"override {option}", f"{said} → {used}") for option, said, used in overrides]
    for one in recounts:
        rows.append((" ".join(filter(None, (one.file, one.vehicle, one.attribute))), f"{one.sumo} → {one.used}".lstrip()))
    return rows


def _text(value: float | int | None, unit: str) -> str:
    if value is None:
        return "none"
    if unit == "%":
        value = round(100.0 * value)
    number = str(value) if isinstance(value, int) else f"{value:.2f}"
    return f"{number} {unit}".rstrip()


def _faulty(fault: dict[str, object]) -> dict[str, object]:
    return {("time_s" if name == "time" else name): value for name, value in fault.items()}


def _finite(value: object) -> object:
    """Return `value` with None for every number that JSON cannot hold."""
    if isinstance(value, dict):
        return {name: _finite(one) for name, one in value.items()}
    return None if isinstance(value, float) and not math.isfinite(value) else value
