"""The page of a comparison: paired differences, the difference of every trip, and the worst with their commands."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from sumo_reactive.lab.comparison.comparison import EGO_METRICS, OTHERS_METRICS
from sumo_reactive.lab.comparison.recorded import ComparisonKeys, PairKeys, read_comparison
from sumo_reactive.show import page as frame
from sumo_reactive.show.batch_page import differences_table, scatters, short_names, worst_table
from sumo_reactive.show.batch_trials import StoredTrial, TripPair, pairs_of, worst_of
from sumo_reactive.show.page import Html, Section

_METRICS = (*EGO_METRICS, *OTHERS_METRICS)
_TRIPS = "This driver − SUMO's own on each trip that both have driven; a figure that differs on no trip is left out."
_NO_PAIRS = "No trip that both drivers have driven to its end."


def comparison_page(folder: Path) -> str:
    """Return the page of a folder that `compare --out` has written; raise ScenarioError for what is no such folder."""
    found = read_comparison(folder)
    trials = trials_compared(found)
    pairs, names = pairs_of(trials), short_names(trials)
    differing = [name for name in _METRICS if any(_is_different(pair.of(name)) for pair in pairs)]
    sections = (
        Section("differences", "Against SUMO's own driver", list(differences_table(pairs, _METRICS, names))),
        Section("trips", "Differences of each trip", list(_trips(pairs, differing, names))),
        Section("pairs", "Trip by trip", list(scatters(pairs, differing, names))),
        Section("worst", "Worst trials", list(worst_table(worst_of(trials, pairs), names, are_told=False))),
    )
    many = len(found.pairs)
    subtitle = f"{len(pairs)} of {many} {'pair' if many == 1 else 'pairs'} driven by both."
    return frame.page(f"{frame.driver_name(found.drivers[1])} beside SUMO's own driver", subtitle, sections)


def trials_compared(found: ComparisonKeys) -> list[StoredTrial]:
    """Return both runs of every pair, as a batch has its trials."""
    return [_trial(pair, f"{k}-{driver}", driver) for k, pair in enumerate(found.pairs) for driver in found.drivers]


def _trial(pair: PairKeys, key: str, driver: str) -> StoredTrial:
    side = pair.side(driver)
    compared = {name: values.get(driver) for name, values in pair.metrics.items()}
    metrics = {name: float(value) for name, value in {**side.figures, **compared}.items() if value is not None}
    return StoredTrial(
        key=key, scenario=pair.scenario, ego=pair.ego, seed=pair.seed, driver=driver, options="", ending=side.ending,
        reason=side.verdict.removeprefix(f"{side.ending}: "), verdict=side.verdict, replay=side.command, varied="",
        metrics=metrics,
    )  # fmt: skip


def _is_different(values: tuple[float, float] | None) -> bool:
    return values is not None and values[0] != values[1]


def _trips(pairs: Sequence[TripPair], metrics: Sequence[str], names: Mapping[str, str]) -> Iterator[Html]:
    """Yield a row for each trip: its difference in every metric that differs on some trip."""
    yield frame.paragraph_of(_TRIPS if pairs else _NO_PAIRS)
    if pairs:
        head = ("scenario", "ego", "seed", *map(frame.title_of, metrics))
        trips = ((one, one.driven) for one in pairs)
        rows = [
            (names[trip.scenario], trip.ego, str(trip.seed), *(_difference(one.of(name)) for name in metrics))
            for one, trip in trips
        ]
        yield frame.table(head, rows, is_long=True)


def _difference(values: tuple[float, float] | None) -> str:
    return frame.number(None) if values is None else frame.signed(values[1] - values[0])
