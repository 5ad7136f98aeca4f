"""What people read in place of a metric's name, and how a number is written on a page."""

from __future__ import annotations

import math
import re

from sumo_reactive.experiment.comparison.record import LABELS
from sumo_reactive.experiment.comparison.statistics import Interval
from sumo_reactive.experiment.metric_names import METRICS

_UNITS = {"_m_s2": "m/s²", "_m_s3": "m/s³", "_s": "s", "_m": "m", "_us": "µs"}
"""Unit by the ending of a metric's name; a longer ending comes first."""

_DIGITS = 4


_SHARES = ("pilot_free_share",)


def is_count(metric: str) -> bool:
    """Whether a metric counts something, or says yes (1) or no (0)."""
    return metric not in _SHARES and not any(metric.endswith(ending) for ending in _UNITS)


def title_of(metric: str) -> str:
    """Return a metric as the title of a column or an axis, with its unit."""
    if metric in LABELS:
        label, unit = LABELS[metric]
        return _with_unit(re.sub(r"^\w+: ", "", label), unit)
    unit = next((unit for ending, unit in _UNITS.items() if metric.endswith(ending)), "")
    return _with_unit(METRICS.get(metric, metric.replace("_", " ")), unit)


def number(value: float | None) -> str:
    """Return a number with the digits that count, a dash for none."""
    if value is None or not math.isfinite(value):
        return "–"
    if value == round(value) and abs(value) < 10**_DIGITS * 100:
        return f"{value:.0f}".replace("-", "−")
    return f"{value:.{_DIGITS}g}".replace("-", "−")


def signed(value: float) -> str:
    """Return a difference with its sign."""
    return f"+{number(value)}" if value > 0.0 else number(value + 0.0)


def limits(interval: Interval | None, *, is_difference: bool = False) -> str:
    """Return an interval, or that there is none."""
    if interval is None:
        return "none: n = 1"
    told = signed if is_difference else number
    return f"{told(interval.low)} … {told(interval.high)}"


def _with_unit(label: str, unit: str) -> str:
    return f"{label} ({unit})" if unit else label
