"""The trials of a store as the page of a batch shows them: rows, pairs of both drivers, the worst, what happened in one."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import NamedTuple

from sumo_reactive.experiment.batch.stored_events import COLLISION, DECISION, EMERGENCY, HARD_BRAKING
from sumo_reactive.experiment.batch.stored_results import Results
from sumo_reactive.experiment.comparison.comparison import WHATEVER_THE_END
from sumo_reactive.experiment.metric_names import METRICS
from sumo_reactive.experiment.process.driver import Driver
from sumo_reactive.experiment.process.task import Ending
from sumo_reactive.experiment.result import Collision, Fault, HardBrake, Violation
from sumo_reactive.experiment.trace import Entry, entry_of

_COLUMNS = ("key", "scenario", "ego", "seed", "driver", "parameters", "options", "ending", "reason", "verdict", "replay")


class StoredTrial(NamedTuple):
    """A finished trial; `parameters` and `options` are what the experiment varies, `metrics` without those it lacks."""

    key: str
    scenario: str
    ego: str
    seed: int
    driver: str
    parameters: str
    options: str
    ending: str
    reason: str
    verdict: str
    replay: str
    metrics: Mapping[str, float]

    @property
    def is_done(self) -> bool:
        """Whether the trial came to a result."""
        return self.ending == Ending.DONE.value

    @property
    def name(self) -> str:
        """Scenario, ego and seed, as on a pair's point."""
        return f"{self.scenario}, {self.ego or 'own ego'}, seed {self.seed}"

    @property
    def varied(self) -> str:
        """Parameters and options in words."""
        varied = {**json.loads(self.parameters), **json.loads(self.options)}
        return " ".join(f"{name}={value}" for name, value in varied.items())


class Pair(NamedTuple):
    """The same trip with the same seed under SUMO's own driver and under this one."""

    sumo: StoredTrial
    reactive: StoredTrial

    def of(self, metric: str) -> tuple[float, float] | None:
        """Return both values where they can be compared: what depends on the trip only where both have arrived."""
        both = (self.sumo.metrics.get(metric), self.reactive.metrics.get(metric))
        arrived = all(one.metrics.get("arrived") == 1 for one in self)
        if both[0] is None or both[1] is None or not (arrived or metric in WHATEVER_THE_END):
            return None
        return both[0], both[1]


def trials_in(results: Results) -> list[StoredTrial]:
    """Return the finished trials in the order of the plan."""
    found = results.table(None)
    names = list(found.columns)
    rows = [dict(zip(names, row, strict=True)) for row in found.fetchall()]
    return [_trial(row) for row in rows]


def _trial(row: Mapping[str, object]) -> StoredTrial:
    metrics = {name: float(str(row[name])) for name in METRICS if row.get(name) is not None}
    told = {name: row[name] for name in _COLUMNS if name != "seed"}
    texts = {name: "" if value is None else str(value) for name, value in told.items()}
    return StoredTrial(**texts, seed=int(str(row["seed"])), metrics=metrics)


def pairs_of(trials: Sequence[StoredTrial]) -> list[Pair]:
    """Return each trial of this driver with the baseline of its trip, where there is one and both came to a result."""
    done = [trial for trial in trials if trial.is_done]
    baselines = {_trip(trial): trial for trial in done if trial.driver == Driver.SUMO.value}
    ours = [trial for trial in done if trial.driver == Driver.REACTIVE.value]
    return [Pair(baselines[_trip(trial)], trial) for trial in ours if _trip(trial) in baselines]


def _trip(trial: StoredTrial) -> tuple[str, str, int, str]:
    return trial.scenario, trial.ego, trial.seed, trial.options


def happenings(results: Results, key: str) -> tuple[list[Entry], list[Fault]]:
    """Return the pilot's entries and the ego's faults in a trial, in order of time."""
    digest = "".join(letter for letter in key if letter.isalnum())
    rows = results.table(
        f"SELECT time_s, kind, user_id, lane_id, entry FROM events WHERE key = '{digest}' ORDER BY time_s"
    ).fetchall()
    entries = [entry_of(json.loads(entry)) for *_, entry in rows if entry is not None]
    told = [row[:4] for row in rows if row[1] not in (DECISION, EMERGENCY)]
    return entries, [_fault(*row) for row in told]


def _fault(time: float, kind: str, user: str, lane: str) -> Fault:
    if kind == COLLISION:
        return Collision(time, user, lane)
    return HardBrake(time, user, lane) if kind == HARD_BRAKING else Violation(time, kind, lane, user)
