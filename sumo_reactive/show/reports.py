"""The page that a path gets: that of a run, of several egos that drove at once, of a batch, or of a comparison."""

from __future__ import annotations

import os
import shlex
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any
from urllib.parse import quote

from sumo_reactive.errors import ScenarioError
from sumo_reactive.lab.comparison.record import JSON_FILE
from sumo_reactive.lab.fault import Fault
from sumo_reactive.lab.recorder import FLEET, PAGE, read_fleet
from sumo_reactive.show import page as frame
from sumo_reactive.show.batch_page import batch_page
from sumo_reactive.show.comparison_page import comparison_page
from sumo_reactive.show.explain import footer
from sumo_reactive.show.faults import decision_table, fault_sentence, faults_in
from sumo_reactive.show.page import Html, Section
from sumo_reactive.show.recording import Recording, Steps, read_run, read_steps
from sumo_reactive.show.replay import facts_of, replay_of
from sumo_reactive.show.run_map import MAP_NAME, buttons_of, map_figure, roads_of, views_of
from sumo_reactive.show.run_timeline import BehaviourSpan, spans_of, timeline_figure

_FROM_WHERE = "A path is that of the record, and begins in the folder where the run was started."
_READING = (
    "Hover over a line to read values and over a mark of the track to read the decision; drag to zoom, double-click to see "
    "all."
)
_LINKED = "An ego's own page is linked where it has been written; else the command that writes it is named."
_TRIP = ("duration_s", "time_loss_s", "distance_m")
_FLEET_METRICS = (*_TRIP, "collisions", "violations", "hard_braking_caused", "rms_jerk_m_s3")


def page_beside(path: Path) -> Path:
    """Return where a page goes if nobody says: into the folder it tells of, or beside the store."""
    return path / PAGE if path.is_dir() else path.with_suffix(".html")


def page_of(path: Path, target: Path) -> str:
    """Return the page of a store or a folder, as it stands in the file `target`; raise InputError for another path."""
    if not path.exists():
        raise ScenarioError(f"{path}: no such file or folder")
    if path.is_file():
        return batch_page(path)
    if (path / JSON_FILE).is_file():
        return comparison_page(path)
    return fleet_page(path, target) if (path / FLEET).is_file() else run_page(read_run(path))


def run_page(recording: Recording) -> str:
    """Return the page of a run; raise ScenarioError for a record that lacks what it shows."""
    summary, steps = recording.summary, read_steps(recording)
    faults, spans = faults_in(summary), spans_of(steps)
    timeline = timeline_figure(steps, spans, recording.entries, faults)
    replay = replay_of(recording, steps)
    sections = (
        Section("replay", "Replay", [frame.paragraph_of(facts_of(summary)), replay] if replay else []),
        Section("figures", "Figures", list(_figures(recording, faults))),
        Section("map", "On the map", list(_map(recording, steps, spans, faults))),
        Section("time", "Over time", [frame.paragraph_of(_READING), frame.figure_html(timeline, "time")]),
        Section("decisions", "Decisions", list(_decisions(recording, faults))),
    )
    departs, ends, verdict = summary.get("departure_s"), summary.get("end_s"), summary["verdict"]
    when = f", from {departs:.1f} to {ends:.1f} s" if departs is not None and ends is not None else ""
    subtitle = f"{verdict[0].upper()}{verdict[1:]}; seed {summary.get('seed')}{when}."
    return frame.page(f"{summary['ego']} in {summary['scenario']}", subtitle, sections)


def fleet_page(folder: Path, target: Path) -> str:
    """Return the page of several egos as it stands in `target`: a row an ego, with the way to its own page."""
    fleet = read_fleet(folder)
    egos = [one.model_dump() for one in fleet.egos]
    rows = [_row(one, folder / one["folder"], target) for one in egos]
    left = [(one.vehicle, one.reason) for one in fleet.refused]
    listed = frame.table(("ego", "verdict", *map(frame.title_of, _FLEET_METRICS), "its page"), rows)
    sections = (
        Section("egos", "Egos", [frame.paragraph_of(_LINKED), listed]),
        Section("refused", "Not driven", [frame.table(("vehicle", "reason"), left)] if left else []),
    )
    clean = sum(one["verdict"].startswith("arrived without") for one in egos)
    return frame.page(f"{len(egos)} egos", f"{clean} of {len(egos)} arrived without a violation.", sections, is_drawn=False)


def _row(one: Mapping[str, Any], own: Path, target: Path) -> tuple[str, ...]:
    way = quote(Path(os.path.relpath(own / PAGE, target.absolute().parent)).as_posix())
    command = shlex.join(["sumo-reactive", "report", str(own)])
    shown = frame.link(way, "page") if (own / PAGE).is_file() else frame.code(command)
    return one["ego"], one["verdict"], *(frame.number(one.get(name)) for name in _FLEET_METRICS), shown


def _figures(recording: Recording, faults: Sequence[Fault]) -> Iterator[Html]:
    for fault in faults:
        yield frame.paragraph_of(fault_sentence(fault, recording.entries), kind="bad")
    values = {name: recording.summary.get(name) for name in _TRIP} | dict(recording.summary["figures"])
    rows = [(frame.title_of(name), frame.number(value)) for name, value in values.items() if not name.startswith("events_")]
    half = (len(rows) + 1) // 2
    yield frame.side_by_side(frame.table(("figure", "value"), part) for part in (rows[:half], rows[half:]))


def _decisions(recording: Recording, faults: Sequence[Fault]) -> Iterator[Html]:
    """Yield what the pilot has decided, or what a driver of the user's has told of itself, and the faults."""
    figures = recording.summary["figures"]
    if figures.get("pilot_activations") is not None:
        yield frame.paragraph_of(footer(figures))
    if recording.reasons:
        yield frame.table(("time (s)", "what the driver tells"), [(f"{time:.1f}", why) for time, why in recording.reasons])
    if recording.entries or faults:
        yield decision_table(recording.entries, faults)


def _map(
    recording: Recording, steps: Steps, spans: Sequence[BehaviourSpan], faults: Sequence[Fault]
) -> Iterator[Html]:
    roads = roads_of(recording, steps)
    if roads.missing:
        yield frame.paragraph_of(f"Drawn without the roads: {roads.missing}. {_FROM_WHERE}")
    yield buttons_of(views_of(steps, spans))
    figure = map_figure(roads, recording.regions, steps, spans, recording.entries, faults)
    yield frame.figure_html(figure, MAP_NAME)
