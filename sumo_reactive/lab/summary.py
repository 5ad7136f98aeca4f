"""A trial's result as plain data for files, and as lines for people."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import asdict
from typing import TYPE_CHECKING

from sumo_reactive.driver.nouns.event import EventKind
from sumo_reactive.lab.metric_names import METRICS, TIMINGS, event_key
from sumo_reactive.lab.result import Override, TrialResult

if TYPE_CHECKING:
    from sumo_reactive.sumo.recount import Recount

Row = tuple[str, str]

_NOT_SHOWN = {"arrived", "violations", "min_time_to_collision_at_s", *map(event_key, EventKind)}
"""Told otherwise, or too much on a terminal."""


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
    rows = [
        ("verdict", result.verdict),
        ("ego", f"{result.ego} ({result.chosen})"),
        (METRICS["arrived"].label, f"yes, at {result.end_s:.1f} s" if result.arrived else f"no ({result.ended})"),
    ]
    figures = {**result.metrics, **result.timing}
    shown = (metric for metric in (*METRICS.values(), *TIMINGS.values()) if metric.key not in _NOT_SHOWN)
    rows += [(metric.label, metric.text(figures[metric.key])) for metric in shown if metric.key in figures]
    return [*rows, *changed_rows(result.overrides, result.recounts)]


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


def _faulty(fault: dict[str, object]) -> dict[str, object]:
    return {("time_s" if name == "time" else name): value for name, value in fault.items()}


def _finite(value: object) -> object:
    """Return `value` with None for every number that JSON cannot hold."""
    if isinstance(value, dict):
        return {name: _finite(one) for name, one in value.items()}
    return None if isinstance(value, float) and not math.isfinite(value) else value
