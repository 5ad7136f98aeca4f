"""A recorded run, read back from its folder: the keys and columns of its files that explanations and pages read."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any

import duckdb
from pydantic import AfterValidator, ConfigDict, Field, TypeAdapter, ValidationError

from sumo_reactive.driver.nouns.decision import Behaviour
from sumo_reactive.errors import ScenarioError
from sumo_reactive.files import is_there, text_of
from sumo_reactive.lab.recorder import DECISIONS, REGIONS, SAID, SUMMARY, TRAJECTORY
from sumo_reactive.lab.schema import MOST_RECORD_BYTES, RECORD_VERSION, Keys, Number, checked, read_json, require_version
from sumo_reactive.lab.tables import parquet_rows
from sumo_reactive.lab.trace import Entry, read_entries

MAX_STEPS = 1_000_000
"""More than a day in steps of 0.1 s."""

CLOSE_S = 1e-6
"""Times nearer than this are the same, s."""

_DECIMALS = 4
"""Enough for a picture; the record has the rest."""

_Text = Annotated[str, Field(min_length=1)]
_Corner = Annotated[list[Number], Field(min_length=2, max_length=2)]
_Regions = dict[str, Annotated[list[_Corner], Field(min_length=1)]]
_Numbers, _Gaps, _Texts = list[Number], list[Number | None], list[str]
_COLUMNS: dict[str, Any] = {
    **dict.fromkeys(("time_s", "x_m", "y_m", "speed_m_s", "heading_rad"), _Numbers),
    **dict.fromkeys(
        (
            "s_m", "u", "u1", "u2", "u3", "desired_speed_m_s", "stop_m", "gap_m", "command_acceleration_m_s2",
            "command_steering_rate_rad_s",
        ),
        _Gaps,
    ),
    "lane_id": _Texts,
    "leader": list[str | None],
    "behaviour": list[Annotated[str, AfterValidator(lambda name: Behaviour(name).value)] | None],
    "emergency": list[bool | None],
}
"""The columns of the trajectory that are read, and what each holds; None where the driver has no such thing."""


class _FaultKeys(Keys):
    model_config = ConfigDict(extra="forbid")

    time_s: Number
    user_id: str
    lane_id: str


class _ViolationKeys(_FaultKeys):
    kind: str


class _ReasonKeys(Keys):
    time_s: Number
    reason: str


class _SummaryKeys(Keys):
    model_config = ConfigDict(extra="allow")

    version: int = 0
    ego: _Text
    scenario: _Text
    verdict: _Text
    figures: dict[str, Number | None]
    seed: int | None = None
    departure_s: Number | None = None
    end_s: Number | None = None
    duration_s: Number | None = None
    time_loss_s: Number | None = None
    distance_m: Number | None = None
    collisions: tuple[_FaultKeys, ...] = ()
    violations: tuple[_ViolationKeys, ...] = ()
    hard_brakes: tuple[_FaultKeys, ...] = ()


@dataclass(frozen=True, kw_only=True)
class Recording:
    """The record in `folder`: its summary as plain data, the pilot's entries in order of time, outlines of regions, m.

    `reasons`: from when on (s) a driver of the user's gave which reason.
    """

    folder: Path
    summary: Mapping[str, Any]
    entries: tuple[Entry, ...]
    regions: Mapping[str, Sequence[Sequence[float]]] = field(default_factory=dict)
    reasons: tuple[tuple[float, str], ...] = ()


@dataclass(frozen=True)
class Steps:
    """The columns of a trajectory that are read, a value a step in order of time, None where there is none."""

    columns: Mapping[str, list[Any]]

    def __getitem__(self, name: str) -> list[Any]:
        return self.columns[name]

    @property
    def times(self) -> list[float]:
        """Simulation time of each step, s."""
        return self.columns["time_s"]

    def behaviour(self, k: int) -> Behaviour | None:
        """Return what the ego did in step `k`; None: its driver does not tell."""
        name = self.columns["behaviour"][k]
        return Behaviour(name) if name else None

    def index_at(self, time: float) -> int:
        """Return the index of the step nearest to a time (s)."""
        return min(range(len(self.times)), key=lambda k: abs(self.times[k] - time))

    def difference(self, first: str, second: str) -> list[float | None]:
        """Return one column less another, None where one of them has no value."""
        pairs = zip(self[first], self[second], strict=True)
        return [None if a is None or b is None else round(a - b, _DECIMALS) for a, b in pairs]


def read_run(folder: Path) -> Recording:
    """Read the record of a run; raise ScenarioError for a folder that holds none, naming file and key."""
    if not folder.is_dir():
        raise ScenarioError(f"{folder}: {'a file, not a folder' if folder.exists() else 'no such folder'}")
    missing = [name for name in (SUMMARY, DECISIONS, TRAJECTORY) if not (folder / name).is_file()]
    if missing:
        raise ScenarioError(f"{folder}: not the record of a run: it has no {' and no '.join(missing)}")
    told = read_json(folder / SUMMARY, _SummaryKeys, "the summary of a run")
    require_version(told.version, RECORD_VERSION, str(folder / SUMMARY))
    summary = told.model_dump(exclude_unset=True)
    entries = tuple(sorted(read_entries(folder / DECISIONS), key=lambda entry: entry.time))
    has_regions = is_there(folder / REGIONS)
    regions = read_json(folder / REGIONS, _Regions, "the regions of a run") if has_regions else {}
    reasons = _read_reasons(folder / SAID) if is_there(folder / SAID) else ()
    return Recording(folder=folder, summary=summary, entries=entries, regions=regions, reasons=reasons)


def _read_reasons(path: Path) -> tuple[tuple[float, str], ...]:
    lines = text_of(path, most=MOST_RECORD_BYTES).splitlines()
    keys = (checked(line, _ReasonKeys, f"{path}:{k}", "a driver's reason") for k, line in enumerate(lines, start=1))
    return tuple(sorted((one.time_s, one.reason) for one in keys))


def state_at(recording: Recording, time: float) -> dict[str, Any]:
    """Return what the last step up to `time` (s) says; raise ScenarioError for a time outside the run."""
    columns = columns_of(recording, ("time_s", "speed_m_s", "desired_speed_m_s", "leader", "gap_m"))
    times = columns["time_s"]
    if not times[0] - CLOSE_S <= time <= times[-1] + CLOSE_S:
        raise ScenarioError(f"{recording.folder}: {time:g} s is outside the run ({times[0]:.1f} to {times[-1]:.1f} s)")
    k = bisect_right(times, time + CLOSE_S) - 1
    return {name: values[k] for name, values in columns.items()}


def read_steps(recording: Recording) -> Steps:
    """Read the trajectory of a run; raise ScenarioError for one that lacks a column or a step."""

    def rounded(value: object) -> object:
        return round(value, _DECIMALS) if isinstance(value, float) else value

    return Steps({name: [*map(rounded, column)] for name, column in columns_of(recording, tuple(_COLUMNS)).items()})


def columns_of(recording: Recording, names: Sequence[str]) -> dict[str, list[Any]]:
    """Return columns of the trajectory, a value a step in order of time, None where there is none.

    Raises ScenarioError for a file that lacks one, holds something else in it, or has no step.
    """
    path = recording.folder / TRAJECTORY
    try:
        rows = parquet_rows(path, f"SELECT {', '.join(names)} FROM steps ORDER BY time_s", MAX_STEPS)
    except (duckdb.Error, MemoryError, RuntimeError) as error:  # the last one where a name in the file is no text
        raise ScenarioError(f"{path}: not the trajectory of a run: {' '.join(str(error).split())}") from error
    if not rows:
        raise ScenarioError(f"{recording.folder}: the run has no steps")
    columns = dict(zip(names, map(list, zip(*rows, strict=True)), strict=True))
    for name, values in columns.items():
        try:
            TypeAdapter(_COLUMNS[name]).validate_python(values, strict=True)
        except ValidationError as error:
            problem = error.errors()[0]
            told = f"column '{name}', step {problem['loc'][0]}: {problem['msg']}"
            raise ScenarioError(f"{path}: not the trajectory of a run: {told}") from error
    return columns
