"""The fundamental diagram of a batch with shares of egos: a figure a scenario and group of edges, and means by share."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from html import escape

from plotly.graph_objects import Figure, Scatter

from sumo_reactive.lab.comparison.statistics import interval_of
from sumo_reactive.lab.fundamental_diagram import DiagramPoint
from sumo_reactive.lab.metric_names import DIAGRAM
from sumo_reactive.show import page as frame
from sumo_reactive.show.batch_trials import StoredTrial
from sumo_reactive.show.page import FRAME, PALETTE, Html
from sumo_reactive.show.share_section import Line, lines_of

_HEIGHT_PX = 420
_PERCENT = 100.0
_KM_H_PER_M_S = 3.6

_POINTS = "A point is an interval of a run on a group of edges, after Edie; all vehicles count, egos or not."
_MEANS = "Means over the seeds of what each run came to as a whole, with bootstrap intervals at 95 %."

RunPoints = tuple[StoredTrial, Sequence[DiagramPoint]]
"""A run, and its points on one group of edges."""


def diagram_section(
    trials: Sequence[StoredTrial], points: Mapping[str, Sequence[DiagramPoint]], names: Mapping[str, str]
) -> Iterator[Html]:
    """Yield the figures and the table of means; nothing without points, which stand by the key of their trial."""
    found = list(_groups(lines_of(trials), points, names))
    if not found:
        return
    yield frame.paragraph_of(_POINTS)
    figures = (diagram_figure(runs, f"{name}: {group}") for name, group, runs in found)
    yield frame.side_by_side(frame.figure_html(figure, f"diagram-{k}") for k, figure in enumerate(figures))
    yield frame.paragraph_of(_MEANS)
    titles = [title for metric in DIAGRAM.values() for title in (metric.title, "95 % interval")]
    head = "trials", "edges", "share", "seeds", *titles
    yield frame.table(head, [row for name, group, runs in found for row in _rows(name, group, runs)], is_long=True)


def _groups(
    lines: Mapping[Line, Sequence[StoredTrial]], points: Mapping[str, Sequence[DiagramPoint]], names: Mapping[str, str]
) -> Iterator[tuple[str, str, list[RunPoints]]]:
    """Yield the runs of each scenario (and what varies in it) and group of edges."""
    for (scenario, varied), trials in lines.items():
        line = " ".join(filter(None, (names[scenario], varied)))
        for group in dict.fromkeys(point.edges for trial in trials for point in points.get(trial.key, ())):
            mine = [(trial, [point for point in points.get(trial.key, ()) if point.edges == group]) for trial in trials]
            yield line, group, [(trial, some) for trial, some in mine if some]


def diagram_figure(runs: Sequence[RunPoints], title: str) -> Figure:
    """Return flow over density: a point an interval of a run, a colour a share."""
    figure = Figure()
    for k, share in enumerate(_shares(runs)):
        inside = [(trial, point) for trial, points in runs if trial.share == share for point in points]
        told = [
            f"seed {trial.seed}, {point.begin_s:g}–{point.end_s:g} s<br>{frame.number(point.speed_m_s)} m/s"
            for trial, point in inside
        ]
        figure.add_trace(Scatter(
            x=[point.density_per_km for _, point in inside], y=[point.flow_per_h for _, point in inside], mode="markers",
            name=f"{_PERCENT * share:g} %", text=told, hovertemplate="%{text}<br>%{y:.4~g} over %{x:.4~g}<extra></extra>",
            marker={"size": 7, "color": PALETTE[k % len(PALETTE)], "opacity": 0.75},
        ))  # fmt: skip
    legend = {"orientation": "h", "y": 1.0, "yanchor": "bottom", "x": 0.0, "title": {"text": "share of egos"}}
    heading = {"text": escape(title), "font": {"size": 14}, "x": 0.0, "xref": "paper", "y": 0.98}
    figure.update_layout(**FRAME, height=_HEIGHT_PX, legend=legend, showlegend=True, title=heading)
    figure.update_xaxes(title={"text": DIAGRAM["density_per_km"].title, "standoff": 8}, zeroline=False, rangemode="tozero")
    figure.update_yaxes(title=DIAGRAM["flow_per_h"].title, zeroline=False, rangemode="tozero", automargin=True)
    return figure


def _shares(runs: Sequence[RunPoints]) -> list[float]:
    return sorted({float(trial.share or 0.0) for trial, _ in runs})


def _rows(name: str, group: str, runs: Sequence[RunPoints]) -> Iterator[tuple[str, ...]]:
    for share in _shares(runs):
        wholes = [whole_of(points) for trial, points in runs if trial.share == share]
        cells: list[str] = []
        for values in zip(*wholes, strict=True):
            known = [value for value in values if value is not None]
            cells += [frame.number(sum(known) / len(known)) if known else "none", frame.limits(interval_of(known))]
        yield name, group, f"{_PERCENT * share:g}\u00a0%", str(len(wholes)), *cells


def whole_of(points: Sequence[DiagramPoint]) -> tuple[float, float, float | None]:
    """Return flow, density and speed over all intervals of a run together (None: nobody drove)."""
    lasted = sum(point.end_s - point.begin_s for point in points)
    if lasted <= 0.0:
        return 0.0, 0.0, None
    flow, density = (
        sum(getattr(point, name) * (point.end_s - point.begin_s) for point in points) / lasted
        for name in ("flow_per_h", "density_per_km")
    )
    return flow, density, flow / density / _KM_H_PER_M_S if density > 0.0 else None
