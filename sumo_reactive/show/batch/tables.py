"""The tables of a batch: means with intervals, paired differences, counts, the worst trials and what happened in them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence

from sumo_reactive.lab.batch.stored_results import Mean, Results
from sumo_reactive.lab.comparison.record import FEW
from sumo_reactive.lab.comparison.statistics import paired_difference
from sumo_reactive.show.batch.stored_trials import Pair, StoredTrial, happenings
from sumo_reactive.show.batch.worst_trials import Worst
from sumo_reactive.show.decision_rows import decision_table
from sumo_reactive.show.frame.colours import DRIVER_NAMES
from sumo_reactive.show.frame.labels import limits, number, signed, title_of
from sumo_reactive.show.frame.page import Html, code, link, paragraph_of, subheading, table

Names = Mapping[str, str]
"""A short name for each scenario."""

_MEANS = "Mean over the trials that have the figure, with its bootstrap interval at 95 %."
_DIFFERENCES = (
    "This driver − SUMO's own, same trip, same seed; bootstrap intervals of the mean difference at 95 %, in bold where they "
    "leave out zero. Only trips that both have finished count, except for arrivals and collisions."
)
_TOO_FEW = f" Of fewer than {FEW} pairs such intervals tend to be too narrow."
_WORST = "Trials without a result, not arrived, at fault or slower than the baseline; each links to what happened in it."
_NO_WORST = "None: every trial came to a result, arrived without a fault and not later than the baseline."


def means_table(results: Results, metrics: Sequence[str], names: Names) -> Iterator[Html]:
    """Yield a row for each group of trials that differ in ego and seed only."""
    groups = results.groups(metrics)
    if groups:
        rows = [
            (names[group.scenario], DRIVER_NAMES[group.driver], group.varied, f"{group.done} of {group.finished}",
             *map(_mean_told, group.means))
            for group in groups
        ]  # fmt: skip
        yield paragraph_of(_MEANS)
        yield _without_empty(("scenario", "driver", "varied", "results", *map(title_of, metrics)), rows)


def differences_table(pairs: Sequence[Pair], metrics: Sequence[str], names: Names) -> Iterator[Html]:
    """Yield a row for each scenario and metric, and for all scenarios together."""
    groups = pairs_by_group(pairs)
    rows = [
        row
        for (scenario, varied), inside in groups.items()
        for metric in metrics
        for row in _difference((names.get(scenario, "all"), varied), inside, metric)
    ]
    if rows:
        head = ("scenario", "varied", "figure", "pairs", "SUMO's own", "this driver", "difference", "95 % interval")
        yield paragraph_of(_DIFFERENCES, _TOO_FEW if any(len(inside) < FEW for inside in groups.values()) else "")
        yield _without_empty(head, rows, is_long=True)


def pairs_by_group(pairs: Sequence[Pair]) -> dict[tuple[str, str], list[Pair]]:
    """Return the pairs by scenario (empty: all of them, where there are several) and what is varied."""
    groups: dict[tuple[str, str], list[Pair]] = {}
    for pair in pairs:
        groups.setdefault((pair.reactive.scenario, pair.reactive.varied), []).append(pair)
    if len({scenario for scenario, _ in groups}) > 1:
        for varied in dict.fromkeys(varied for _, varied in groups):
            groups["", varied] = [pair for pair in pairs if pair.reactive.varied == varied]
    return groups


def counts_table(trials: Sequence[StoredTrial], metrics: Sequence[str], names: Names) -> Html:
    """Return in how many trials of each group a count had which value."""
    groups: dict[tuple[str, str, str], list[StoredTrial]] = {}
    for trial in trials:
        groups.setdefault((names[trial.scenario], DRIVER_NAMES[trial.driver], trial.varied), []).append(trial)
    rows = [(*group, *(_counted(inside, name) for name in metrics)) for group, inside in groups.items()]
    return _without_empty(("scenario", "driver", "varied", *map(title_of, metrics)), rows)


def worst_table(worst: Sequence[Worst], names: Names) -> Iterator[Html]:
    """Yield a row for each of the worst trials: what is wrong, and the command that replays it."""
    if not worst:
        yield paragraph_of(_NO_WORST)
        return
    yield paragraph_of(_WORST)
    rows = [
        (link(f"#{_anchor(trial)}", names[trial.scenario]), trial.ego or "own ego", str(trial.seed),
         DRIVER_NAMES[trial.driver], trial.varied, why, code(trial.replay))
        for trial, why in worst
    ]  # fmt: skip
    yield _without_empty(("scenario", "ego", "seed", "driver", "varied", "what is wrong", "command that replays it"), rows)


def story_of(worst: Worst, results: Results) -> Iterator[Html]:
    """Yield what happened in a trial: every decision and every fault."""
    trial = worst.trial
    entries, faults = happenings(results, trial.key)
    named = (trial.name, DRIVER_NAMES[trial.driver], trial.varied)
    yield subheading(_anchor(trial), ", ".join(part for part in named if part))
    yield paragraph_of(worst.why, ": ", code(trial.replay), " (", link("#worst", "back"), ")")
    if entries or faults:
        yield decision_table(entries, faults)


def _mean_told(mean: Mean | None) -> Html:
    if mean is None:
        return Html('<span class="soft">none</span>')
    interval = f'<br><span class="soft">{limits(mean.interval)}</span>' if mean.interval else ""
    return Html(f'<div class="near">{number(mean.mean)}{interval}</div>')


def _difference(where: tuple[str, str], pairs: Sequence[Pair], metric: str) -> Iterator[tuple[str, ...]]:
    found = paired_difference([values for pair in pairs if (values := pair.of(metric)) is not None])
    if found is not None:
        told = limits(found.interval, is_difference=True)
        shown = Html(f"<strong>{told}</strong>") if found.interval and not found.interval.holds_zero else told
        means = number(found.first), number(found.second), signed(found.difference)
        yield (*where, title_of(metric), str(found.n), *means, shown)


def _counted(trials: Sequence[StoredTrial], metric: str) -> str:
    found = Counter(trial.metrics[metric] for trial in trials if metric in trial.metrics)
    return ", ".join(f"{number(value)} ({count})" for value, count in sorted(found.items()))


def _anchor(trial: StoredTrial) -> str:
    return f"trial-{trial.key[:16]}"


def _without_empty(head: Sequence[str], rows: Sequence[Sequence[str]], *, is_long: bool = False) -> Html:
    """Return a table without the columns in which no row says anything."""
    kept = [k for k in range(len(head)) if any(row[k] for row in rows)]
    return table([head[k] for k in kept], [[row[k] for k in kept] for row in rows], is_long=is_long)
