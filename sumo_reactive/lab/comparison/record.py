"""A comparison as lines for people, and as `comparison.json` and `comparison.csv` in a folder."""

from __future__ import annotations

import csv
import json
import math
from io import StringIO
from pathlib import Path

from sumo_reactive.errors import ScenarioError
from sumo_reactive.files import text_of
from sumo_reactive.lab.comparison.comparison import Comparison, MetricValue, Pair, Side
from sumo_reactive.lab.comparison.statistics import CONFIDENCE, FEW, RESAMPLES, ConfidenceInterval, PairedDifference
from sumo_reactive.lab.drivers.choice import DriverChoice
from sumo_reactive.lab.metric_names import EVERY
from sumo_reactive.writing import require_writable, whole_folder

JSON_FILE, CSV_FILE = "comparison.json", "comparison.csv"

COMPARISON_VERSION = 1
"""Version of both files: what keys and columns they have, and what these mean. A comparison of another is refused."""

JSON_MEANINGS = {
    "version": "of both files of a comparison",
    "confidence": "of the intervals, 0 to 1",
    "resamples": "of the bootstrap",
    "horizon_s": "runs end this long after the ego's departure; null: of several egos, at the scenario's end",
    "pairs_driven": "pairs in which both runs got to an end",
    "drivers": "SUMO's own, and the one that is compared",
    "metrics": "of each metric by key: n, both means, their paired difference, `low` and `high` of its interval, its method",
    "pairs": "of each pair: scenario, ego, seed, both runs with command and digest of the steps, values of each metric",
    "versions": "of this package, SUMO and the libraries that numbers depend on",
}
"""Keys of `comparison.json`."""

CSV_MEANINGS = {
    "scenario": "the scenario's file",
    "ego": "the vehicle driven; of several egos the rule that chooses them",
    "seed": "seed of both runs",
    "metric": "key of the metric",
    "sumo": "its value with SUMO's own driver; empty: none",
    "compared": "1: this value of the pair counts in the comparison, 0: it does not",
}
"""Columns of `comparison.csv` beside that of the driver that is compared, which has its name and stands before the last."""

CSV_COLUMNS = tuple(CSV_MEANINGS)

MOST_CSV_BYTES = 2**26
"""More is no comparison that anybody has driven: 64 MB hold 20,000 pairs."""

MOST_FIGURE = 1e12
"""No figure is larger; with more, means overflow."""

NO_INTERVAL = "none: n = 1"
MAX_DIGITS = 6


def head_of(comparison: Comparison) -> tuple[str, ...]:
    """Return the titles of the columns of `comparison_rows`."""
    return "", "n", "SUMO's own", called(comparison.driver), "difference", f"{100 * CONFIDENCE:g} % interval"


def called(driver: DriverChoice) -> str:
    """Return what a driver is called where people read."""
    return driver.short if driver.is_users else "this driver"


def comparison_rows(comparison: Comparison) -> list[tuple[str, ...]]:
    """Return a row for each metric that can be compared: label, n, both means, difference and its interval."""
    return [_row(name, found) for name, found in comparison.differences.items()]


def _row(name: str, found: PairedDifference) -> tuple[str, ...]:
    first, second, difference = figure_text(found.first), figure_text(found.second), signed_text(found.difference)
    return EVERY[name].title, str(found.n), first, second, difference, interval_text(found.interval)


def interval_text(interval: ConfidenceInterval | None) -> str:
    """Return the limits of a difference; None: one pair has none."""
    return NO_INTERVAL if interval is None else f"{signed_text(interval.low)} … {signed_text(interval.high)}"


def figure_text(value: float) -> str:
    """Return a number with the digits that count: two after the comma, fewer of a large one, more of a small one."""
    if value == round(value):
        return f"{value:.0f}"
    magnitude = math.floor(math.log10(abs(value)))
    digits = 1 - magnitude if magnitude < 0 else 3 - max(1, magnitude)
    return f"{value:.{min(MAX_DIGITS, max(0, digits))}f}"


def signed_text(value: float) -> str:
    """Return a difference with its sign, as `figure_text` has numbers."""
    value = round(value, MAX_DIGITS)
    return f"+{figure_text(value)}" if value > 0.0 else figure_text(value + 0.0)


def notes_of(comparison: Comparison) -> list[str]:
    """Return how the numbers are to be read, and every pair that a run failed in or whose ego did not arrive cleanly."""
    methods = {found.interval.method for found in comparison.differences.values() if found.interval}
    notes = []
    if methods:
        how = f"bootstrap ({', '.join(sorted(methods))}, {RESAMPLES} resamples) over the pairs"
        whose = f"{called(comparison.driver)} − SUMO's own"
        notes.append(f"Means over n pairs, {whose}; intervals of the mean difference: {how}.")
        if any(found.n < FEW for found in comparison.differences.values()):
            notes.append(f"Fewer than {FEW} pairs: such intervals tend to be too narrow.")
    elif comparison.differences:
        notes.append("One pair has no interval: give several egos or seeds.")
    return notes + [line for pair in comparison.pairs for line in _told(pair)]


def _told(pair: Pair) -> list[str]:
    name = f"{pair.ego} seed {pair.scenario.seed}"
    sides = (("SUMO's own driver", pair.sumo), (called(pair.scenario.driver), pair.driven))
    faulty = [f"{name}, {who}: {side.verdict}" for who, side in sides if not side.is_clean]
    return [*faulty, f"  {pair.replay}"] if not pair.driven.is_clean else faulty


def data_of(comparison: Comparison) -> dict[str, object]:
    """Return `comparison.json` as a dictionary: units in the keys, null for what there is not."""
    return {
        "version": COMPARISON_VERSION,
        "confidence": CONFIDENCE,
        "resamples": RESAMPLES,
        "horizon_s": comparison.horizon_s,
        "pairs_driven": len(comparison.pairs) - len(comparison.failed),
        "drivers": ["sumo", str(comparison.driver)],
        "metrics": {name: _difference(found, str(comparison.driver)) for name, found in comparison.differences.items()},
        "pairs": [_pair(pair, str(comparison.driver)) for pair in comparison.pairs],
        "versions": next((dict(one.versions) for p in comparison.pairs if (one := p.driven.outcome.judged)), {}),
    }


def _difference(found: PairedDifference, name: str) -> dict[str, object]:
    interval = found.interval
    return {
        "n": found.n,
        "sumo": found.first,
        name: found.second,
        "difference": found.difference,
        "low": interval.low if interval else None,
        "high": interval.high if interval else None,
        "method": interval.method if interval else None,
    }


def _pair(pair: Pair, name: str) -> dict[str, object]:
    asked = pair.scenario
    return {
        "scenario": str(asked.source),
        "ego": pair.ego,
        "seed": asked.seed,
        "sumo": _side(pair.sumo) | {"command": pair.plain_sumo},
        name: _side(pair.driven) | {"command": pair.replay},
        "metrics": {metric: {"sumo": one, name: other} for metric, (one, other) in pair.metrics.items()},
    }


def _side(side: Side) -> dict[str, object]:
    result, judged = side.result, side.outcome.judged
    told: dict[str, object] = {"ending": side.outcome.ending.value, "verdict": side.verdict}
    if judged is None:
        return told
    times = {"departure_s": result.departure_s, "end_s": result.end_s} if result else {}
    return told | {"trajectory": side.outcome.trajectory, **times, "figures": judged.metrics}


def csv_of(comparison: Comparison) -> str:
    """Return `comparison.csv`: a line for each metric of each pair, empty cells for what there is not."""
    text = StringIO()
    lines = csv.writer(text, lineterminator="\n")
    lines.writerow((*CSV_COLUMNS[:-1], str(comparison.driver), CSV_COLUMNS[-1]))
    for pair in comparison.pairs:
        for name, (one, other) in pair.metrics.items():
            is_compared = int(pair.of(name) is not None)
            lines.writerow((pair.scenario.source, pair.ego, pair.scenario.seed, name, _cell(one), _cell(other), is_compared))
    return text.getvalue()


def _cell(value: MetricValue) -> MetricValue | str:
    return "" if value is None else value


def recorded_pairs(folder: Path) -> dict[str, list[tuple[float, float]]]:
    """Return for each metric of a comparison's folder the values of each pair, SUMO's own driver's and the other's, where
    they can be compared. Raises ScenarioError for what is no such folder."""
    path = folder / CSV_FILE
    lines = csv.DictReader(text_of(path, most=MOST_CSV_BYTES).splitlines())
    if not set(CSV_COLUMNS) <= set(lines.fieldnames or ()):
        raise ScenarioError(f"{path}: not the pairs of a comparison: its first line lacks some of {', '.join(CSV_COLUMNS)}")
    others = [name for name in lines.fieldnames or () if name not in CSV_COLUMNS]
    if len(others) != 1:
        raise ScenarioError(f"{path}: not the pairs of a comparison: {len(others)} columns of drivers beside SUMO's own")
    found: dict[str, list[tuple[float, float]]] = {}
    for line in lines:
        if line["compared"] != "1":
            continue
        try:
            one, other = float(line["sumo"]), float(line[others[0]])
        except (TypeError, ValueError):
            one = other = math.nan
        if line["metric"] not in EVERY or not abs(one) + abs(other) < MOST_FIGURE:
            raise ScenarioError(f"{path}:{lines.line_num}: not a metric with two numbers")
        found.setdefault(line["metric"], []).append((one, other))
    return found


def require_usable(folder: Path, overwrite: bool) -> None:
    """Raise OutputError if the folder cannot be written to, ScenarioError if its comparison may not be replaced."""
    require_writable(folder, is_folder=True)
    found = [name for name in (JSON_FILE, CSV_FILE) if (folder / name).exists()]
    if found and not overwrite:
        raise ScenarioError(f"{folder}: holds another comparison ({', '.join(found)}); use --overwrite or another folder")


def write(comparison: Comparison, folder: Path) -> None:
    """Write both files, or none; raise OutputError if that cannot be done."""
    data = json.dumps(data_of(comparison), indent=2, ensure_ascii=False, allow_nan=False)
    with whole_folder(folder, JSON_FILE) as partial:
        (partial / CSV_FILE).write_text(csv_of(comparison), encoding="utf-8", errors="backslashreplace")
        (partial / JSON_FILE).write_text(data + "\n", encoding="utf-8", errors="backslashreplace")
