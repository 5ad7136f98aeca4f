"""A trial's result as plain data for files, and as lines for people."""

from __future__ import annotations

import math
from dataclasses import asdict

from sumo_reactive.experiment.metric_names import METRICS, TIMINGS, event_key
from sumo_reactive.experiment.result import TrialResult
from sumo_reactive.messages.event import EventKind

Row = tuple[str, str]

_NOT_SHOWN = {"arrived", "violations", "min_time_to_collision_at_s", *map(event_key, EventKind)}
"""Told otherwise, or too much on a terminal."""


def summary_of(result: TrialResult) -> dict[str, object]:
    """Return `summary.json` as a dictionary: units in the keys, wall-clock figures under `timing`, null for "none"."""
    plain = asdict(result)
    plain["overrides"] = [dict(zip(("option", "scenario", "used"), one, strict=True)) for one in result.overrides]
    plain["collisions"] = [_faulty(one) for one in plain["collisions"]]
    plain["violations"] = [_faulty(one) for one in plain["violations"]]
    plain["hard_brakes"] = [_faulty(one) for one in plain["hard_brakes"]]
    ends = {"duration_s": result.duration_s, "verdict": result.verdict, "exit_code": result.exit_code}
    return {name: _finite(value) for name, value in (ends | plain).items()}


def rows_of(result: TrialResult) -> list[Row]:
    """Return the summary as (label, text) rows."""
    rows = [
        ("verdict", result.verdict),
        ("ego", f"{result.ego} ({result.chosen})"),
        (METRICS["arrived"].label, f"yes, at {result.end_s:.1f} s" if result.arrived else f"no ({result.ended})"),
    ]
    figures = {**result.metrics, **result.timing}
    shown = (metric for metric in (*METRICS.values(), *TIMINGS.values()) if metric.key not in _NOT_SHOWN)
    rows += [(metric.label, metric.text(figures[metric.key])) for metric in shown if metric.key in figures]
    return [*rows, *_override_rows(result)]


def _override_rows(result: TrialResult) -> list[Row]:
    return [(f"override {option}", f"{said} → {used}") for option, said, used in result.overrides]


def _faulty(fault: dict[str, object]) -> dict[str, object]:
    return {("time_s" if name == "time" else name): value for name, value in fault.items()}


def _finite(value: object) -> object:
    """Return `value` with None for every number that JSON cannot hold."""
    if isinstance(value, dict):
        return {name: _finite(one) for name, one in value.items()}
    return None if isinstance(value, float) and not math.isfinite(value) else value
