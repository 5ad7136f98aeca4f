"""The trials to look at first: without a result, not arrived, at fault, or slowest against the baseline."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from sumo_reactive.lab.metric_names import METRICS
from sumo_reactive.lab.task import Driver
from sumo_reactive.show.batch.stored_trials import Pair, StoredTrial

MOST = 10
"""So many trials are shown."""

_FAULTS = tuple(METRICS[key] for key in ("collisions", "violations", "hard_braking_caused", "emergencies"))
"""What counts against a trial, the gravest first."""

_SLOWER = 1.05
"""Longer than the baseline by less than this factor is not worth a word."""


class Worst(NamedTuple):
    """A trial and what is wrong with it."""

    trial: StoredTrial
    why: str


def worst_of(trials: Sequence[StoredTrial], pairs: Sequence[Pair]) -> list[Worst]:
    """Return the worst trials, the worst first; of SUMO's own driver only where it came to no result."""
    durations = {pair.reactive.key: found for pair in pairs if (found := pair.of("duration_s"))}
    slower = {key: ours / theirs for key, (theirs, ours) in durations.items() if theirs > 0.0}
    looked_at = [trial for trial in trials if not trial.is_done or trial.driver == Driver.REACTIVE.value]
    ranked = sorted(looked_at, key=lambda trial: _badness(trial, slower), reverse=True)
    told = [Worst(trial, _why(trial, slower)) for trial in ranked]
    return [one for one in told if one.why][:MOST]


def _badness(trial: StoredTrial, slower: Mapping[str, float]) -> tuple[float, ...]:
    faults = (trial.metrics.get(fault.key, 0.0) for fault in _FAULTS)
    return not trial.is_done, 1.0 - trial.metrics.get("arrived", 1.0), *faults, slower.get(trial.key, 0.0)


def _why(trial: StoredTrial, slower: Mapping[str, float]) -> str:
    if not trial.is_done:
        return f"{trial.ending}: {trial.reason}"
    said = [trial.verdict] if trial.metrics.get("arrived") == 0.0 else []
    said += [fault.counted(round(trial.metrics[fault.key])) for fault in _FAULTS if trial.metrics.get(fault.key)]
    factor = slower.get(trial.key, 1.0)
    said += [f"took {factor:.2f} times as long as SUMO's own driver"] if factor > _SLOWER else []
    return "; ".join(said)
