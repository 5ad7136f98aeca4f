"""What happened over time: decisions as a track, speed, distances ahead, potentials."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby
from typing import Any, NamedTuple

from plotly.graph_objects import Bar, Figure, Scatter
from plotly.subplots import make_subplots

from sumo_reactive.driver.nouns.decision import Behaviour
from sumo_reactive.lab.fault import Fault
from sumo_reactive.lab.trace import Entry
from sumo_reactive.show.faults import fault_hover, hover_of
from sumo_reactive.show.page import FAULT, FRAME, SOFT, STOP, behaviour_colour, behaviour_name
from sumo_reactive.show.recording import Steps

_HEIGHT_PX = 980
_TRACK, _SPEED, _AHEAD, _POTENTIALS = 1, 2, 3, 4
_TITLES = {_SPEED: "speed (m/s)", _AHEAD: "way ahead (m)", _POTENTIALS: "potential (–)"}
_SHARES = [0.2, 0.26, 0.24, 0.3]
_TERMS = {
    "u": ("U = w₁U₁ + w₂U₂ + w₃U₃", "#808a94"),
    "u1": ("U₁ (valley of C)", "#0072b2"),
    "u2": ("U₂ (moving obstacles)", "#d55e00"),
    "u3": ("U₃ (speed)", "#009e73"),
}


class BehaviourSpan(NamedTuple):
    """From step `first` up to and with `last` the ego showed one behaviour (None: untold), from `start` to `end` (s)."""

    behaviour: Behaviour | None
    first: int
    last: int
    start: float
    end: float


def spans_of(steps: Steps) -> list[BehaviourSpan]:
    """Return the behaviours one after another; each ends where the next begins."""
    found = []
    for behaviour, indices in groupby(range(len(steps.times)), key=steps.behaviour):
        inside = list(indices)
        last = min(inside[-1] + 1, len(steps.times) - 1)
        found.append(BehaviourSpan(behaviour, inside[0], last, steps.times[inside[0]], steps.times[last]))
    return found


def timeline_figure(
    steps: Steps, spans: Sequence[BehaviourSpan], entries: Sequence[Entry], faults: Sequence[Fault]
) -> Figure:
    """Return the figure, with one axis of time for all; faults stand as red lines through all of it."""
    figure = make_subplots(rows=len(_SHARES), cols=1, shared_xaxes=True, vertical_spacing=0.05, row_heights=_SHARES)
    _add_behaviours(figure, spans, entries)
    _add_line(figure, _SPEED, steps, steps["speed_m_s"], "speed", {"color": "#0072b2"})
    _add_line(figure, _SPEED, steps, steps["desired_speed_m_s"], "desired speed", {"color": "#e69f00", "dash": "dash"})
    _add_line(
        figure, _AHEAD, steps, steps["gap_m"], "gap to the leader", {"color": "#0072b2"}, customdata=steps["leader"],
        hovertemplate="%{y:.3~g} behind %{customdata}",
    )  # fmt: skip
    stop = steps.difference("stop_m", "s_m")
    _add_line(figure, _AHEAD, steps, stop, "to the planned stop", {"color": STOP, "dash": "dot"})
    for name, (label, colour) in _TERMS.items():
        line = {"color": colour, "width": 5 if name == "u" else 2}
        _add_line(figure, _POTENTIALS, steps, steps[name], label, line)
    for fault in faults:
        figure.add_vline(x=fault.time, line={"color": FAULT, "width": 1.5})
        at = next((span for span in spans if span.end >= fault.time), spans[-1])
        mark = Scatter(
            x=[fault.time], y=[behaviour_name(at.behaviour)], mode="markers", showlegend=False, name="fault",
            marker={"symbol": "x", "size": 13, "color": FAULT}, text=[fault_hover(fault, entries)],
            hovertemplate="%{x:.1f} s<br>%{text}<extra></extra>",
        )  # fmt: skip
        figure.add_trace(mark, row=_TRACK, col=1)
    _lay_out(figure, steps, {span.behaviour for span in spans})
    return figure


def _add_behaviours(figure: Figure, spans: Sequence[BehaviourSpan], entries: Sequence[Entry]) -> None:
    bars = Bar(
        base=[span.start for span in spans], x=[span.end - span.start for span in spans],
        y=[behaviour_name(span.behaviour) for span in spans],
        marker={"color": [behaviour_colour(span.behaviour) for span in spans]},
        orientation="h", width=0.6, hoverinfo="skip", showlegend=False, name="behaviour",
    )  # fmt: skip
    marks = Scatter(
        x=[entry.time for entry in entries], y=[entry.behaviour.value for entry in entries], mode="markers",
        marker={"symbol": ["x" if entry.emergency else "line-ns" for entry in entries], "size": 15,
                "color": [FAULT if entry.emergency else SOFT for entry in entries],
                "line": {"width": 2, "color": [FAULT if entry.emergency else "#ffffff" for entry in entries]}},
        text=[hover_of(entries, k) for k in range(len(entries))], hovertemplate="%{x:.1f} s<br>%{text}<extra></extra>",
        showlegend=False, name="decision",
    )  # fmt: skip
    figure.add_traces([bars, marks], rows=[_TRACK, _TRACK], cols=[1, 1])


def _add_line(
    figure: Figure, row: int, steps: Steps, values: Sequence[float | None], name: str, line: dict[str, Any], **more: Any
) -> None:
    trace = Scatter(
        x=steps.times, y=list(values), name=name, mode="lines", line={"simplify": False} | line, legend=f"legend{row}",
        **({"hovertemplate": "%{y:.3~g}"} | more),
    )  # fmt: skip
    figure.add_trace(trace, row=row, col=1)


def _lay_out(figure: Figure, steps: Steps, present: set[Behaviour | None]) -> None:
    order = [behaviour_name(one) for one in (*Behaviour, None) if one in present]
    frame = FRAME | {"margin": FRAME["margin"] | {"l": 190, "t": 35}}
    figure.update_layout(**frame, height=_HEIGHT_PX, hovermode="x unified", barmode="overlay")
    figure.update_yaxes(categoryorder="array", categoryarray=order[::-1], row=_TRACK, col=1, showgrid=False)
    figure.update_xaxes(range=[steps.times[0], steps.times[-1]], showgrid=True, zeroline=False)
    figure.update_xaxes(title={"text": "simulation time (s)", "standoff": 8}, row=_POTENTIALS, col=1)
    for row, title in _TITLES.items():
        figure.update_yaxes(title=title, rangemode="tozero", row=row, col=1)
        legend = {"orientation": "h", "x": 1.0, "xanchor": "right", "yanchor": "bottom", "bgcolor": "rgba(0,0,0,0)"}
        figure.update_layout({f"legend{row}": legend | {"y": figure.layout[f"yaxis{row}"].domain[1]}})
