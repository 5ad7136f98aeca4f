"""How a network's figures move with the share of egos: a figure a metric, and differences from the smallest share."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from html import escape

from plotly.graph_objects import Figure, Scatter

from sumo_reactive.lab.comparison.statistics import FEW, interval_of, paired_difference
from sumo_reactive.lab.task import SHARE
from sumo_reactive.show import page as frame
from sumo_reactive.show.batch_trials import StoredTrial
from sumo_reactive.show.page import FRAME, PALETTE, Html, title_of

_HEIGHT_PX = 380
_PERCENT = 100.0

_FIGURES = "Mean over the seeds with its bootstrap interval at 95 %; a small point is a run."
_DIFFERENCES = (
    "Each share − the smallest one, same seed; bootstrap intervals of the mean difference at 95 %, in bold where they leave "
    "out zero"
)

Line = tuple[str, str]
"""A scenario, and what varies beside the share."""


def share_section(trials: Sequence[StoredTrial], metrics: Sequence[str], names: Mapping[str, str]) -> Iterator[Html]:
    """Yield a figure a metric and the table of differences; nothing without trials of several shares."""
    lines = lines_of(trials)
    if all(len({trial.share for trial in inside}) < 2 for inside in lines.values()):
        return
    yield frame.paragraph_of(_FIGURES)
    shown = [name for name in metrics if len({trial.metrics[name] for trial in trials if name in trial.metrics}) > 1]
    figures = {name: share_figure(lines, name, names) for name in shown}
    yield frame.side_by_side(frame.figure_html(one, f"share-{name}") for name, one in figures.items())
    rows, few = _differences(lines, metrics, names)
    if rows:
        yield frame.paragraph_of(_DIFFERENCES, f", of {FEW} seeds or more." if few else ".")
        head = "trials", "share", "figure", "seeds", "smallest share", "this share", "difference", "95 % interval"
        yield frame.table(head, rows, is_long=True)


def lines_of(trials: Sequence[StoredTrial]) -> dict[Line, list[StoredTrial]]:
    """Return the trials that have a share by what else they differ in, but for the seed."""
    lines: dict[Line, list[StoredTrial]] = {}
    for trial in trials:
        if trial.share is not None:
            varied = " ".join(word for word in trial.varied.split() if not word.startswith(f"{SHARE}="))
            lines.setdefault((trial.scenario, varied), []).append(trial)
    return lines


def share_figure(lines: Mapping[Line, Sequence[StoredTrial]], metric: str, names: Mapping[str, str]) -> Figure:
    """Return a line a scenario (and what varies in it): the share across, the metric's mean up, with its interval."""
    figure = Figure()
    for k, ((scenario, varied), trials) in enumerate(lines.items()):
        colour, name = PALETTE[k % len(PALETTE)], escape(" ".join(filter(None, (names[scenario], varied))))
        having = [trial for trial in trials if metric in trial.metrics]
        shares = sorted({float(trial.share or 0.0) for trial in having})
        values = [[one.metrics[metric] for one in having if one.share == share] for share in shares]
        means = [sum(found) / len(found) for found in values]
        intervals = [interval_of(found) for found in values]
        above, below = (
            [abs(getattr(one, side) - mean) if one else 0.0 for one, mean in zip(intervals, means, strict=True)]
            for side in ("high", "low")
        )
        figure.add_trace(Scatter(
            x=[_PERCENT * share for share in shares], y=means, mode="lines+markers", name=name,
            line={"color": colour, "width": 2}, marker={"size": 8, "color": colour},
            error_y={"type": "data", "array": above, "arrayminus": below, "color": colour, "thickness": 1.5},
            hovertemplate="%{x:.3~g} %: %{y:.4~g}<extra></extra>",
        ))  # fmt: skip
        figure.add_trace(Scatter(
            x=[_PERCENT * float(one.share or 0.0) for one in having], y=[one.metrics[metric] for one in having],
            mode="markers", marker={"size": 4, "color": colour, "opacity": 0.5}, showlegend=False,
            text=[f"seed {one.seed}" for one in having], hovertemplate="%{text}: %{y:.4~g}<extra></extra>",
        ))  # fmt: skip
    legend = {"orientation": "h", "y": 1.0, "yanchor": "bottom", "x": 0.0}
    figure.update_layout(**FRAME, height=_HEIGHT_PX, legend=legend, showlegend=True)
    figure.update_xaxes(title={"text": "share of egos (%)", "standoff": 8}, zeroline=False)
    figure.update_yaxes(title=title_of(metric), zeroline=False, automargin=True)
    return figure


def _differences(
    lines: Mapping[Line, Sequence[StoredTrial]], metrics: Sequence[str], names: Mapping[str, str]
) -> tuple[list[tuple[str, ...]], bool]:
    """Return a row for each line, share and metric; and whether any of them rests on few seeds."""
    rows: list[tuple[str, ...]] = []
    few = False
    for (scenario, varied), trials in lines.items():
        line = " ".join(filter(None, (names[scenario], varied)))
        by = {(trial.share, trial.seed): trial.metrics for trial in trials}
        shares = sorted({float(trial.share or 0.0) for trial in trials})
        seeds = sorted({trial.seed for trial in trials})
        for share in shares[1:]:
            for metric in metrics:
                both = [(by.get((shares[0], seed), {}), by.get((share, seed), {})) for seed in seeds]
                values = [(one[metric], two[metric]) for one, two in both if metric in one and metric in two]
                found = paired_difference(values)
                if found is None:
                    continue
                few = few or found.n < FEW
                cells = frame.difference_cells(found)
                rows.append((line, f"{_PERCENT * share:g} %", title_of(metric), str(found.n), *cells))
    return rows, few
