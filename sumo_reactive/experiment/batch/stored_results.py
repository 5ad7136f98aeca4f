"""What a store says: means with confidence intervals, any query, tables for other programs."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from types import TracebackType
from typing import Any, NamedTuple

import duckdb

from sumo_reactive.errors import StoreError
from sumo_reactive.experiment.batch.store import connected
from sumo_reactive.experiment.comparison.statistics import Interval, interval_of
from sumo_reactive.experiment.io_errors import as_os_errors
from sumo_reactive.experiment.metric_names import METRICS
from sumo_reactive.experiment.toml_file import nearest
from sumo_reactive.writing import whole_file

_GROUP = "scenario, driver, parameters, options"
_VALUES = f"""
SELECT {_GROUP}, count(*) AS planned, count(ending) AS finished, count(*) FILTER (ending = 'done') AS done, {{values}}
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
    interval: Interval | None


class Group(NamedTuple):
    """Trials alike but for ego and seed: how many have a result, and the mean of each metric (None: nobody has one)."""

    scenario: str
    driver: str
    varied: str
    done: int
    finished: int
    means: tuple[Mean | None, ...]


class Results:
    """A store open for reading; a context manager. Raises StoreError for what cannot be read or asked."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._database = connected(path, read_only=True)

    def __enter__(self) -> Results:
        return self

    def __exit__(self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None) -> None:
        self._database.close()

    def metrics(self, asked: Sequence[str]) -> list[str]:
        """Return the metrics to show: those asked for, else those that the experiment names."""
        for name in asked:
            if name not in METRICS:
                raise StoreError(f"unknown metric '{name}'{nearest(name, METRICS)}")
        shown = self._database.execute("SELECT name FROM shown ORDER BY number").fetchall()
        return list(asked) or [name for (name,) in shown]

    @property
    def progress(self) -> tuple[int, int]:
        """How many planned trials are finished, and how many there are."""
        query = "SELECT count(ending), count(*) FROM plan LEFT JOIN trials USING (key)"
        finished, planned = self._database.execute(query).fetchall()[0]
        return int(finished), int(planned)

    def groups(self, metrics: Sequence[str]) -> list[Group]:
        """Return the means of the finished trials, group by group in the order of the plan."""
        names = ", ".join(f"'{name}'" for name in metrics)
        values = ", ".join(f'list("{name}" ORDER BY number) FILTER ("{name}" IS NOT NULL)' for name in metrics)
        rows = self._database.execute(_VALUES.format(names=names, values=values)).fetchall()
        return [
            Group(row[0], row[1], _varied(row[2], row[3]), row[6], row[5], tuple(_mean(one) for one in row[7:]))
            for row in rows
            if row[0] is not None
        ]

    def table(self, query: str | None) -> duckdb.DuckDBPyRelation:
        """Return what a query gives; without one, a row a finished trial with a column a metric."""
        try:
            return self._database.sql(query or self._wide())
        except duckdb.Error as error:
            raise StoreError(f"{self._path}: {' '.join(str(error).splitlines()[0].split())}") from error

    def _wide(self) -> str:
        found = self._database.execute("SELECT DISTINCT name FROM metrics").fetchall()
        names = sorted((name for (name,) in found), key=lambda name: list(METRICS).index(name) if name in METRICS else 99)
        return _WIDE.format(names=", ".join(f"'{name}'" for name in names) or "''")


def _mean(values: list[float] | None) -> Mean | None:
    return Mean(len(values), sum(values) / len(values), interval_of(values)) if values else None


def _varied(*parts: str) -> str:
    return " ".join(f"{name}={value}" for part in parts for name, value in json.loads(part).items())


def written(table: duckdb.DuckDBPyRelation, csv: Path | None, parquet: Path | None) -> None:
    """Write a table to the files asked for; raise StoreError or OutputError if one cannot be written."""
    writers: list[tuple[Path | None, Any]] = [(csv, table.write_csv), (parquet, table.write_parquet)]
    for path, write in writers:
        if path is None:
            continue
        try:
            with whole_file(path) as partial, as_os_errors():
                write(str(partial))
        except duckdb.Error as error:
            raise StoreError(f"{path}: cannot be written: {' '.join(str(error).splitlines()[0].split())}") from error
