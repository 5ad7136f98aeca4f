"""A store as a file that somebody else may have written: its tables and rows, how it is opened, what it may not hold."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Self

import duckdb

from sumo_reactive.errors import InputError, StoreError
from sumo_reactive.lab.own_metrics import OWN_NAME
from sumo_reactive.lab.tables import opened, require_regular
from sumo_reactive.lab.task import Ending, Outcome
from sumo_reactive.lab.trace import line_of

VERSION = 2
"""Version of the tables below; a store of another is refused."""

STORE_TABLES = """
CREATE TABLE store ( -- the store itself: one row
    version INTEGER -- of these tables
);
CREATE TABLE plan ( -- the trials of the experiment as it was run last
    key VARCHAR PRIMARY KEY, -- of the trial
    number INTEGER -- its place in the experiment, from 0
);
CREATE TABLE shown ( -- the metrics that `results` shows unasked
    name VARCHAR, -- key of the metric
    number INTEGER -- its place among them, from 0
);
CREATE TABLE trials ( -- a row a trial that has ended
    key VARCHAR PRIMARY KEY, -- digest of all that its numbers depend on
    scenario VARCHAR, -- as the experiment names it
    ego VARCHAR, -- the vehicle driven; empty: a share of all cars
    seed INTEGER, -- seed of the random numbers
    driver VARCHAR, -- who drove
    parameters JSON, -- parameters that vary, by name
    options JSON, -- SUMO options that vary, by name
    ending VARCHAR, -- done, failed, crashed or timeout
    reason VARCHAR, -- why there is no result; empty: there is one
    verdict VARCHAR, -- what it came to, in a line; NULL: to no result
    attempts INTEGER, -- how often it was tried
    departure_s DOUBLE, -- simulation time at which the ego departed
    wall_s DOUBLE, -- wall-clock time
    trajectory VARCHAR, -- digest of all its steps; empty: no result
    replay VARCHAR, -- the command that repeats it
    versions JSON, -- of this package, SUMO and libraries, and a digest of the sources
    finished TIMESTAMP -- when it was stored
);
CREATE TABLE metrics ( -- a row a trial and metric
    key VARCHAR, -- of the trial
    name VARCHAR, -- key of the metric
    value DOUBLE, -- in the unit that the name ends in; NULL: there is none
    PRIMARY KEY (key, name)
);
CREATE TABLE events ( -- faults, emergencies and decisions
    key VARCHAR, -- of the trial
    time_s DOUBLE, -- simulation time
    kind VARCHAR, -- emergency, decision, or the kind of a fault
    user_id VARCHAR, -- whom it concerns; empty: nobody
    lane_id VARCHAR, -- lane of the ego at a fault
    entry JSON -- of a decision or an emergency: a line as in `decisions.jsonl`
);
CREATE TABLE departures ( -- trips that a run of SUMO alone has found, to draw egos from
    scouting VARCHAR, -- digest of that run
    vehicle_id VARCHAR, -- who drove it
    depart_s DOUBLE, -- simulation time at which it began
    length_m DOUBLE -- how long it was
);
CREATE TABLE diagram ( -- points of the fundamental diagram of a run with a share of egos
    key VARCHAR, -- of the trial
    edges VARCHAR, -- group of edges
    begin_s DOUBLE, -- simulation time at which the interval begins
    end_s DOUBLE, -- simulation time at which it ends
    flow_per_h DOUBLE, -- vehicles an hour and lane
    density_per_km DOUBLE, -- vehicles a kilometre of lane
    speed_m_s DOUBLE -- way driven over the time that it took
);
"""

MAX_LETTERS = 100_000
"""No name, command or reason is longer."""

MAX_VALUE = 1e12
"""No figure is larger; with more, means overflow."""

_SHAPE = "SELECT table_name, sql FROM duckdb_tables() WHERE schema_name = 'main' AND NOT temporary AND NOT internal"
_FOREIGN = """
SELECT 'view', view_name FROM duckdb_views() WHERE NOT internal
UNION ALL SELECT 'function', function_name FROM duckdb_functions() WHERE NOT internal
UNION ALL SELECT 'type', type_name FROM duckdb_types() WHERE NOT internal
"""


def _words(values: Iterable[str]) -> str:
    return ", ".join(f"'{value}'" for value in values)


_TEXTS = ("key", "scenario", "driver", "parameters", "options", "ending", "reason", "replay")
_FIGURES_OF_POINTS = ("begin_s", "end_s", "flow_per_h", "density_per_km")
_WRONG = {
    "plan": "number IS NULL",
    "shown": f"number IS NULL OR name IS NULL OR NOT regexp_full_match(name, '{OWN_NAME.pattern}')",
    "trials": " OR ".join(
        [
            *(f"{name} IS NULL OR length({name}) > {MAX_LETTERS}" for name in _TEXTS),
            *(f"length({name}) > {MAX_LETTERS}" for name in ("ego", "verdict", "trajectory")),
            *(f"NOT json_valid({name}) OR json_type({name}) <> 'OBJECT'" for name in ("parameters", "options")),
            "driver = ''",
            f"ending NOT IN ({_words(ending.value for ending in Ending)})",
            "seed IS NULL",
        ]
    ),
    "metrics": f"NOT abs(value) <= {MAX_VALUE} OR length(name) > {MAX_LETTERS}",
    "diagram": " OR ".join(
        [
            f"coalesce(edges, '') = '' OR length(edges) > {MAX_LETTERS} OR key IS NULL",
            *(f"NOT coalesce(abs({name}), 'nan') <= {MAX_VALUE}" for name in _FIGURES_OF_POINTS),
            f"NOT abs(speed_m_s) <= {MAX_VALUE}",
        ]
    ),
    "departures": f"coalesce(vehicle_id, '') = '' OR NOT coalesce(abs(depart_s) + abs(length_m), 'nan') <= {MAX_VALUE}",
}
"""Rows that no batch writes, by table."""


@contextmanager
def told(path: Path) -> Iterator[None]:
    """Turn an error of DuckDB, and what it cannot hand over, into one line."""
    try:
        yield
    except StoreError:
        raise
    except InputError as error:
        raise StoreError(str(error)) from error
    except (duckdb.Error, OSError, MemoryError, OverflowError, ValueError) as error:
        raise StoreError(f"{path}: {_line_of(str(error).replace(str(path), path.name))}") from error


def _line_of(message: str) -> str:
    first = " ".join(message.splitlines()[0].split()) if message else "unknown error"
    if holder := re.search(r"lock is held.*?\(PID (\d+)\)", message):
        return f"in use by process {holder[1]}: one batch at a time writes to a store"
    if re.search(r"No space left|Disk quota|File too large|disk is full", message, re.IGNORECASE):
        return f"no room to write: {first}; make room and run the batch again, finished trials are kept"
    if "not a valid DuckDB" in message:
        return "not the store of an experiment"
    return f"cannot be used: {first}"


def _connected(path: Path, *, read_only: bool, files: Sequence[str] = ()) -> duckdb.DuckDBPyConnection:
    """Open a store; a new one is made if `read_only` does not hold. Raises StoreError for whatever else there is."""
    is_new = not os.path.lexists(path)
    if is_new and read_only:
        raise StoreError(f"{path}: no such file")
    with told(path):
        for file in () if is_new else (path, path.with_name(f"{path.name}.wal")):
            if file == path or os.path.lexists(file):
                require_regular(file)
        path.parent.mkdir(parents=True, exist_ok=True)
        database = opened(path, read_only=read_only, files=files)
    try:
        with told(path):
            _require_no_code(path, database)
            if is_new or (not read_only and not database.execute(_SHAPE).fetchall()):
                database.execute(f"BEGIN; {STORE_TABLES} INSERT INTO store VALUES ({VERSION}); COMMIT")
            _require_version(path, database)
            _require_tables(path, database)
            _require_values(path, database)
    except BaseException:
        database.close()
        raise
    return database


class StoreFile:
    """A store that is open; a context manager. Raises StoreError in one line for whatever goes wrong.

    It gets at no file but the store and `files`.
    """

    def __init__(self, path: Path, *, read_only: bool, files: Sequence[str] = ()) -> None:
        self.path = path
        self.database = _connected(path, read_only=read_only, files=files)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Close the file; what was put is there."""
        self.database.close()

    def rows(self, query: str, values: Sequence[object] = ()) -> list[tuple[Any, ...]]:
        """Return what a query gives."""
        with told(self.path):
            return self.database.execute(query, list(values)).fetchall()


def _require_no_code(path: Path, database: duckdb.DuckDBPyConnection) -> None:
    """A view in place of a table, or a function in place of DuckDB's own, would be run by whoever reads the store."""
    found = database.execute(_FOREIGN).fetchone()
    if found is not None:
        raise StoreError(f"{path}: holds a {found[0]} '{found[1][:80]}': a store holds tables alone")


def _require_version(path: Path, database: duckdb.DuckDBPyConnection) -> None:
    try:
        rows = database.execute("SELECT version::VARCHAR FROM store LIMIT 2").fetchall()
    except (duckdb.CatalogException, duckdb.BinderException) as error:
        raise StoreError(f"{path}: a DuckDB file, but not the store of an experiment") from error
    if rows != [(str(VERSION),)]:
        found = str(rows[0][0])[:20] if rows else "unknown"
        raise StoreError(f"{path}: a store of version {found}, this release reads and writes version {VERSION}")


def _require_tables(path: Path, database: duckdb.DuckDBPyConnection) -> None:
    with duckdb.connect() as fresh:
        wanted = dict(fresh.execute(f"{STORE_TABLES} {_SHAPE}").fetchall())
    found = dict(database.execute(_SHAPE).fetchall())
    for name, columns in wanted.items():
        if name not in found:
            raise StoreError(f"{path}: a damaged store: it has no table '{name}'")
        if found[name] != columns:
            raise StoreError(f"{path}: a damaged store: the columns of '{name}' are not those of version {VERSION}")


def _require_values(path: Path, database: duckdb.DuckDBPyConnection) -> None:
    for table, wrong in _WRONG.items():
        if database.execute(f"SELECT 1 FROM {table} WHERE {wrong} LIMIT 1").fetchone():
            raise StoreError(f"{path}: a damaged store: '{table}' has a row that no batch writes")


EMERGENCY_ROW, DECISION_ROW = "emergency", "decision"

EventRow = tuple[float, str, str, str, str | None]
"""Time (s), kind (a fault's is its own), user concerned, lane of the ego, a decision's entry as in `decisions.jsonl`."""


def events_of(outcome: Outcome) -> list[EventRow]:
    """Return the events of a trial in order of time."""
    faults = outcome.judged.faults if outcome.judged else ()
    return sorted((*((*fault, None) for fault in faults), *_decisions(outcome)), key=lambda row: row[0])


def _decisions(outcome: Outcome) -> Iterator[EventRow]:
    for entry in outcome.entries:
        cause = next((one.cause for one in entry.decisions if one.cause), "")
        kind = EMERGENCY_ROW if entry.emergency else DECISION_ROW
        yield round(entry.time, 3), kind, cause, "", json.dumps(line_of(entry), allow_nan=False)
