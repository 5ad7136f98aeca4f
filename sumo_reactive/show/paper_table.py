"""Effects as a table for a paper: LaTeX, Markdown or CSV."""

from __future__ import annotations

import csv
from collections.abc import Collection, Iterator, Mapping, Sequence
from enum import Enum
from io import StringIO
from pathlib import Path

from sumo_reactive.errors import ScenarioError
from sumo_reactive.lab.batch.stored_results import Results
from sumo_reactive.lab.comparison.comparison import EGO_METRICS
from sumo_reactive.lab.comparison.record import figure_text, interval_text, recorded_pairs, signed_text
from sumo_reactive.lab.comparison.statistics import CONFIDENCE, Effect, effects_among
from sumo_reactive.lab.metric_names import EVERY, metric_of
from sumo_reactive.lab.schema import nearest
from sumo_reactive.show.batch_trials import pairs_of, trials_in

TITLES = (
    "metric", "n", "SUMO's own", "this driver", "difference", f"{100 * CONFIDENCE:g} % interval", "effect size", "p",
    "corrected p",
)  # fmt: skip
"""Titles of the columns."""

NOTE = (
    "n pairs of the same trip with the same seed; differences are this driver's less SUMO's own, their intervals by "
    "bootstrap; effect size: mean difference over its standard deviation; p by flipping signs, corrected for all metrics "
    "(Benjamini and Yekutieli 2001); bold: corrected p below 0.05, at least ten pairs."
)

_LATEX = {
    "\\": r"\textbackslash{}", "&": r"\&", "%": r"\%", "$": r"\$", "#": r"\#", "_": r"\_", "{": r"\{", "}": r"\}",
    "~": r"\textasciitilde{}", "^": r"\textasciicircum{}", "²": "$^2$", "³": "$^3$", "₂": "$_2$", "µ": r"$\mu$",
    "−": "$-$", "…": r"\ldots{}",
}  # fmt: skip
_MARKDOWN = {letter: f"\\{letter}" for letter in "\\|*_`<>[]"}


class Format(Enum):
    """How a table is written; LaTeX needs the package `booktabs`."""

    LATEX = "latex"
    MARKDOWN = "md"
    CSV = "csv"


def table_of(path: Path, form: Format, metrics: Sequence[str] = ()) -> str:
    """Return the table of a store of a batch, or of a comparison's folder: a row a metric, of those asked for, or of all.

    What varies in the batch begins a part of the table. Raises StoreError or ScenarioError for what holds no pairs.
    """
    if path.is_dir():
        _require_known(metrics, EVERY)
        found = {"": recorded_pairs(path)}
    else:
        with Results(path) as results:
            _require_known(metrics, (*EVERY, *results.known))
            found = _stored_pairs(results, metrics)
    parts = {
        part: effects_among({name: pairs[name] for name in metrics or pairs if name in pairs})
        for part, pairs in found.items()
    }
    if not any(parts.values()):
        raise ScenarioError(f"{path}: no trip that both drivers have driven with one seed, with such a metric")
    return {Format.LATEX: _latex, Format.MARKDOWN: _markdown, Format.CSV: _csv}[form](parts)


def _require_known(metrics: Sequence[str], known: Collection[str]) -> None:
    for name in metrics:
        if name not in known:
            raise ScenarioError(f"unknown metric '{name}'{nearest(name, known)}")


def _stored_pairs(results: Results, metrics: Sequence[str]) -> dict[str, dict[str, list[tuple[float, float]]]]:
    """Return by what varies in the batch, in words, and metric the values of each pair of a store."""
    names = metrics or tuple(dict.fromkeys((*EGO_METRICS, *results.metrics(()))))
    found: dict[str, dict[str, list[tuple[float, float]]]] = {}
    for pair in pairs_of(trials_in(results)):
        by_metric = found.setdefault(pair.part, {name: [] for name in names})
        for name in names:
            by_metric[name].extend([] if (values := pair.of(name)) is None else [values])
    return found


def _cells(name: str, effect: Effect) -> list[str]:
    found = effect.found
    ps = ("none" if p is None else "< 0.001" if p < 0.001 else f"{p:.3f}" for p in (effect.p, effect.corrected))
    return [
        metric_of(name).title, str(found.n), figure_text(found.first), figure_text(found.second),
        signed_text(found.difference), interval_text(found.interval),
        "none" if effect.size is None else f"{effect.size:+.2f}", *ps,
    ]  # fmt: skip


def _escaped(text: str, letters: Mapping[str, str]) -> str:
    return "".join(letters.get(letter, letter) for letter in text)


def _rows(effects: Mapping[str, Effect], letters: Mapping[str, str], bold: str) -> Iterator[list[str]]:
    """Yield the cells of each metric as the form has them; the difference that is there beyond doubt in bold."""
    for name, effect in effects.items():
        cells = [_escaped(cell, letters) for cell in _cells(name, effect)]
        if effect.is_shown:
            cells[4] = bold.format(cells[4])
        yield cells


def _latex(parts: Mapping[str, Mapping[str, Effect]]) -> str:
    lines = [f"% {NOTE}", rf"\begin{{tabular}}{{l{'r' * (len(TITLES) - 1)}}}", r"\toprule"]
    lines += [" & ".join(_escaped(title, _LATEX) for title in TITLES) + r" \\", r"\midrule"]
    for part, effects in parts.items():
        lines += [rf"\multicolumn{{{len(TITLES)}}}{{l}}{{{_escaped(part, _LATEX)}}} \\"] if part else []
        lines += [" & ".join(cells) + r" \\" for cells in _rows(effects, _LATEX, r"\textbf{{{}}}")]
    return "\n".join([*lines, r"\bottomrule", r"\end{tabular}", ""])


def _markdown(parts: Mapping[str, Mapping[str, Effect]]) -> str:
    lines = [f"| {' | '.join(_escaped(title, _MARKDOWN) for title in TITLES)} |", "|---" + "|---:" * (len(TITLES) - 1) + "|"]
    for part, effects in parts.items():
        lines += [f"| *{_escaped(part, _MARKDOWN)}* |" + " |" * (len(TITLES) - 1)] if part else []
        lines += ["| " + " | ".join(cells) + " |" for cells in _rows(effects, _MARKDOWN, "**{}**")]
    return "\n".join([*lines, "", NOTE, ""])


def _csv(parts: Mapping[str, Mapping[str, Effect]]) -> str:
    text = StringIO()
    lines = csv.writer(text, lineterminator="\n")
    lines.writerow(("varied", "metric", "n", "sumo", "reactive", "difference", "low", "high", "d_z", "p", "corrected_p"))
    for part, effects in parts.items():
        for name, effect in effects.items():
            found, interval = effect.found, effect.found.interval
            limits = (None, None) if interval is None else (interval.low, interval.high)
            figures = (found.first, found.second, found.difference, *limits, effect.size, effect.p, effect.corrected)
            lines.writerow((part, name, found.n, *("" if value is None else value for value in figures)))
    return text.getvalue()
