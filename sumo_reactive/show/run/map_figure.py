"""Where the ego drove: the roads around its trip, its track coloured by behaviour, regions, faults."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from html import escape
from typing import Any

from plotly.graph_objects import Figure, Scatter

from sumo_reactive.driver.nouns.decision import Behaviour
from sumo_reactive.lab.result import Fault
from sumo_reactive.lab.trace import Entry
from sumo_reactive.show.decision_rows import fault_hover, hover_of
from sumo_reactive.show.frame.colours import BEHAVIOUR_COLOURS, EDGE, FAULT, FRAME, JUNCTION, ROAD, SOFT
from sumo_reactive.show.run.map_views import View, views_of
from sumo_reactive.show.run.road_map import RoadMap
from sumo_reactive.show.run.steps import Band, Steps

_WIDTH_PX, _LEAST_PX, _MOST_PX, _AROUND_PX = 1150, 300, 640, 130
"""Usual width of the map, least and largest height of it, and what is above and below it, pixels."""

Corners = Sequence[Sequence[float]]


def map_figure(
    roads: RoadMap, regions: Mapping[str, Corners], steps: Steps, bands: Sequence[Band],
    entries: Sequence[Entry], faults: Sequence[Fault],
) -> Figure:  # fmt: skip
    """Return the figure; it begins with the whole trip."""
    figure = Figure()
    _add_areas(figure, roads.junctions, "junctions", JUNCTION, line=0.7)
    _add_areas(figure, roads.inside, "lanes inside junctions", JUNCTION, line=0.0)
    _add_areas(figure, roads.lanes, "lanes", ROAD, line=0.7)
    for name, corners in regions.items():
        _add_region(figure, name, corners)
    for behaviour in Behaviour:
        _add_track(figure, behaviour, [band for band in bands if band.behaviour is behaviour], steps)
    _add_marks(figure, steps, entries, faults)
    _add_ends(figure, steps)
    whole = views_of(steps, bands)[0]
    legend = {"orientation": "h", "y": 1.0, "yanchor": "bottom"}
    figure.update_layout(**FRAME, height=_height(whole), hovermode="closest", dragmode="pan", legend=legend)
    figure.update_xaxes(title={"text": "x (m)", "standoff": 8}, range=whole.x)
    figure.update_yaxes(title={"text": "y (m)", "standoff": 8}, range=whole.y, scaleanchor="x")
    for update in (figure.update_xaxes, figure.update_yaxes):
        update(showgrid=False, zeroline=False)
    return figure


def _height(view: View) -> int:
    """Return the height (pixels) that shows a view without much around it."""
    wanted = _WIDTH_PX * (view.y[1] - view.y[0]) / (view.x[1] - view.x[0])
    return _AROUND_PX + round(min(_MOST_PX, max(_LEAST_PX, wanted)))


def _add_areas(figure: Figure, areas: Mapping[str, Any], name: str, colour: str, line: float) -> None:
    """Add many areas as one trace, each closed and set off from the next by a gap; `line`: width of their edges, pixels."""
    xs, ys = closed(areas.values())
    if xs:
        area = Scatter(
            x=xs, y=ys, mode="lines", fill="toself", fillcolor=colour, line={"color": EDGE, "width": line},
            hoverinfo="skip", name=name, showlegend=False,
        )  # fmt: skip
        figure.add_trace(area)


def closed(areas: Iterable[Any]) -> tuple[list[float | None], list[float | None]]:
    """Return the corners of areas as x and y, each area ending where it began, None between two of them."""
    xs: list[float | None] = []
    ys: list[float | None] = []
    for area in areas:
        corners = [(round(float(x), 2), round(float(y), 2)) for x, y in area]
        xs += [*(x for x, _ in (*corners, corners[0])), None]
        ys += [*(y for _, y in (*corners, corners[0])), None]
    return xs, ys


def _add_region(figure: Figure, name: str, corners: Corners) -> None:
    xs, ys = closed([corners])
    region = Scatter(
        x=xs, y=ys, mode="lines", fill="toself", fillcolor="rgba(213,94,0,0.18)", line={"color": "#d55e00", "width": 1},
        name="conflict region", legendgroup="regions", hoveron="fills", text=f"region {escape(name)}", hoverinfo="text",
        showlegend=not any(trace.legendgroup == "regions" for trace in figure.data),
    )  # fmt: skip
    figure.add_trace(region)


def _add_track(figure: Figure, behaviour: Behaviour, bands: Sequence[Band], steps: Steps) -> None:
    indices: list[int | None] = []
    for band in bands:
        indices += [*range(band.first, band.last + 1), None]
    if not indices:
        return

    def of(name: str) -> list[Any]:
        return [None if k is None else steps[name][k] for k in indices]

    track = Scatter(
        x=of("x_m"), y=of("y_m"), mode="lines", name=behaviour.value,
        line={"color": BEHAVIOUR_COLOURS[behaviour], "width": 4, "simplify": False},
        customdata=list(zip(of("time_s"), of("speed_m_s"), of("lane_id"), strict=True)),
        hovertemplate="%{customdata[0]:.1f} s, %{customdata[1]:.1f} m/s<br>lane %{customdata[2]}",
    )  # fmt: skip
    figure.add_trace(track)


def _add_marks(figure: Figure, steps: Steps, entries: Sequence[Entry], faults: Sequence[Fault]) -> None:
    """Mark where the pilot decided something, and where a fault happened."""
    told = [(entry.time, hover_of(entries, k)) for k, entry in enumerate(entries)]
    dot = {"symbol": "circle", "size": 7, "color": "#ffffff", "line": {"color": "#1c2024", "width": 1.2}}
    _add_points(figure, steps, told, "decision", dot)
    wrong = [(fault.time, fault_hover(fault, entries)) for fault in faults]
    _add_points(figure, steps, wrong, "fault", {"symbol": "x", "size": 14, "color": FAULT})


def _add_points(figure: Figure, steps: Steps, told: Sequence[tuple[float, str]], name: str, marker: dict[str, Any]) -> None:
    at = [steps.index_at(time) for time, _ in told]
    if at:
        points = Scatter(
            x=[steps["x_m"][k] for k in at], y=[steps["y_m"][k] for k in at], mode="markers", name=name, marker=marker,
            text=[f"{time:.1f} s<br>{text}" for time, text in told], hovertemplate="%{text}<extra></extra>",
        )  # fmt: skip
        figure.add_trace(points)


def _add_ends(figure: Figure, steps: Steps) -> None:
    ends = Scatter(
        x=[steps["x_m"][k] for k in (0, -1)], y=[steps["y_m"][k] for k in (0, -1)], mode="markers+text", showlegend=False,
        text=["start", "end"], textposition="top center", textfont={"color": SOFT}, hoverinfo="skip", name="ends",
        marker={"symbol": ["triangle-right", "square"], "size": 12, "color": SOFT},
    )  # fmt: skip
    figure.add_trace(ends)
