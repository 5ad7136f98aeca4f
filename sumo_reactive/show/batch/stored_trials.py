"""The trials of a store as the page of a batch shows them: rows, pairs of both drivers, the worst, what happened in one."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from sumo_reactive.lab.batch.store_file import COLLISION, DECISION, EMERGENCY, HARD_BRAKING
from sumo_reactive.lab.batch.stored_results import Results
from sumo_reactive.lab.comparison.comparison import WHATEVER_THE_END
from sumo_reactive.lab.metric_names import METRICS
from sumo_reactive.lab.result import Collision, Fault, HardBrake, Violation
from sumo_reactive.lab.task import Driver, Ending
from sumo_reactive.lab.trace import Entry, entry_of

_COLUMNS = ("key", "scenario", "ego", "seed", "driver", "options", "ending", "reason", "verdict", "replay")


class StoredTrial(NamedTuple):
    """A finished trial; `varied` tells its parameters and options in words, `metrics` is without those it lacks."""

    key: str
    scenario: str
    ego: str
    seed: int
    driver: str
    options: str
    ending: str
    reason: str
    verdict: str
    replay: str
    varied: str
    metrics: Mapping[str, float]

    @property
    def is_done(self) -> bool:
        """Whether the trial came to a result."""
        return self.ending == Ending.DONE.value

    @property
    def name(self) -> str:
        """Scenario, ego and seed, as on a pair's point."""
        return f"{self.scenario}, {self.ego or 'own ego'}, seed {self.seed}"


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
    found = results.trials()
    return [_trial(results, dict(zip(found.columns, row, strict=True))) for row in found.rows]


def _trial(results: Results, row: Mapping[str, Any]) -> StoredTrial:
    metrics = {name: float(row[name]) for name in METRICS if row.get(name) is not None}
    told: dict[str, Any] = {name: "" if row[name] is None else row[name] for name in _COLUMNS}
    return StoredTrial(**told, varied=results.varied(row["parameters"], row["options"]), metrics=metrics)


def pairs_of(trials: Sequence[StoredTrial]) -> list[Pair]:
    """Return each trial of this driver with the baseline of its trip, where there is one and both came to a result."""
    done = [trial for trial in trials if trial.is_done]
    baselines = {_trip(trial): trial for trial in done if trial.driver == Driver.SUMO.value}
    ours = [trial for trial in done if trial.driver == Driver.REACTIVE.value]
    return [Pair(baselines[_trip(trial)], trial) for trial in ours if _trip(trial) in baselines]


def _trip(trial: StoredTrial) -> tuple[str, str, int, str]:
    return trial.scenario, trial.ego, trial.seed, trial.options


def happenings(results: Results, key: str) -> tuple[list[Entry], list[Fault]]:
    """Return the pilot's entries and the ego's faults in a trial, in order of time; raise StoreError for what is neither."""
    rows = results.happened(key)
    try:
        entries = [entry_of(json.loads(entry)) for *_, entry in rows if entry is not None]
    except (KeyError, TypeError, ValueError, AttributeError, RecursionError) as error:
        raise results.damaged(f"a decision of trial {key[:12]} is none") from error
    told = [row[:4] for row in rows if row[1] not in (DECISION, EMERGENCY)]
    if any(value is None for row in told for value in row):
        raise results.damaged(f"an event of trial {key[:12]} is none")
    return entries, [_fault(*row) for row in told]


def _fault(time: float, kind: str, user: str, lane: str) -> Fault:
    if kind == COLLISION:
        return Collision(time, user, lane)
    return HardBrake(time, user, lane) if kind == HARD_BRAKING else Violation(time, kind, lane, user)
