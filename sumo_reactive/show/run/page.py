"""The page of a recorded run: verdict and figures, the trip on the map, what happened over time, every decision."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from sumo_reactive.lab.result import Fault
from sumo_reactive.show.decision_rows import decision_table, fault_sentence
from sumo_reactive.show.explain import footer
from sumo_reactive.show.frame.labels import number, title_of
from sumo_reactive.show.frame.page import Html, Section, figure_html, page, paragraph_of, side_by_side, table
from sumo_reactive.show.recording import Recording
from sumo_reactive.show.run.map_figure import map_figure
from sumo_reactive.show.run.map_views import NAME, buttons_of, views_of
from sumo_reactive.show.run.road_map import roads_of
from sumo_reactive.show.run.steps import Steps, bands_of, faults_in, read_steps
from sumo_reactive.show.run.timeline_figure import HEIGHT as TIMELINE_HEIGHT
from sumo_reactive.show.run.timeline_figure import timeline_figure

_FROM_WHERE = "A path is that of the record, and begins in the folder where the run was started."
_TRIP = ("duration_s", "time_loss_s", "distance_m")
_READING = (
    "Hover over a line to read values and over a mark of the track to read the decision; drag to zoom, double-click to see "
    "all."
)


def run_page(recording: Recording) -> str:
    """Return the page; raise ScenarioError for a record that lacks what it shows."""
    summary, steps = recording.summary, read_steps(recording)
    faults = faults_in(summary)
    timeline = timeline_figure(steps, bands_of(steps), recording.entries, faults)
    told = decision_table(recording.entries, faults)
    sections = (
        Section("figures", "Figures", list(_figures(recording, faults))),
        Section("map", "On the map", list(_map(recording, steps, faults))),
        Section("time", "Over time", [paragraph_of(_READING), figure_html(timeline, "time", TIMELINE_HEIGHT)]),
        Section("decisions", "Decisions", [paragraph_of(footer(summary["figures"])), told]),
    )
    return page(f"{summary['ego']} in {summary['scenario']}", _subtitle(summary), sections)


def _subtitle(summary: Mapping[str, Any]) -> str:
    seed, departs, ends = (summary.get(name) for name in ("seed", "departure_s", "end_s"))
    when = f", from {departs:.1f} to {ends:.1f} s" if departs is not None and ends is not None else ""
    verdict = summary["verdict"]
    return f"{verdict[0].upper()}{verdict[1:]}; seed {seed}{when}."


def _figures(recording: Recording, faults: list[Fault]) -> Iterator[Html]:
    for fault in faults:
        yield paragraph_of(fault_sentence(fault, recording.entries), kind="bad")
    summary = recording.summary
    values = {name: summary.get(name) for name in _TRIP} | dict(summary["figures"])
    shown = {name: value for name, value in values.items() if not name.startswith("events_")}
    rows = [(title_of(name), number(value)) for name, value in shown.items()]
    half = (len(rows) + 1) // 2
    yield side_by_side(table(("figure", "value"), part) for part in (rows[:half], rows[half:]))


def _map(recording: Recording, steps: Steps, faults: list[Fault]) -> Iterator[Html]:
    roads, bands = roads_of(recording, steps), bands_of(steps)
    if roads.missing:
        yield paragraph_of(f"Drawn without the roads: {roads.missing}. {_FROM_WHERE}")
    yield buttons_of(views_of(steps, bands))
    figure = map_figure(roads, recording.regions, steps, bands, recording.entries, faults)
    yield figure_html(figure, NAME, int(figure.layout.height))
