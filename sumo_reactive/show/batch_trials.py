"""The trials of a store as the page of a batch shows them: rows, pairs of both drivers, the worst, what happened in one."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from sumo_reactive.lab.batch.store_file import DECISION_ROW, EMERGENCY_ROW
from sumo_reactive.lab.batch.stored_results import Results
from sumo_reactive.lab.comparison.comparison import OTHERS_METRICS, WHATEVER_THE_END
from sumo_reactive.lab.drivers.choice import REACTIVE_NAME, SUMO_NAME
from sumo_reactive.lab.fault import Fault
from sumo_reactive.lab.metric_names import METRICS
from sumo_reactive.lab.task import SHARE, Ending
from sumo_reactive.lab.trace import Entry, entry_of

_DONE = Ending.DONE.value
_MOST_WORST = 10
_FAULTS = tuple(METRICS[key] for key in ("collisions", "violations", "hard_braking_caused", "emergencies"))
"""What counts against a trial, the gravest first."""

_SLOWER = 1.05
"""Longer than the baseline by less than this factor is not worth a word."""


class StoredTrial(NamedTuple):
    """A finished trial; `varied` tells its parameters and options in words, `metrics` is without those it lacks, `share`
    which one of all road cars were egos (None: a trip of one)."""

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
    share: float | None = None

    @property
    def name(self) -> str:
        """Scenario, ego and seed, as on a pair's point."""
        return f"{self.scenario}, {self.ego or 'own ego'}, seed {self.seed}"


class TripPair(NamedTuple):
    """The same trip with the same seed under SUMO's own driver and under another."""

    sumo: StoredTrial
    driven: StoredTrial

    @property
    def part(self) -> str:
        """What pairs that belong together share: the driver, unless it is this project's, and what is varied."""
        name = self.driven.driver
        return " ".join(filter(None, ("" if name == REACTIVE_NAME else name, self.driven.varied)))

    def of(self, metric: str) -> tuple[float, float] | None:
        """Return both values where they can be compared: what depends on the ego's trip only where both have arrived."""
        first, second = self.sumo.metrics.get(metric), self.driven.metrics.get(metric)
        arrived = all(one.metrics.get("arrived") == 1 for one in self)
        if first is None or second is None or not (arrived or metric in (*WHATEVER_THE_END, *OTHERS_METRICS)):
            return None
        return first, second


class Worst(NamedTuple):
    """A trial and what is wrong with it."""

    trial: StoredTrial
    why: str


def trials_in(results: Results) -> list[StoredTrial]:
    """Return the finished trials in the order of the plan."""
    found = results.trials()
    return [_trial(results, dict(zip(found.columns, row, strict=True))) for row in found.rows]


def _trial(results: Results, row: Mapping[str, Any]) -> StoredTrial:
    metrics = {name: float(row[name]) for name in results.known if row.get(name) is not None}
    told: dict[str, Any] = {name: "" if row[name] is None else row[name] for name in StoredTrial._fields[:-3]}
    varied = results.varied(row["parameters"], row["options"])
    share = json.loads(row["parameters"]).get(SHARE)
    if share is not None and not (isinstance(share, float | int) and 0.0 <= share <= 1.0):
        raise results.damaged("the share of egos of a trial is none")
    return StoredTrial(**told, varied=varied, metrics=metrics, share=share)


def pairs_of(trials: Sequence[StoredTrial]) -> list[TripPair]:
    """Return each trial of another driver than SUMO's with the baseline of its trip, where both came to a result."""
    done = [trial for trial in trials if trial.ending == _DONE]
    baselines = {_trip(trial): trial for trial in done if trial.driver == SUMO_NAME}
    driven = [trial for trial in done if trial.driver != SUMO_NAME and _trip(trial) in baselines]
    return [TripPair(baselines[_trip(trial)], trial) for trial in driven]


def _trip(trial: StoredTrial) -> tuple[str, str, int, str]:
    return trial.scenario, trial.ego, trial.seed, trial.options


def worst_of(trials: Sequence[StoredTrial], pairs: Sequence[TripPair]) -> list[Worst]:
    """Return the worst trials, the worst first; of SUMO's own driver only where it came to no result."""
    durations = {pair.driven.key: found for pair in pairs if (found := pair.of("duration_s"))}
    slower = {key: ours / theirs for key, (theirs, ours) in durations.items() if theirs > 0.0}

    def badness(trial: StoredTrial) -> tuple[float, ...]:
        faults = (trial.metrics.get(fault.key, 0.0) for fault in _FAULTS)
        arrived = trial.metrics.get("arrived", 1.0)
        return trial.ending != _DONE, 1.0 - arrived, *faults, slower.get(trial.key, 0.0)

    looked_at = [trial for trial in trials if trial.ending != _DONE or trial.driver != SUMO_NAME]
    ranked = sorted(looked_at, key=badness, reverse=True)
    told = [Worst(trial, _why(trial, slower.get(trial.key, 1.0))) for trial in ranked]
    return [one for one in told if one.why][:_MOST_WORST]


def _why(trial: StoredTrial, factor: float) -> str:
    if trial.ending != _DONE:
        return f"{trial.ending}: {trial.reason}"
    said = [trial.verdict] if trial.metrics.get("arrived") == 0.0 else []
    said += [fault.counted(round(trial.metrics[fault.key])) for fault in _FAULTS if trial.metrics.get(fault.key)]
    said += [f"took {factor:.2f} times as long as SUMO's own driver"] if factor > _SLOWER else []
    return "; ".join(said)


def happenings(results: Results, key: str) -> tuple[list[Entry], list[Fault]]:
    """Return the pilot's entries and the ego's faults in a trial, in order of time; raise StoreError for what is neither."""
    rows = results.happened(key)
    try:
        entries = [entry_of(json.loads(entry)) for *_, entry in rows if entry is not None]
    except (KeyError, TypeError, ValueError, AttributeError, RecursionError) as error:
        raise results.damaged(f"a decision of trial {key[:12]} is none") from error
    told = [row[:4] for row in rows if row[1] not in (DECISION_ROW, EMERGENCY_ROW)]
    if any(value is None for row in told for value in row):
        raise results.damaged(f"an event of trial {key[:12]} is none")
    return entries, [Fault(*row) for row in told]
