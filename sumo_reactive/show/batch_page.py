"""The page of a batch: means with intervals, paired differences, distributions, pairs, and the worst trials with replays."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from html import escape
from pathlib import Path

from sumo_reactive.lab.batch.stored_results import Mean, Results
from sumo_reactive.lab.comparison.statistics import FEW, paired_difference
from sumo_reactive.show import page as frame
from sumo_reactive.show.batch_figures import distribution_figure, scatter_figure
from sumo_reactive.show.batch_trials import StoredTrial, TripPair, Worst, happenings, pairs_of, trials_in, worst_of
from sumo_reactive.show.diagram_section import diagram_section
from sumo_reactive.show.faults import decision_table
from sumo_reactive.show.page import Html, Section
from sumo_reactive.show.share_section import share_section

_Names = Mapping[str, str]  # a short name for each scenario

_MEANS = "Mean over the trials that have the figure, with its bootstrap interval at 95 %."
_DIFFERENCES = (
    "This driver − SUMO's own, same trip, same seed; bootstrap intervals of the mean difference at 95 %, in bold where they "
    "leave out zero. Only trips that both have finished count, except for arrivals, collisions and "
    "what is measured of others."
)
_TOO_FEW = f" Of fewer than {FEW} pairs such intervals tend to be too narrow."
_COUNTS = "Each value of a count, and in brackets how many trials had it:"
_BOXES = "A point is a trial; a box holds the middle half of a group, the line in it is the median."
_SCATTER = "A point is a trip with a seed that both have finished: below the dashed line this driver has the smaller value."
_WORST = "Trials without a result, not arrived, at fault or slower than the baseline"
_LINKED = "; each links to what happened in it"
_NO_WORST = "None: every trial came to a result, arrived without a fault and not later than the baseline."


def batch_page(store: Path) -> str:
    """Return the page of a store; raise StoreError for a file that is none."""
    with Results(store) as results:
        metrics, trials = results.metrics([]), trials_in(results)
        pairs, names = pairs_of(trials), short_names(trials)
        worst = worst_of(trials, pairs)
        sections = (
            Section("means", "Means", list(_means(results, metrics, names))),
            Section("shares", "By the share of egos", list(share_section(trials, metrics, names))),
            Section("diagram", "Fundamental diagram", list(diagram_section(trials, results.diagram(), names))),
            Section("differences", "Against SUMO's own driver", list(differences_table(pairs, metrics, names))),
            Section("distributions", "Distributions", list(_distributions(trials, metrics, names))),
            Section("pairs", "Trip by trip", list(scatters(pairs, metrics, names))),
            Section("worst", "Worst trials", list(worst_table(worst, names))),
            Section("trials", "What happened in them", [part for one in worst for part in _story(one, results)]),
        )
        finished, planned = results.progress
    endings = Counter(trial.ending for trial in trials)
    how = ", ".join(f"{count} {ending}" for ending, count in endings.items())
    subtitle = f"{finished} of {planned} trials finished{f': {how}' if how else ''}."
    return frame.page(f"Batch {store.stem}", subtitle, sections)


def short_names(trials: Sequence[StoredTrial]) -> dict[str, str]:
    """Return the scenarios by the stem of their file where that tells them apart."""
    scenarios = list(dict.fromkeys(trial.scenario for trial in trials))
    stems = Counter(Path(scenario).stem for scenario in scenarios)
    return {one: Path(one).stem if stems[Path(one).stem] == 1 else one for one in scenarios}


def _means(results: Results, metrics: Sequence[str], names: _Names) -> Iterator[Html]:
    """Yield a row for each group of trials that differ in ego and seed only."""
    groups = results.groups(metrics)
    if groups:
        rows = [
            (names[group.scenario], frame.driver_name(group.driver), group.varied, f"{group.done} of {group.finished}",
             *map(_mean_told, group.means))
            for group in groups
        ]  # fmt: skip
        yield frame.paragraph_of(_MEANS)
        yield _without_empty(("scenario", "driver", "varied", "results", *map(frame.title_of, metrics)), rows)


def _mean_told(mean: Mean | None) -> Html:
    if mean is None:
        return Html('<span class="soft">none</span>')
    interval = f'<br><span class="soft">{frame.limits(mean.interval)}</span>' if mean.interval else ""
    return Html(f'<div class="near">{frame.number(mean.mean)}{interval}</div>')


def differences_table(pairs: Sequence[TripPair], metrics: Sequence[str], names: _Names) -> Iterator[Html]:
    """Yield a row for each scenario and metric, and for all scenarios together."""
    groups = pairs_by_group(pairs)
    rows = []
    for (scenario, varied), inside in groups.items():
        for metric in metrics:
            found = paired_difference([values for pair in inside if (values := pair.of(metric)) is not None])
            if found is not None:
                cells = frame.difference_cells(found)
                rows.append((names.get(scenario, "all"), varied, frame.title_of(metric), str(found.n), *cells))
    if rows:
        head = ("scenario", "varied", "figure", "pairs", "SUMO's own", "this driver", "difference", "95 % interval")
        yield frame.paragraph_of(_DIFFERENCES, _TOO_FEW if any(len(inside) < FEW for inside in groups.values()) else "")
        yield _without_empty(head, rows, is_long=True)


def pairs_by_group(pairs: Sequence[TripPair]) -> dict[tuple[str, str], list[TripPair]]:
    """Return the pairs by scenario (empty: all of them, where there are several) and what is varied."""
    groups: dict[tuple[str, str], list[TripPair]] = {}
    for pair in pairs:
        groups.setdefault((pair.driven.scenario, pair.part), []).append(pair)
    if len({scenario for scenario, _ in groups}) > 1:
        for varied in dict.fromkeys(varied for _, varied in groups):
            groups["", varied] = [pair for pair in pairs if pair.part == varied]
    return groups


def _distributions(trials: Sequence[StoredTrial], metrics: Sequence[str], names: _Names) -> Iterator[Html]:
    values = {name: [trial.metrics[name] for trial in trials if name in trial.metrics] for name in metrics}
    same = [f"{frame.title_of(name)}: {frame.number(found[0])}" for name, found in values.items() if len(set(found)) == 1]
    differing = [name for name, found in values.items() if len(set(found)) > 1]
    counts = [name for name in differing if frame.is_count(name)]
    if same:
        yield frame.paragraph_of(f"The same in all trials: {'; '.join(same)}.")
    if counts:
        yield frame.paragraph_of(_COUNTS)
        yield _counts(trials, counts, names)
    figures = {name: distribution_figure(trials, name, names) for name in differing if name not in counts}
    if figures:
        yield frame.paragraph_of(_BOXES)
        yield frame.side_by_side(frame.figure_html(one, f"of-{name}") for name, one in figures.items())


def _counts(trials: Sequence[StoredTrial], metrics: Sequence[str], names: _Names) -> Html:
    """Return in how many trials of each group a count had which value."""
    groups: dict[tuple[str, ...], dict[str, Counter[float]]] = {}
    for trial in trials:
        group = names[trial.scenario], frame.driver_name(trial.driver), trial.varied
        counted = groups.setdefault(group, {name: Counter() for name in metrics})
        for name in set(metrics) & set(trial.metrics):
            counted[name][trial.metrics[name]] += 1
    told = frame.number
    rows = [
        (*group, *(", ".join(f"{told(value)} ({n})" for value, n in sorted(found.items())) for found in counted.values()))
        for group, counted in groups.items()
    ]
    return _without_empty(("scenario", "driver", "varied", *map(frame.title_of, metrics)), rows)


def scatters(pairs: Sequence[TripPair], metrics: Sequence[str], names: _Names) -> Iterator[Html]:
    """Yield a figure a metric, in which a point is a pair."""
    shown = [name for name in metrics if not frame.is_count(name) and any(pair.of(name) for pair in pairs)]
    if shown:
        yield frame.paragraph_of(_SCATTER)
        figures = {name: scatter_figure(pairs, name, names) for name in shown}
        yield frame.side_by_side(frame.figure_html(one, f"pair-{name}") for name, one in figures.items())


def worst_table(worst: Sequence[Worst], names: _Names, *, are_told: bool = True) -> Iterator[Html]:
    """Yield a row for each of the worst trials: what is wrong, and the command that replays it.

    `are_told`: the page says what happened in them, too.
    """
    linked = _LINKED if are_told else ""
    yield frame.paragraph_of(f"{_WORST}{linked}." if worst else _NO_WORST)
    if worst:
        rows = [
            (_named(trial, names, are_told), trial.ego or "own ego", str(trial.seed),
             frame.driver_name(trial.driver), trial.varied, why, frame.code(trial.replay))
            for trial, why in worst
        ]  # fmt: skip
        head = ("scenario", "ego", "seed", "driver", "varied", "what is wrong", "command that replays it")
        yield _without_empty(head, rows)


def _named(trial: StoredTrial, names: _Names, is_told: bool) -> str:
    name = names[trial.scenario]
    return frame.link(f"#{_anchor(trial)}", name) if is_told else name


def _story(worst: Worst, results: Results) -> Iterator[Html]:
    """Yield what happened in a trial: every decision and every fault."""
    trial = worst.trial
    entries, faults = happenings(results, trial.key)
    named = ", ".join(filter(None, (trial.name, frame.driver_name(trial.driver), trial.varied)))
    yield Html(f'<h3 id="{_anchor(trial)}">{escape(named)}</h3>')
    yield frame.paragraph_of(worst.why, ": ", frame.code(trial.replay), " (", frame.link("#worst", "back"), ")")
    if entries or faults:
        yield decision_table(entries, faults)


def _anchor(trial: StoredTrial) -> str:
    return f"trial-{trial.key[:16]}"


def _without_empty(head: Sequence[str], rows: Sequence[Sequence[str]], *, is_long: bool = False) -> Html:
    """Return a table without the columns in which no row says anything."""
    kept = [k for k in range(len(head)) if any(row[k] for row in rows)]
    return frame.table([head[k] for k in kept], [[row[k] for k in kept] for row in rows], is_long=is_long)
