"""What a store says: means with confidence intervals, any query, tables for other programs."""

from __future__ import annotations

import json
from collections.abc import Sequence
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

import duckdb

from sumo_reactive.errors import StoreError
from sumo_reactive.lab.batch.store_file import StoreFile, told
from sumo_reactive.lab.comparison.statistics import ConfidenceInterval, interval_of
from sumo_reactive.lab.fundamental_diagram import DiagramPoint
from sumo_reactive.lab.metric_names import IN_BATCHES
from sumo_reactive.lab.own_metrics import OWN_NAME, TAKEN
from sumo_reactive.lab.schema import nearest
from sumo_reactive.lab.tables import as_os_errors
from sumo_reactive.writing import whole_file

_GROUP = "scenario, driver, parameters, options"
_VALUES = f"""
SELECT {_GROUP}, count(*) AS planned, count(ending) AS finished, count(*) FILTER (ending = 'done') AS done {{values}}
FROM plan LEFT JOIN trials USING (key)
LEFT JOIN (PIVOT (SELECT key, name, value FROM metrics) ON name IN ({{names}}) USING first(value) GROUP BY key) USING (key)
GROUP BY {_GROUP} ORDER BY min(number)
"""
_WIDE = """
SELECT trials.*, wide.* EXCLUDE (key) FROM plan JOIN trials USING (key)
LEFT JOIN (PIVOT (SELECT key, name, value FROM metrics) ON name IN ({names}) USING first(value) GROUP BY key) AS wide
USING (key) ORDER BY number
"""


class Mean(NamedTuple):
    """Mean of a metric over `n` trials that have one, and its interval at 95 % (None: fewer than two)."""

    n: int
    mean: float
    interval: ConfidenceInterval | None


class Group(NamedTuple):
    """Trials alike but for ego and seed: how many have a result, and the mean of each metric (None: nobody has one)."""

    scenario: str
    driver: str
    varied: str
    done: int
    finished: int
    means: tuple[Mean | None, ...]


class Table(NamedTuple):
    """Names of the columns, and rows; `is_cut`: there are more rows."""

    columns: tuple[str, ...]
    rows: list[tuple[Any, ...]]
    is_cut: bool = False


class Results(StoreFile):
    """A store open for reading."""

    def __init__(self, path: Path, files: Sequence[str] = ()) -> None:
        super().__init__(path, read_only=True, files=files)

    def metrics(self, asked: Sequence[str]) -> list[str]:
        """Return the metrics to show: those asked for, else those that the experiment names."""
        for name in asked:
            if name not in self.known:
                raise StoreError(f"unknown metric '{name}'{nearest(name, self.known)}")
        return list(asked) or [name for (name,) in self.rows("SELECT name FROM shown ORDER BY number")]

    @cached_property
    def known(self) -> tuple[str, ...]:
        """The metrics that a trial may have, and those of users' own that are stored."""
        own = (name for (name,) in self.rows("SELECT DISTINCT name FROM metrics ORDER BY name") if OWN_NAME.fullmatch(name))
        return *IN_BATCHES, *(name for name in own if name not in IN_BATCHES and name not in TAKEN)

    @property
    def progress(self) -> tuple[int, int]:
        """How many planned trials are finished, and how many there are."""
        finished, planned = self.rows("SELECT count(ending), count(*) FROM plan LEFT JOIN trials USING (key)")[0]
        return int(finished), int(planned)

    def groups(self, metrics: Sequence[str]) -> list[Group]:
        """Return the means of the finished trials, group by group in the order of the plan."""
        names = ", ".join(f"'{name}'" for name in metrics) or "''"
        values = "".join(f', list("{name}" ORDER BY number) FILTER ("{name}" IS NOT NULL)' for name in metrics)
        return [
            Group(row[0], row[1], self.varied(row[2], row[3]), row[6], row[5], tuple(_mean(one) for one in row[7:]))
            for row in self.rows(_VALUES.format(names=names, values=values))
            if row[0] is not None
        ]

    def trials(self) -> Table:
        """Return a row a finished trial with a column a metric, in the order of the plan."""
        return self.asked(self._wide())

    def happened(self, key: str) -> list[tuple[Any, ...]]:
        """Return time (s), kind, user, lane and entry of what happened in a trial, in order of time."""
        return self.rows("SELECT time_s, kind, user_id, lane_id, entry FROM events WHERE key = ? ORDER BY time_s", [key])

    def diagram(self) -> dict[str, list[DiagramPoint]]:
        """Return the points of the fundamental diagram of each planned trial by its key, in the order of the plan."""
        points: dict[str, list[DiagramPoint]] = {}
        columns = ", ".join(DiagramPoint._fields)
        query = f"SELECT key, {columns} FROM diagram JOIN plan USING (key) ORDER BY number, edges, begin_s"
        for key, *values in self.rows(query):
            points.setdefault(key, []).append(DiagramPoint(*values))
        return points

    def asked(self, query: str, most: int | None = None) -> Table:
        """Return what one query gives, at most so many rows of it."""
        with told(self.path):
            self._require_table(query)
            found = self.database.execute(query)
            columns = tuple(name for name, *_ in found.description or ())
            rows = found.fetchall() if most is None else found.fetchmany(most + 1)
        return Table(columns, rows[:most], most is not None and len(rows) > most)

    def write(self, query: str | None, part: str, form: str) -> None:
        """Write what a query gives (None: a row a trial) to one of `files` as `csv` or `parquet`; raise `duckdb.Error`."""
        with told(self.path):
            if query:
                self._require_table(query)
            table = self.database.sql(query or self._wide())
        (table.write_csv if form == "csv" else table.write_parquet)(part)

    def _require_table(self, query: str) -> None:
        query.encode()  # an argument that is no text has no place in it that DuckDB could name
        statements = self.database.extract_statements(query)
        if len(statements) != 1 or duckdb.ExpectedResultType.QUERY_RESULT not in statements[0].expected_result_type:
            raise StoreError(f"{self.path}: not one query that gives a table")

    def _wide(self) -> str:
        found = [name for (name,) in self.rows("SELECT DISTINCT name FROM metrics")]
        places = {name: k for k, name in enumerate(IN_BATCHES)}
        names = sorted(found, key=lambda name: (places.get(name, len(places)), name))
        return _WIDE.format(names=", ".join("'{}'".format(name.replace("'", "''")) for name in names) or "''")

    def varied(self, *parts: str) -> str:
        """Return parameters and options of a trial in words."""
        try:
            return " ".join(f"{name}={value}" for part in parts for name, value in json.loads(part).items())
        except (ValueError, RecursionError) as error:
            raise self.damaged("parameters or options of a trial are none") from error

    def damaged(self, how: str) -> StoreError:
        """Return the error that tells of a value which no batch writes."""
        return StoreError(f"{self.path}: a damaged store: {how}")


def _mean(values: list[float] | None) -> Mean | None:
    return Mean(len(values), sum(values) / len(values), interval_of(values)) if values else None


def written(store: Path, query: str | None, target: Path, form: str) -> None:
    """Write what a query of a store gives as `csv` or `parquet`, whole or not at all; raise StoreError or OutputError."""
    with whole_file(target) as partial, as_os_errors():
        part = partial.resolve()
        try:
            with Results(store, (str(part), str(part.with_name(f"tmp_{part.name}")))) as results:
                results.write(query, str(part), form)
        except duckdb.IOException:
            raise
        except duckdb.Error as error:
            raise StoreError(f"{target}: cannot be written: {' '.join(str(error).splitlines()[0].split())}") from error
