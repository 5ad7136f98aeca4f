"""The store of an experiment: one DuckDB file, written by one process, a transaction a trial."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import TracebackType
from typing import Any

import duckdb

from sumo_reactive.errors import StoreError
from sumo_reactive.experiment.batch.scouting import Departure
from sumo_reactive.experiment.batch.stored_events import events_of
from sumo_reactive.experiment.batch.trial_key import release
from sumo_reactive.experiment.batch.trials import Trial
from sumo_reactive.experiment.process.task import Ending, Outcome

VERSION = 1
"""Version of the tables below; a store of another is refused."""

_TABLES = """
CREATE TABLE store (version INTEGER);
CREATE TABLE plan (key VARCHAR PRIMARY KEY, number INTEGER);
CREATE TABLE shown (name VARCHAR, number INTEGER);
CREATE TABLE trials (
    key VARCHAR PRIMARY KEY, scenario VARCHAR, ego VARCHAR, seed INTEGER, driver VARCHAR, parameters JSON, options JSON,
    ending VARCHAR, reason VARCHAR, verdict VARCHAR, attempts INTEGER, departure_s DOUBLE, wall_s DOUBLE,
    trajectory VARCHAR, replay VARCHAR, versions JSON, finished TIMESTAMP
);
CREATE TABLE metrics (key VARCHAR, name VARCHAR, value DOUBLE, PRIMARY KEY (key, name));
CREATE TABLE events (key VARCHAR, time_s DOUBLE, kind VARCHAR, user_id VARCHAR, lane_id VARCHAR, entry JSON);
CREATE TABLE departures (scouting VARCHAR, vehicle_id VARCHAR, depart_s DOUBLE, length_m DOUBLE);
"""


class Store:
    """A store that is open for writing; a context manager. Raises StoreError in one line for whatever goes wrong."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._database = connected(path, read_only=False)

    def __enter__(self) -> Store:
        return self

    def __exit__(self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    def close(self) -> None:
        """Close the file; what was put is there."""
        self._database.close()

    def plan(self, trials: Sequence[Trial], metrics: Sequence[str], *, forget_failed: bool = False) -> set[str]:
        """Note the trials of the experiment as it is now and the metrics to show; return the keys of finished ones.

        Rows of other trials stay. `forget_failed` removes what has not come to a result, so that it is tried again.
        """
        with self._transaction() as database:
            database.execute("DELETE FROM plan")
            keys = [trial.key for trial in trials]
            database.execute("INSERT INTO plan SELECT unnest(?), unnest(?)", [keys, list(range(len(keys)))])
            database.execute("DELETE FROM shown")
            database.execute("INSERT INTO shown SELECT unnest(?), unnest(?)", [list(metrics), list(range(len(metrics)))])
            if forget_failed:
                database.execute("DELETE FROM trials WHERE ending <> ?", [Ending.DONE.value])
            rows = database.execute("SELECT key FROM trials JOIN plan USING (key)").fetchall()
        return {key for (key,) in rows}

    def put(self, trial: Trial, outcome: Outcome, attempts: int) -> None:
        """Add a finished trial with its metrics and events; one that is there already stays as it is."""
        with self._transaction() as database:
            if database.execute("SELECT 1 FROM trials WHERE key = ?", [trial.key]).fetchall():
                return
            row = _row(trial, outcome, attempts)
            marks = ", ".join("?" for _ in row)
            database.execute(f"INSERT INTO trials VALUES ({marks}, now()::TIMESTAMP)", row)
            metrics = outcome.result.metrics if outcome.result else {}
            names, values = list(metrics), [None if value is None else float(value) for value in metrics.values()]
            database.execute("INSERT INTO metrics SELECT ?, unnest(?), unnest(?::DOUBLE[])", [trial.key, names, values])
            columns = [list(column) for column in zip(*events_of(outcome), strict=True)]
            if columns:
                unnested = ", ".join("unnest(?)" for _ in columns)
                database.execute(f"INSERT INTO events SELECT ?, {unnested}", [trial.key, *columns])

    def without_result(self) -> list[tuple[str, str, str]]:
        """Return key, reason and replay command of the planned trials that came to no result, in their order."""
        rows = "SELECT key, ending || ': ' || reason, replay FROM trials JOIN plan USING (key)"
        query = f"{rows} WHERE ending <> ? ORDER BY number"
        with _told(self._path):
            return self._database.execute(query, [Ending.DONE.value]).fetchall()

    def departures(self, scouting: str) -> list[Departure]:
        """Return the trips that a scouting run found; none if there was no such run."""
        query = "SELECT vehicle_id, depart_s, length_m FROM departures WHERE scouting = ? ORDER BY depart_s, vehicle_id"
        with _told(self._path):
            return [Departure(*row) for row in self._database.execute(query, [scouting]).fetchall()]

    def put_departures(self, scouting: str, found: Sequence[Departure]) -> None:
        """Keep the trips that a scouting run found."""
        columns = [list(column) for column in zip(*found, strict=True)]
        with self._transaction() as database:
            if columns:
                database.execute("INSERT INTO departures SELECT ?, unnest(?), unnest(?), unnest(?)", [scouting, *columns])

    @contextmanager
    def _transaction(self) -> Iterator[duckdb.DuckDBPyConnection]:
        with _told(self._path):
            self._database.begin()
            try:
                yield self._database
                self._database.commit()
            except BaseException:
                _roll_back(self._database)
                raise


def connected(path: Path, *, read_only: bool) -> duckdb.DuckDBPyConnection:
    """Open a store; a new one is made if `read_only` does not hold. Raises StoreError."""
    is_new = not path.exists()
    if is_new and read_only:
        raise StoreError(f"{path}: no such file")
    with _told(path):
        path.parent.mkdir(parents=True, exist_ok=True)
        database = duckdb.connect(str(path), read_only=read_only)
    try:
        with _told(path):
            if is_new or (not read_only and _is_empty(database)):
                database.execute(f"BEGIN; {_TABLES} INSERT INTO store VALUES ({VERSION}); COMMIT")
            _require_version(path, database)
    except BaseException:
        database.close()
        raise
    return database


def _is_empty(database: duckdb.DuckDBPyConnection) -> bool:
    return not database.execute("SELECT 1 FROM duckdb_tables()").fetchall()


def _require_version(path: Path, database: duckdb.DuckDBPyConnection) -> None:
    try:
        rows = database.execute("SELECT version FROM store").fetchall()
    except duckdb.CatalogException as error:
        raise StoreError(f"{path}: a DuckDB file, but not the store of an experiment") from error
    if rows != [(VERSION,)]:
        found = rows[0][0] if rows else "unknown"
        raise StoreError(f"{path}: a store of version {found}, this release reads and writes version {VERSION}")


def _row(trial: Trial, outcome: Outcome, attempts: int) -> Iterable[Any]:
    scenario, result = trial.task.scenario, outcome.result
    return [
        trial.key, trial.scenario, result.ego if result else scenario.ego, scenario.seed, trial.task.driver.value,
        json.dumps(dict(trial.parameters), sort_keys=True), json.dumps(dict(trial.options), sort_keys=True),
        outcome.ending.value, outcome.reason, result.verdict if result else None, attempts,
        result.departure_s if result else None, outcome.wall_s, outcome.trajectory, trial.replay, json.dumps(release()),
    ]  # fmt: skip


def _roll_back(database: duckdb.DuckDBPyConnection) -> None:
    try:
        database.rollback()
    except duckdb.Error:
        return


@contextmanager
def _told(path: Path) -> Iterator[None]:
    """Turn an error of DuckDB into one line."""
    try:
        yield
    except duckdb.CatalogException:
        raise
    except (duckdb.Error, OSError) as error:
        raise StoreError(f"{path}: {_line_of(str(error))}") from error


def _line_of(message: str) -> str:
    first = " ".join(message.splitlines()[0].split()) if message else "unknown error"
    if holder := re.search(r"lock is held.*?\(PID (\d+)\)", message):
        return f"in use by process {holder[1]}: one batch at a time writes to a store"
    if re.search(r"No space left|Disk quota|File too large|disk is full", message, re.IGNORECASE):
        return f"no room to write: {first}; make room and run the batch again, finished trials are kept"
    if "not a valid DuckDB" in message:
        return "not the store of an experiment"
    return f"cannot be used: {first}"
