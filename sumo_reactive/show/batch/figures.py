"""How a metric is distributed over the trials, and how it compares trip by trip with SUMO's own driver."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from typing import Any, NamedTuple

from plotly.graph_objects import Box, Figure, Scatter

from sumo_reactive.show.batch.stored_trials import Pair, StoredTrial
from sumo_reactive.show.frame.colours import DRIVER_COLOURS, DRIVER_NAMES, FRAME, SOFT, colour_of
from sumo_reactive.show.frame.labels import title_of

SCATTER_HEIGHT = 520
_BOX_PX, _AROUND_PX = 34, 160
"""Height of a box, and of what is around all boxes of a figure, pixels."""

_ROOM = 0.05
"""Share of the range left free at either end of a scatter's axes."""


class Point(NamedTuple):
    """A trial in a distribution: scenario in short, that with what is varied, its value, its name."""

    scenario: str
    group: str
    value: float
    name: str


def values_by_driver(trials: Sequence[StoredTrial], metric: str, names: Mapping[str, str]) -> dict[str, list[Point]]:
    """Return the trials that have a metric, by driver; `names` shortens the scenarios."""
    found: dict[str, list[Point]] = {}
    for trial in trials:
        if metric in trial.metrics:
            group = " ".join(part for part in (names[trial.scenario], trial.varied) if part)
            found.setdefault(trial.driver, []).append(Point(names[trial.scenario], group, trial.metrics[metric], trial.name))
    return found


def distribution_figure(trials: Sequence[StoredTrial], metric: str, names: Mapping[str, str]) -> Figure:
    """Return a box a group and driver: median, quartiles, whiskers to 1.5 of their distance, and every trial as a point."""
    by_driver = values_by_driver(trials, metric, names)
    groups = groups_of(by_driver)
    is_shared = len(groups) < sum(len({point.group for point in found}) for found in by_driver.values())
    figure = Figure()
    for driver, found in by_driver.items():
        box = Box(
            x=[point.value for point in found], y=[point.group for point in found], orientation="h", boxpoints="all",
            jitter=0.5, pointpos=0.0, marker={"size": 5, "opacity": 0.75}, line={"width": 1.5}, name=DRIVER_NAMES[driver],
            marker_color=DRIVER_COLOURS[driver], text=[escape(point.name) for point in found], offsetgroup=driver,
            hoveron="points", hovertemplate="%{text}<br>%{x:.4~g}<extra></extra>",
        )  # fmt: skip
        figure.add_trace(box)
    height = _AROUND_PX + _BOX_PX * len(groups) * (len(by_driver) if is_shared else 1)
    figure.update_layout(**FRAME, boxmode="group" if is_shared else "overlay", height=height, legend=_legend())
    figure.update_xaxes(title={"text": title_of(metric), "standoff": 8}, zeroline=False)
    figure.update_yaxes(categoryorder="array", categoryarray=groups[::-1], automargin=True, showgrid=False, ticksuffix=" ")
    return figure


def groups_of(by_driver: Mapping[str, Sequence[Point]]) -> list[str]:
    """Return the groups, those of a scenario together."""
    together: dict[str, dict[str, None]] = {}
    for found in by_driver.values():
        for point in found:
            together.setdefault(point.scenario, {})[point.group] = None
    return [group for groups in together.values() for group in groups]


def scatter_figure(pairs: Sequence[Pair], metric: str, names: Mapping[str, str]) -> Figure:
    """Return a point a pair: SUMO's own driver across, this one up; on the line both are the same."""
    figure = Figure()
    values = [(pair, found) for pair in pairs if (found := pair.of(metric)) is not None]
    limits = _limits([value for _, found in values for value in found])
    dashed = {"color": SOFT, "dash": "dash", "width": 1.5}
    figure.add_trace(Scatter(x=limits, y=limits, mode="lines", line=dashed, name="the same", hoverinfo="skip"))
    for k, scenario in enumerate(dict.fromkeys(pair.reactive.scenario for pair in pairs)):
        inside = [(pair, found) for pair, found in values if pair.reactive.scenario == scenario]
        if inside:
            figure.add_trace(_points(inside, names[scenario], colour_of(k)))
    figure.update_layout(**FRAME, height=SCATTER_HEIGHT, legend=_legend())
    title = title_of(metric)
    figure.update_xaxes(title={"text": f"SUMO's own driver: {title}", "standoff": 8})
    figure.update_yaxes(title=f"this driver: {title}", scaleanchor="x")
    for update in (figure.update_xaxes, figure.update_yaxes):
        update(range=limits, zeroline=False, constrain="domain")
    return figure


def _points(inside: Sequence[tuple[Pair, tuple[float, float]]], name: str, colour: str) -> Scatter:
    told = [escape(" ".join(part for part in (pair.reactive.name, pair.reactive.varied) if part)) for pair, _ in inside]
    return Scatter(
        x=[found[0] for _, found in inside], y=[found[1] for _, found in inside], mode="markers", name=name, text=told,
        marker={"size": 9, "color": colour, "opacity": 0.8, "line": {"width": 1, "color": "#ffffff"}},
        hovertemplate="%{text}<br>SUMO's own %{x:.4~g}, this driver %{y:.4~g}<extra></extra>",
    )  # fmt: skip


def _limits(values: Sequence[float]) -> list[float]:
    low, high = min(values), max(values)
    room = _ROOM * (high - low) or 1.0
    return [low - room, high + room]


def _legend() -> dict[str, Any]:
    return {"orientation": "h", "y": 1.0, "yanchor": "bottom", "x": 0.0, "traceorder": "normal"}
