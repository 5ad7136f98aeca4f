"""The page of a batch: means with intervals, paired differences, distributions, pairs, and the worst trials with replays."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path

from sumo_reactive.lab.batch.stored_results import Results
from sumo_reactive.show.batch.figures import SCATTER_HEIGHT, distribution_figure, scatter_figure
from sumo_reactive.show.batch.stored_trials import Pair, StoredTrial, pairs_of, trials_in
from sumo_reactive.show.batch.tables import (
    Names,
    counts_table,
    differences_table,
    means_table,
    story_of,
    worst_table,
)
from sumo_reactive.show.batch.worst_trials import worst_of
from sumo_reactive.show.frame.labels import is_count, number, title_of
from sumo_reactive.show.frame.page import Html, Section, figure_html, page, paragraph_of, side_by_side

_COUNTS = "Each value of a count, and in brackets how many trials had it:"
_BOXES = "A point is a trial; a box holds the middle half of a group, the line in it is the median."
_SCATTER = "A point is a trip with a seed that both have finished: below the dashed line this driver has the smaller value."


def batch_page(store: Path) -> str:
    """Return the page of a store; raise StoreError for a file that is none."""
    with Results(store) as results:
        metrics, trials = results.metrics([]), trials_in(results)
        pairs, names = pairs_of(trials), short_names(trials)
        worst = worst_of(trials, pairs)
        sections = (
            Section("means", "Means", list(means_table(results, metrics, names))),
            Section("differences", "Against SUMO's own driver", list(differences_table(pairs, metrics, names))),
            Section("distributions", "Distributions", list(_distributions(trials, metrics, names))),
            Section("pairs", "Trip by trip", list(_scatters(pairs, metrics, names))),
            Section("worst", "Worst trials", list(worst_table(worst, names))),
            Section("trials", "What happened in them", [part for one in worst for part in story_of(one, results)]),
        )
        finished, planned = results.progress
    endings = Counter(trial.ending for trial in trials)
    how = ", ".join(f"{count} {ending}" for ending, count in endings.items())
    return page(f"Batch {store.stem}", f"{finished} of {planned} trials finished{f': {how}' if how else ''}.", sections)


def short_names(trials: Sequence[StoredTrial]) -> dict[str, str]:
    """Return the scenarios by the stem of their file where that tells them apart."""
    scenarios = list(dict.fromkeys(trial.scenario for trial in trials))
    stems = Counter(Path(scenario).stem for scenario in scenarios)
    return {one: Path(one).stem if stems[Path(one).stem] == 1 else one for one in scenarios}


def _distributions(trials: Sequence[StoredTrial], metrics: Sequence[str], names: Names) -> Iterator[Html]:
    values = {name: [trial.metrics[name] for trial in trials if name in trial.metrics] for name in metrics}
    same = [f"{title_of(name)}: {number(found[0])}" for name, found in values.items() if len(set(found)) == 1]
    differing = [name for name, found in values.items() if len(set(found)) > 1]
    counts = [name for name in differing if is_count(name)]
    if same:
        yield paragraph_of(f"The same in all trials: {'; '.join(same)}.")
    if counts:
        yield paragraph_of(_COUNTS)
        yield counts_table(trials, counts, names)
    figures = {name: distribution_figure(trials, name, names) for name in differing if name not in counts}
    if figures:
        yield paragraph_of(_BOXES)
        yield side_by_side(figure_html(one, f"of-{name}", int(one.layout.height)) for name, one in figures.items())


def _scatters(pairs: Sequence[Pair], metrics: Sequence[str], names: Names) -> Iterator[Html]:
    shown = [name for name in metrics if not is_count(name) and any(pair.of(name) for pair in pairs)]
    if shown:
        yield paragraph_of(_SCATTER)
        figures = {name: scatter_figure(pairs, name, names) for name in shown}
        yield side_by_side(figure_html(one, f"pair-{name}", SCATTER_HEIGHT) for name, one in figures.items())
