"""How a metric is distributed over the trials, and how it compares trip by trip with SUMO's own driver."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape

from plotly.graph_objects import Box, Figure, Scatter

from sumo_reactive.show.batch_trials import StoredTrial, TripPair
from sumo_reactive.show.page import FRAME, PALETTE, SOFT, driver_colour, driver_name, title_of

_SCATTER_PX, _BOX_PX, _AROUND_PX = 520, 34, 160
"""Height of a scatter, of a box, and of what is around all boxes of a figure, pixels."""

_ROOM = 0.05
"""Share of the range left free at either end of a scatter's axes."""

_LEGEND = {"orientation": "h", "y": 1.0, "yanchor": "bottom", "x": 0.0, "traceorder": "normal"}


def distribution_figure(trials: Sequence[StoredTrial], metric: str, names: Mapping[str, str]) -> Figure:
    """Return a box a group and driver: median, quartiles, whiskers to 1.5 of their distance, and every trial as a point.

    A group is a scenario, in short by `names`, with what is varied; the groups of a scenario stand together.
    """

    def group(trial: StoredTrial) -> str:
        return " ".join(filter(None, (names[trial.scenario], trial.varied)))

    having = [trial for trial in trials if metric in trial.metrics]
    drivers = list(dict.fromkeys(trial.driver for trial in having))
    ordered = [trial for driver in drivers for trial in having if trial.driver == driver]
    scenarios = dict.fromkeys(names[trial.scenario] for trial in ordered)
    groups = list(dict.fromkeys(group(one) for name in scenarios for one in ordered if names[one.scenario] == name))
    is_shared = len(groups) < len({(trial.driver, group(trial)) for trial in having})
    figure = Figure()
    for driver in drivers:
        found = [trial for trial in having if trial.driver == driver]
        box = Box(
            x=[one.metrics[metric] for one in found], y=[group(one) for one in found], orientation="h", boxpoints="all",
            jitter=0.5, pointpos=0.0, marker={"size": 5, "opacity": 0.75}, line={"width": 1.5}, name=driver_name(driver),
            marker_color=driver_colour(driver, drivers), text=[escape(one.name) for one in found], offsetgroup=driver,
            hoveron="points", hovertemplate="%{text}<br>%{x:.4~g}<extra></extra>",
        )  # fmt: skip
        figure.add_trace(box)
    height = _AROUND_PX + _BOX_PX * len(groups) * (len(drivers) if is_shared else 1)
    figure.update_layout(**FRAME, boxmode="group" if is_shared else "overlay", height=height, legend=_LEGEND)
    figure.update_xaxes(title={"text": title_of(metric), "standoff": 8}, zeroline=False)
    figure.update_yaxes(categoryorder="array", categoryarray=groups[::-1], automargin=True, showgrid=False, ticksuffix=" ")
    return figure


def scatter_figure(pairs: Sequence[TripPair], metric: str, names: Mapping[str, str]) -> Figure:
    """Return a point a pair: SUMO's own driver across, this one up; on the line both are the same."""
    values = [(pair, found) for pair in pairs if (found := pair.of(metric)) is not None]
    low, high = (end(value for _, found in values for value in found) for end in (min, max))
    room = _ROOM * (high - low) or 1.0
    limits = [low - room, high + room]
    dashed = {"color": SOFT, "dash": "dash", "width": 1.5}
    figure = Figure(Scatter(x=limits, y=limits, mode="lines", line=dashed, name="the same", hoverinfo="skip"))
    for k, scenario in enumerate(dict.fromkeys(pair.driven.scenario for pair in pairs)):
        inside = [(pair.driven, found) for pair, found in values if pair.driven.scenario == scenario]
        if inside:
            points = Scatter(
                x=[first for _, (first, _) in inside], y=[second for _, (_, second) in inside], mode="markers",
                name=names[scenario], text=[escape(" ".join(filter(None, (one.name, one.varied)))) for one, _ in inside],
                marker={"size": 9, "color": PALETTE[k % len(PALETTE)], "opacity": 0.8,
                        "line": {"width": 1, "color": "#ffffff"}},
                hovertemplate="%{text}<br>SUMO's own %{x:.4~g}, this driver %{y:.4~g}<extra></extra>",
            )  # fmt: skip
            figure.add_trace(points)
    figure.update_layout(**FRAME, height=_SCATTER_PX, legend=_LEGEND)
    axis = {"range": limits, "zeroline": False, "constrain": "domain"}
    figure.update_xaxes(title={"text": f"SUMO's own driver: {title_of(metric)}", "standoff": 8}, **axis)
    figure.update_yaxes(title=f"this driver: {title_of(metric)}", scaleanchor="x", **axis)
    return figure
