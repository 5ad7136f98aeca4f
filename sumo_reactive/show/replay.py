"""The replay of a run: all that its record holds, packed into the page, and the player that shows it."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from html import escape
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Any

import duckdb
from pydantic import Field

from sumo_reactive.driver.nouns.decision import Occupancy, Reason
from sumo_reactive.errors import ScenarioError
from sumo_reactive.files import is_there
from sumo_reactive.lab.schema import RECORD_VERSION, Keys, Number, read_json, require_version
from sumo_reactive.lab.surroundings_record import SURROUNDINGS, USER_NUMBERS, USERS
from sumo_reactive.lab.tables import parquet_rows
from sumo_reactive.lab.trace import Entry
from sumo_reactive.lab.under_way import PROCESS
from sumo_reactive.show.explain import paragraph
from sumo_reactive.show.page import BEHAVIOUR_COLOURS, Html, packed, stored
from sumo_reactive.show.recording import CLOSE_S, Recording, Steps
from sumo_reactive.show.sentences import REASONS

MOST_USER_ROWS = 5_000_000
"""Users in steps that are read at most: an hour among 140 others."""

_CM, _MRAD = 100, 1000
"""What places and speeds, and headings, are rounded to."""

_Place = Annotated[list[Number], Field(min_length=2, max_length=2)]
_Line = list[_Place]
_Constraint = tuple[Number, Number, Number, Number | None, str, str]
RoomKeys = tuple[str, _Line, Occupancy, str, bool]
"""Connection, points of C, state, cause, whether the ego waits."""
_FieldKeys = tuple[Number, list[Number], list[Number], list[list[Number | None]]]

_GroundKeys = tuple[Number, tuple[Number, Number, Number], list[Number], list[Number], list[list[Number | None]]]


class SurroundingsKeys(Keys):
    """`surroundings.json`."""

    version: int
    lanes: dict[str, _Line]
    inside: dict[str, _Line]
    lights: list[tuple[str, int, Number, Number, Number, Number]]
    letters: list[tuple[Number, dict[str, str]]]
    curves: list[tuple[Number, _Line]]
    constraints: list[tuple[Number, list[_Constraint]]]
    rooms: list[tuple[Number, list[RoomKeys]]]
    fields: list[_FieldKeys]
    shadows: list[tuple[Number, list[tuple[str, Number, _Line]]]]
    grounds: list[_GroundKeys]


_SHORT = {
    Reason.RED_LIGHT: "red: {}", Reason.YELLOW_LIGHT: "yellow: {}", Reason.STOP_SIGN: "full stop",
    Reason.SCHEDULED_STOP: "stop of the route", Reason.EXIT_BLOCKED: "no room behind: {}", Reason.NO_GAP: "no gap beside",
    Reason.QUEUE_CHANGE: "no gap to leave the queue", Reason.NARROW_TURN: "turn in several moves",
    Reason.BLOCKED: "blocked by {}",
}  # fmt: skip
"""What stands at a line to stop at; at all others somebody is waited for."""


def replay_of(recording: Recording, steps: Steps) -> Html | None:
    """Return the player with its data; None for a record without surroundings. Raises ScenarioError for a damaged one."""
    if not (is_there(recording.folder / SURROUNDINGS) and is_there(recording.folder / USERS)):
        return None
    text = json.dumps(payload_of(recording, steps), allow_nan=False, separators=(",", ":"))
    style, script = (Path(__file__).with_name(f"replay.{kind}").read_text(encoding="utf-8") for kind in ("css", "js"))
    return Html(f"<style>{style}</style>{_PLAYER}{stored('replay', packed(text))}<script>{script}</script>")


def payload_of(recording: Recording, steps: Steps) -> dict[str, Any]:
    """Return what the player shows as plain data, as `replay.js` reads it."""
    found = read_json(recording.folder / SURROUNDINGS, SurroundingsKeys, "the surroundings of a run")
    require_version(found.version, RECORD_VERSION, str(recording.folder / SURROUNDINGS))
    users = _users(recording, steps)
    numbers = {name: k for k, name in enumerate(users["ids"])}
    behaviours = list(dict.fromkeys(steps["behaviour"]))
    limits = recording.summary.get("length_m"), recording.summary.get("width_m")
    return {
        "times": steps.times,
        "ego": {
            "x": steps["x_m"], "y": steps["y_m"], "heading": steps["heading_rad"], "speed": steps["speed_m_s"],
            "behaviour": [behaviours.index(one) for one in steps["behaviour"]],
            "leader": [numbers.get(name or "", -1) for name in steps["leader"]],
            "length": limits[0] or _USUAL_M[0], "width": limits[1] or _USUAL_M[1],
        },
        "behaviours": behaviours,
        "colours": {behaviour.value: colour for behaviour, colour in BEHAVIOUR_COLOURS.items()},
        "users": users,
        "lanes": [_flat(line) for line in found.lanes.values()],
        "inside": [_flat(line) for line in found.inside.values()],
        "lights": found.lights,
        "letters": found.letters,
        "regions": {name: _flat(corners) for name, corners in recording.regions.items()},
        "states": [[entry.time, _states(entry)] for entry in recording.entries],
        "curves": [[time, _flat(line)] for time, line in found.curves],
        "constraints": [[time, [[*one[:4], _label(*one[4:], one[3])] for one in some]] for time, some in found.constraints],
        "rooms": [[time, [[_flat(one[1]), *room_told(one)] for one in some]] for time, some in found.rooms],
        "fields": _fields(found.fields, steps),
        "shadows": [[time, [[weight, _flat(line)] for _, weight, line in some]] for time, some in found.shadows],
        "grounds": found.grounds,
        "decisions": list(_decisions(recording)),
        "is_under_way": PROCESS in recording.summary,
    }  # fmt: skip


_USUAL_M = 5.0, 1.8
"""Length and width of a car whose record does not tell them."""


def _users(recording: Recording, steps: Steps) -> dict[str, Any]:
    """Return everybody, and the tracks: user, first step, then x, y, heading, speed and signals as `_changes`."""
    path = recording.folder / USERS
    query = f"SELECT \"user\", {', '.join(USER_NUMBERS)} FROM steps ORDER BY time_s"
    try:
        rows = parquet_rows(path, query, MOST_USER_ROWS)
        ids = {name: k for k, name in enumerate(dict.fromkeys(str(row[0]) for row in rows))}
        sizes = {ids[str(row[0])]: (round(float(row[6]), 2), round(float(row[7]), 2)) for row in rows}
        tracks = _tracks(rows, ids, steps.times)
    except (duckdb.Error, TypeError, ValueError, OverflowError, MemoryError, RuntimeError) as error:
        raise ScenarioError(f"{path}: not the users of a run: {' '.join(str(error).split())}") from error
    lengths, widths = ([sizes[k][side] for k in range(len(ids))] for side in (0, 1))
    return {"ids": list(ids), "length": lengths, "width": widths, "tracks": tracks}


def _tracks(rows: Iterable[Sequence[Any]], ids: Mapping[str, int], times: Sequence[float]) -> list[list[Any]]:
    """Return a track for each time that somebody is seen without a gap."""
    tracks: list[tuple[int, int, list[tuple[int, ...]]]] = []
    latest: dict[int, int] = {}
    step = 0
    for name, time, x, y, heading, speed, _, _, signals in rows:
        while step + 1 < len(times) and times[step] < time - CLOSE_S:
            step += 1
        user = ids[str(name)]
        at = latest.get(user)
        if at is None or tracks[at][1] + len(tracks[at][2]) != step:
            at = latest[user] = len(tracks)
            tracks.append((user, step, []))
        moved = round(x * _CM), round(y * _CM), round(heading * _MRAD), round(speed * _CM), int(signals)
        tracks[at][2].append(moved)
    return [[user, first, *map(_changes, zip(*held, strict=True))] for user, first, held in tracks]


def _changes(values: Iterable[int]) -> list[int]:
    """Return the changes of the changes from one to the next, both from zero on: small where somebody drives steadily."""
    once = [after - before for before, after in pairwise((0, *values))]
    return [after - before for before, after in pairwise((0, *once))]


def _flat(line: Iterable[Sequence[float]]) -> list[float]:
    return [value for place in line for value in place]


def _states(entry: Entry) -> dict[str, list[str]]:
    return {state.region: [state.occupancy.value, state.user_id] for state in entry.regions}


def _label(reason: str, cause: str, until: float | None) -> str:
    known = next((short for one, short in _SHORT.items() if one.value == reason), "wait for {}" if cause else reason)
    return known.format(cause) + (f" until {until:.1f} s" if until is not None else "")


def room_told(room: RoomKeys) -> tuple[str, str]:
    """Return how a post-conflict region is coloured, and its state in a sentence."""
    connection, _, occupancy, cause, waits = room
    if occupancy is Occupancy.OCCUPIED:
        told = REASONS[Reason.EXIT_BLOCKED].waits.format(region=connection, cause=cause)
        return occupancy.value, f"The post-conflict region is taken: the ego {told}."
    if waits:
        told = f"it would have to stop{f' for {cause}' if cause else ''} in the room behind."
        return Occupancy.CLAIMED.value, f"The ego waits before connection {connection}: {told}"
    held = "held by the ego" if occupancy is Occupancy.OWN else "free"
    return occupancy.value, f"The post-conflict region behind connection {connection} is {held}."


def _fields(found: Sequence[_FieldKeys], steps: Steps) -> list[list[Any]]:
    """Return the lattices, each with the command chosen then."""
    gains, rates = steps["command_acceleration_m_s2"], steps["command_steering_rate_rad_s"]
    at = [steps.index_at(field[0]) for field in found]
    return [[*field, gains[k], rates[k]] for field, k in zip(found, at, strict=True)]


def _decisions(recording: Recording) -> Iterable[tuple[float, str, list[str]]]:
    """Yield what was decided: time, sentence, the road users named."""
    for before, entry in zip((None, *recording.entries), recording.entries, strict=False):
        named = {event.cause for event in entry.events} | {decision.cause for decision in entry.decisions}
        named |= {entry.assessment.encounter.user_id} if entry.assessment.encounter else set()
        yield entry.time, paragraph(entry, before), sorted(named - {""})


def _button(name: str, text: str, *, pressed: bool | None = None) -> str:
    state = "" if pressed is None else f' aria-pressed="{str(pressed).lower()}"'
    return f'<button type="button" data-part="{name}"{state}>{escape(text)}</button>'


_PLAYER = (
    '<div class="replay" id="replay-player"><canvas data-part="map" tabindex="0" role="application" '
    'aria-label="Map of the run. Space plays, arrows step, comma and full stop go to the decisions before and after, '
    'plus and minus zoom, f follows the ego, h shows the field, '
    'g shows U on the ground, s the shadows of the others, n shows names."></canvas><div class="bar">'
    + _button("play", "Play") + _button("back", "‹ decision") + _button("on", "decision ›")
    + '<select data-part="rate" aria-label="speed">'
    + "".join(f'<option value="{rate}"{" selected" * (rate == 1)}>×{rate}</option>' for rate in (0.25, 0.5, 1, 2, 4, 8))
    + '</select><input type="range" data-part="time" aria-label="simulation time, s"><output data-part="clock"></output>'
    + _button("out", "−") + _button("in", "+") + _button("follow", "follow", pressed=True)
    + _button("field", "field", pressed=True) + _button("ground", "ground", pressed=True)
    + _button("shadows", "shadows", pressed=True) + _button("names", "names", pressed=False)
    + '</div><div class="said" data-part="said" aria-live="polite"></div><div class="about" data-part="about"></div></div>'
)  # fmt: skip


def facts_of(summary: Mapping[str, Any]) -> str:
    """Return how the player is used, in a sentence."""
    return (
        "Play, or drag the time; click on a vehicle to see what was decided about it, on a decision below to go there. "
        f"Shown are {summary['ego']} in the colour of its behaviour, its leader framed, C, places to stop at, "
        "conflict regions, and post-conflict regions as stripes: a click on one tells its state."
    )
