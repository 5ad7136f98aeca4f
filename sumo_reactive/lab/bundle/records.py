"""Which runs a record holds: that of one trip, a comparison's folder, or the store of a batch."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Annotated, NamedTuple

from pydantic import Field

from sumo_reactive.errors import ScenarioError
from sumo_reactive.files import is_there
from sumo_reactive.lab.batch.stored_results import Results
from sumo_reactive.lab.comparison.record import CSV_FILE, JSON_FILE
from sumo_reactive.lab.comparison.recorded import SideKeys, read_comparison
from sumo_reactive.lab.drivers.choice import SUMO
from sumo_reactive.lab.recorder import FILES, FLEET, SUMMARY
from sumo_reactive.lab.schema import RECORD_VERSION, Keys, read_json, require_version
from sumo_reactive.lab.task import Task, task_of

_DONE = "SELECT replay, trajectory, versions FROM plan JOIN trials USING (key) WHERE ending = 'done' ORDER BY number"


class RecordedRun(NamedTuple):
    """What was driven, and the digest of its steps."""

    task: Task
    trajectory: str


class Record(NamedTuple):
    """The `runs` of a record with a result, each set of `versions` that drove them once, and the `files` that it is in."""

    runs: tuple[RecordedRun, ...]
    versions: tuple[dict[str, str], ...]
    files: tuple[Path, ...]


class _SummaryKeys(Keys):
    version: int = 0
    command: Annotated[str, Field(min_length=1)]
    trajectory: Annotated[str, Field(min_length=1)]
    versions: dict[str, str]


class _VersionsKeys(Keys):
    versions: dict[str, str]


def read_record(path: Path) -> Record:
    """Return the runs of a folder of `run --out` or `compare --out`, or of a batch's store.

    Raises ScenarioError for something else, for several egos, and for a record of an older release.
    """
    if path.is_file():
        return _store(path)
    if is_there(path / FLEET):
        raise ScenarioError(f"{path}: the record of several egos; a bundle takes the store of a batch with shares of them")
    if is_there(path / JSON_FILE):
        return _comparison(path)
    summary = read_json(path / SUMMARY, _SummaryKeys, "the summary of a run that can be driven again")
    require_version(summary.version, RECORD_VERSION, str(path / SUMMARY))
    files = tuple(path / name for name in FILES if is_there(path / name))
    return Record((RecordedRun(task_of(summary.command), summary.trajectory),), (summary.versions,), files)


def _comparison(folder: Path) -> Record:
    found = read_comparison(folder)
    driver = found.drivers[1]
    runs = tuple(run for pair in found.pairs for run in _of_pair(pair.sumo, pair.side(driver)))
    if not runs:
        raise ScenarioError(f"{folder / JSON_FILE}: no run has the digest of its steps: compare again with this release")
    versions = read_json(folder / JSON_FILE, _VersionsKeys, "a comparison").versions
    return Record(runs, (versions,), (folder / JSON_FILE, folder / CSV_FILE))


def _of_pair(sumo: SideKeys, driven: SideKeys) -> Iterator[RecordedRun]:
    """Yield both runs of a pair that came to a result; SUMO's own driver's is driven by the same command."""
    task = task_of(driven.command)
    if driven.trajectory:
        yield RecordedRun(task, driven.trajectory)
    if sumo.trajectory:
        yield RecordedRun(replace(task, scenario=replace(task.scenario, driver=SUMO)), sumo.trajectory)


def _store(path: Path) -> Record:
    with Results(path) as store:
        rows = store.rows(_DONE)
    if not rows:
        raise ScenarioError(f"{path}: no trial has come to a result")
    told = dict.fromkeys(versions for _, _, versions in rows)
    runs = tuple(RecordedRun(task_of(replay), trajectory) for replay, trajectory, _ in rows)
    return Record(runs, tuple(json.loads(text) for text in told), (path,))
