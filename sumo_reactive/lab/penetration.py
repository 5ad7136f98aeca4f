"""Egos that a rule chooses: one run, and what became of them and of everybody in the network."""

from __future__ import annotations

import hashlib
import tempfile
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from struct import Struct
from typing import Any

from sumo_reactive.driver.nouns.record import Scene
from sumo_reactive.lab.comparison.network_effects import M_PER_KM, Outputs, network_figures
from sumo_reactive.lab.ego_rule import EgoRule
from sumo_reactive.lab.fault import Fault
from sumo_reactive.lab.fleet import run_fleet
from sumo_reactive.lab.fundamental_diagram import diagram_of
from sumo_reactive.lab.recorder import FleetRecorder
from sumo_reactive.lab.result import FleetResult, NetworkResult, TrialResult
from sumo_reactive.lab.scenario import Scenario
from sumo_reactive.lab.simulation import versions
from sumo_reactive.lab.task import Task
from sumo_reactive.sumo.config import given_options, option_words, read_config
from sumo_reactive.sumo.edge_counts import EdgeCounts, Road, edges_for_cars, read_edge_times, read_passages
from sumo_reactive.sumo.net_file import parse

_PLACE = Struct("5d")


def run_share(task: Task) -> dict[str, Any]:
    """Run a task with a rule for its egos in this process; return the fields that its `Outcome` takes from the trial.

    The run ends where the scenario ends, or at its `until_s`: at the same simulation time whatever the share.
    """
    scenario, rule, config = task.scenario, task.scenario.egos or EgoRule(), read_config(task.scenario.config)
    digest = hashlib.sha256()

    def see(scene: Scene) -> None:
        step = scene.step
        digest.update(scene.ego.encode() + _PLACE.pack(step.time, step.x, step.y, step.heading, step.speed))

    with tempfile.TemporaryDirectory(prefix="sumo_reactive_") as folder:
        outputs, roads, given = Outputs(Path(folder)), edges_for_cars(parse(config.net_file)), scenario.sumo_options
        counts = EdgeCounts(Path(folder), task.counted.interval_s, task.counted.lanes_of_cuts(roads))
        options = given_options(given) | outputs.options(config) | counts.options(config, given)
        asked = replace(
            scenario, ego=None, until_s=end_of(scenario), until_end=True, sumo_options=tuple(option_words(options))
        )
        fleet = run_fleet(asked, rule, observer=see, may_be_nobody=not rule.ids)
        duration = fleet.until - config.begin_s
        figures = _of_egos(fleet) | network_figures(outputs, duration) | _of_cuts(task, counts, roads, duration)
        diagram = diagram_of(list(read_edge_times(counts.times)), task.counted.groups_in(roads), fleet.until)
    network = NetworkResult(
        share=rule.drawn_share, metrics=figures, by_ego=_faults(fleet.results), departure_s=config.begin_s, diagram=diagram,
        stranded=tuple((one.ego, one.ended) for one in fleet.stranded), versions=versions(),
    )  # fmt: skip
    return {"network": network, "trajectory": digest.hexdigest()}


def end_of(scenario: Scenario) -> float | None:
    """Return the simulation time (s) at which a run whose egos a rule chooses ends at the latest; None: when all is over."""
    ends = (scenario.until_s, read_config(scenario.config).end_s)
    return min((end for end in ends if end is not None), default=None)


def record_fleet(order: tuple[Task, Path]) -> None:
    """Run such a task in this process, and record each ego of it in a folder in place of what is recorded there."""
    (task, folder), rule = order, order[0].scenario.egos or EgoRule()
    recorder = FleetRecorder(folder, overwrite=True)
    recorder.write(run_fleet(replace(task.scenario, until_s=end_of(task.scenario)), rule, observer=recorder.see))


def _of_cuts(task: Task, counts: EdgeCounts, roads: Mapping[str, Road], duration: float) -> dict[str, float | None]:
    passed = read_passages(counts.passages) if task.counted.cuts else {}
    return task.counted.throughput(passed, roads, duration)


def _of_egos(fleet: FleetResult) -> dict[str, float | None]:
    """Return the figures of all egos together by name."""
    arrived = [one for one in fleet.results if one.arrived]

    def mean(values: Sequence[float]) -> float | None:
        return round(sum(values) / len(values), 4) if values else None

    return {
        "egos": len(fleet.results),
        "egos_arrived": len(arrived),
        "egos_mean_duration_s": mean([one.duration_s for one in arrived]),
        "egos_mean_time_loss_s": mean([one.time_loss_s for one in arrived]),
        "egos_collisions": contact_count(fleet.results),
        "egos_violations": sum(len(one.violations) for one in fleet.results),
        "egos_hard_braking_caused": sum(len(one.hard_brakes) for one in fleet.results),
        **_near_misses(fleet.results),
    }


def _near_misses(egos: Sequence[TrialResult]) -> dict[str, float | None]:
    """Return how many near misses the egos had; one between two egos is one of each."""
    by_ttc, by_pet = (sum(one.figures[name] or 0 for one in egos) for name in ("near_misses_by_ttc", "near_misses_by_pet"))
    way_km = sum(one.distance_m for one in egos) / M_PER_KM
    return {
        "egos_near_misses_by_ttc": by_ttc,
        "egos_near_misses_by_pet": by_pet,
        "egos_near_misses_per_km": round((by_ttc + by_pet) / way_km, 4) if way_km > 0.0 else None,
    }


def contact_count(results: Sequence[TrialResult]) -> int:
    """Return how many contacts the egos had, each once: of two egos that touch, either finds the same contact.

    Of a pair the larger of both counts is taken: who has arrived, or is judged a step later, may miss one.
    """
    found = Counter((one.ego, fault.user_id) for one in results for fault in one.collisions)
    pairs: dict[frozenset[str], int] = {}
    for pair, count in found.items():
        pairs[frozenset(pair)] = max(count, pairs.get(frozenset(pair), 0))
    return sum(pairs.values())


def _faults(results: Sequence[TrialResult]) -> tuple[tuple[str, Fault], ...]:
    return tuple(sorted(((one.ego, fault) for one in results for fault in one.faults), key=lambda found: found[1].time))
