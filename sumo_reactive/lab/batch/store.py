"""The store of an experiment: one DuckDB file, written by one process, a transaction a trial."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import duckdb

from sumo_reactive.lab.batch.store_file import StoreFile, events_of, told
from sumo_reactive.lab.batch.trials import Departure, Trial, release
from sumo_reactive.lab.task import Ending, Outcome


class Store(StoreFile):
    """A store that is open for writing."""

    def __init__(self, path: Path) -> None:
        super().__init__(path, read_only=False)

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
            metrics = outcome.judged.metrics if outcome.judged else {}
            names, values = list(metrics), [None if value is None else float(value) for value in metrics.values()]
            database.execute("INSERT INTO metrics SELECT ?, unnest(?), unnest(?::DOUBLE[])", [trial.key, names, values])
            columns = [list(column) for column in zip(*events_of(outcome), strict=True)]
            if columns:
                unnested = ", ".join("unnest(?)" for _ in columns)
                database.execute(f"INSERT INTO events SELECT ?, {unnested}", [trial.key, *columns])
            for point in outcome.network.diagram if outcome.network else ():
                marks = ", ".join("?" for _ in point)
                database.execute(f"INSERT INTO diagram VALUES (?, {marks})", [trial.key, *point])

    def without_result(self) -> list[tuple[str, str, str]]:
        """Return key, reason and replay command of the planned trials that came to no result, in their order."""
        rows = "SELECT key, ending || ': ' || reason, replay FROM trials JOIN plan USING (key)"
        return self.rows(f"{rows} WHERE ending <> ? ORDER BY number", [Ending.DONE.value])

    def departures(self, scouting: str) -> list[Departure]:
        """Return the trips that a scouting run found; none if there was no such run."""
        query = "SELECT vehicle_id, depart_s, length_m FROM departures WHERE scouting = ? ORDER BY depart_s, vehicle_id"
        return [Departure(*row) for row in self.rows(query, [scouting])]

    def put_departures(self, scouting: str, found: Sequence[Departure]) -> None:
        """Keep the trips that a scouting run found."""
        columns = [list(column) for column in zip(*found, strict=True)]
        with self._transaction() as database:
            if columns:
                database.execute("INSERT INTO departures SELECT ?, unnest(?), unnest(?), unnest(?)", [scouting, *columns])

    @contextmanager
    def _transaction(self) -> Iterator[duckdb.DuckDBPyConnection]:
        with told(self.path):
            self.database.begin()
            try:
                yield self.database
                self.database.commit()
            except BaseException:
                with suppress(duckdb.Error):
                    self.database.rollback()
                raise


def _row(trial: Trial, outcome: Outcome, attempts: int) -> Iterable[Any]:
    scenario, result = trial.task.scenario, outcome.judged
    return [
        trial.key, trial.scenario, result.ego if result else scenario.ego, scenario.seed, str(scenario.driver),
        json.dumps(dict(trial.parameters), sort_keys=True), json.dumps(dict(trial.options), sort_keys=True),
        outcome.ending.value, outcome.reason, result.verdict if result else None, attempts,
        result.departure_s if result else None, outcome.wall_s, outcome.trajectory, trial.replay, json.dumps(release()),
    ]  # fmt: skip
