"""What people read in place of a metric's name, and how a number is written on a page."""

from __future__ import annotations

import math

from sumo_reactive.lab.comparison.statistics import Interval
from sumo_reactive.lab.metric_names import EVERY

_DIGITS = 4


def is_count(metric: str) -> bool:
    """Whether a metric counts something, or says yes (1) or no (0)."""
    return metric in EVERY and EVERY[metric].is_count


def title_of(metric: str) -> str:
    """Return a metric as the title of a column or an axis, with its unit; one of another release by its key."""
    return EVERY[metric].title if metric in EVERY else metric


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
