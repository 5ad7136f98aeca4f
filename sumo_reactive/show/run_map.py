"""Where the ego drove: the roads around its trip, its track coloured by behaviour, regions, faults, and views of them."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from html import escape
from itertools import groupby
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from plotly.graph_objects import Figure, Scatter

from sumo_reactive.driver.nouns.decision import Behaviour
from sumo_reactive.errors import ReactiveError
from sumo_reactive.lab.fault import Fault
from sumo_reactive.lab.scenario import load_scenario
from sumo_reactive.lab.trace import Entry
from sumo_reactive.show.faults import fault_hover, hover_of
from sumo_reactive.show.page import EDGE, FAULT, FRAME, JUNCTION, ROAD, SOFT, Html, behaviour_colour, behaviour_name
from sumo_reactive.show.recording import Recording, Steps
from sumo_reactive.show.run_timeline import BehaviourSpan
from sumo_reactive.sumo.config import read_config
from sumo_reactive.sumo.net_reader import read_net

MAP_NAME = "map"
"""The figure's name on the page."""

_MARGIN_M = 25.0
"""Left around what a view shows, m."""

_MOST_VIEWS = 12
"""So many places have a button."""

_WIDTH_PX, _LEAST_PX, _MOST_PX, _AROUND_PX = 1150, 300, 640, 130
"""Usual width of the map, least and largest height of it, and what is above and below it, pixels."""

Outline = NDArray[np.float64]
"""Corners (n, 2) of an area, m."""

Corners = Sequence[Sequence[float]]


class RoadMap(NamedTuple):
    """Outlines by id of lanes, of lanes inside junctions, and of junctions; `missing` says why there are none."""

    lanes: dict[str, Outline]
    inside: dict[str, Outline]
    junctions: dict[str, Outline]
    missing: str = ""


class MapView(NamedTuple):
    """A part of the map: what it shows, and its limits (low, high) in x and y, m."""

    label: str
    x: tuple[float, float]
    y: tuple[float, float]


def roads_of(recording: Recording, steps: Steps) -> RoadMap:
    """Return the roads that the trip touches, and those that lead to its junctions; without the network, why not."""
    try:
        net = read_net(read_config(load_scenario(Path(str(recording.summary["scenario"]))).config).net_file)
        graph = net.build(edges_of(steps["lane_id"]))
    except ReactiveError as error:
        return RoadMap({}, {}, {}, str(error))
    lanes = {lane.id: lane.outline for lane in graph.lanes.values()}
    inside = {name: lanes.pop(name) for name, lane in graph.lanes.items() if lane.is_internal}
    return RoadMap(lanes, inside, {name: junction.outline for name, junction in graph.junctions.items()})


def edges_of(lane_ids: Iterable[str]) -> list[str]:
    """Return the normal edges that the ego was on, in order; lanes inside junctions begin with a colon."""
    edges = (lane.rpartition("_")[0] for lane in lane_ids if lane and not lane.startswith(":"))
    return [edge for edge, _ in groupby(edges)]


def views_of(steps: Steps, spans: Sequence[BehaviourSpan]) -> list[MapView]:
    """Return the whole trip, and the places at which the ego did something else than normal driving.

    What was cautious driving before something or after it belongs to that.
    """
    found = [_view("whole trip", steps, 0, len(steps.times) - 1)]
    for is_normal, inside in groupby(spans, key=lambda span: span.behaviour in (Behaviour.NORMAL, None)):
        together = list(inside)
        busy = [span for span in together if span.behaviour is not Behaviour.CAUTIOUS] or together
        if not is_normal:
            label = f"{behaviour_name(busy[0].behaviour)}, {busy[0].start:.1f} s"
            found.append(_view(label, steps, busy[0].first, busy[-1].last))
    return found[: _MOST_VIEWS + 1]


def _view(label: str, steps: Steps, first: int, last: int) -> MapView:
    xs, ys = steps["x_m"][first : last + 1], steps["y_m"][first : last + 1]
    return MapView(label, (min(xs) - _MARGIN_M, max(xs) + _MARGIN_M), (min(ys) - _MARGIN_M, max(ys) + _MARGIN_M))


def buttons_of(views: Iterable[MapView]) -> Html:
    """Return a button for each view."""
    told = "".join(
        f"<button data-plot=\"plot-{MAP_NAME}\" data-view='{json.dumps({'xaxis.range': view.x, 'yaxis.range': view.y})}'>"
        f"{escape(view.label)}</button>"
        for view in views
    )
    return Html(f'<div class="views">{told}</div>')


def map_figure(
    roads: RoadMap, regions: Mapping[str, Corners], steps: Steps, spans: Sequence[BehaviourSpan],
    entries: Sequence[Entry], faults: Sequence[Fault],
) -> Figure:  # fmt: skip
    """Return the figure; it begins with the whole trip."""
    figure = Figure()
    _add_roads(figure, roads)
    for name, corners in regions.items():
        _add_region(figure, name, corners)
    for behaviour in (*Behaviour, None):
        _add_track(figure, behaviour, [span for span in spans if span.behaviour is behaviour], steps)
    told = [(entry.time, hover_of(entries, k)) for k, entry in enumerate(entries)]
    dot = {"symbol": "circle", "size": 7, "color": "#ffffff", "line": {"color": "#1c2024", "width": 1.2}}
    _add_points(figure, steps, told, "decision", dot)
    wrong = [(fault.time, fault_hover(fault, entries)) for fault in faults]
    _add_points(figure, steps, wrong, "fault", {"symbol": "x", "size": 14, "color": FAULT})
    _add_ends(figure, steps)
    whole = views_of(steps, spans)[0]
    wanted = _WIDTH_PX * (whole.y[1] - whole.y[0]) / (whole.x[1] - whole.x[0])
    height = _AROUND_PX + round(min(_MOST_PX, max(_LEAST_PX, wanted)))
    legend = {"orientation": "h", "y": 1.0, "yanchor": "bottom"}
    figure.update_layout(**FRAME, height=height, hovermode="closest", dragmode="pan", legend=legend)
    bare = {"showgrid": False, "zeroline": False}
    figure.update_xaxes(title={"text": "x (m)", "standoff": 8}, range=whole.x, **bare)
    figure.update_yaxes(title={"text": "y (m)", "standoff": 8}, range=whole.y, scaleanchor="x", **bare)
    return figure


def _add_roads(figure: Figure, roads: RoadMap) -> None:
    """Add many areas as one trace, each closed and set off from the next by a gap."""
    for areas, name, colour, line in (
        (roads.junctions, "junctions", JUNCTION, 0.7), (roads.inside, "lanes inside junctions", JUNCTION, 0.0),
        (roads.lanes, "lanes", ROAD, 0.7),
    ):  # fmt: skip
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
        for x, y in (*area, area[0]):
            xs.append(round(float(x), 2))
            ys.append(round(float(y), 2))
        xs.append(None)
        ys.append(None)
    return xs, ys


def _add_region(figure: Figure, name: str, corners: Corners) -> None:
    xs, ys = closed([corners])
    region = Scatter(
        x=xs, y=ys, mode="lines", fill="toself", fillcolor="rgba(213,94,0,0.18)", line={"color": "#d55e00", "width": 1},
        name="conflict region", legendgroup="regions", hoveron="fills", text=f"region {escape(name)}", hoverinfo="text",
        showlegend=not any(trace.legendgroup == "regions" for trace in figure.data),
    )  # fmt: skip
    figure.add_trace(region)


def _add_track(figure: Figure, behaviour: Behaviour | None, spans: Sequence[BehaviourSpan], steps: Steps) -> None:
    indices = [k for span in spans for k in (*range(span.first, span.last + 1), None)]
    if not indices:
        return

    def of(name: str) -> list[Any]:
        return [None if k is None else steps[name][k] for k in indices]

    track = Scatter(
        x=of("x_m"), y=of("y_m"), mode="lines", name=behaviour_name(behaviour),
        line={"color": behaviour_colour(behaviour), "width": 4, "simplify": False},
        customdata=list(zip(of("time_s"), of("speed_m_s"), of("lane_id"), strict=True)),
        hovertemplate="%{customdata[0]:.1f} s, %{customdata[1]:.1f} m/s<br>lane %{customdata[2]}",
    )  # fmt: skip
    figure.add_trace(track)


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
