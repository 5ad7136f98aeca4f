"""A recorded run, read back from its folder."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import duckdb

from sumo_reactive.errors import ScenarioError
from sumo_reactive.experiment.recorder import DECISIONS, SUMMARY, TRAJECTORY
from sumo_reactive.experiment.sealed import parquet_rows
from sumo_reactive.experiment.trace import Entry, read_entries


@dataclass(frozen=True)
class Recording:
    """The record in `folder`: its summary as plain data and the pilot's entries in order of time."""

    folder: Path
    summary: Mapping[str, Any]
    entries: tuple[Entry, ...]


class EgoState(NamedTuple):
    """The ego at a recorded step: speeds in m/s; `leader` limits it at distance `gap` (m, None: no leader)."""

    time: float
    speed: float
    desired_speed: float
    leader: str
    gap: float | None


_NEEDED = ("ego", "scenario", "verdict", "figures")
_STATE = "time_s, speed_m_s, desired_speed_m_s, leader, gap_m"
CLOSE_S = 1e-6
"""Times nearer than this are the same, s."""


def load(folder: Path) -> Recording:
    """Read the record of a run; raise ScenarioError for a folder that holds none."""
    if not folder.is_dir():
        raise ScenarioError(f"{folder}: {'a file, not a folder' if folder.exists() else 'no such folder'}")
    missing = [name for name in (SUMMARY, DECISIONS, TRAJECTORY) if not (folder / name).is_file()]
    if missing:
        raise ScenarioError(f"{folder}: not the record of a run: it has no {' and no '.join(missing)}")
    return Recording(folder, _summary(folder / SUMMARY), read_entries(folder / DECISIONS))


def state_at(recording: Recording, time: float) -> EgoState:
    """Return the ego at the last step up to `time` (s); raise ScenarioError for a time outside the run."""
    path = recording.folder / TRAJECTORY
    try:
        ((first, last),) = parquet_rows(path, "SELECT min(time_s), max(time_s) FROM steps", 1)
        if first is None:
            raise ScenarioError(f"{recording.folder}: the run has no steps")
        if not first - CLOSE_S <= time <= last + CLOSE_S:
            raise ScenarioError(f"{recording.folder}: {time:g} s is outside the run ({first:.1f} to {last:.1f} s)")
        last_up_to = f"WHERE time_s <= {time + CLOSE_S!r} ORDER BY time_s DESC LIMIT 1"
        found = parquet_rows(path, f"SELECT {_STATE} FROM steps {last_up_to}", 1)
    except duckdb.Error as error:
        raise ScenarioError(f"{path}: not the trajectory of a run: {' '.join(str(error).split())}") from error
    return EgoState(*found[0])


def _summary(path: Path) -> Mapping[str, Any]:
    try:
        summary = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise ScenarioError(f"{path}: not the summary of a run: {error}") from error
    if not isinstance(summary, dict):
        raise ScenarioError(f"{path}: not the summary of a run")
    missing = [key for key in _NEEDED if key not in summary]
    if missing:
        raise ScenarioError(f"{path}: not the summary of a run: key '{missing[0]}' is missing")
    return summary
