"""The trials of an experiment: scenarios × egos × seeds × parameters × options × drivers, each with its key."""

from __future__ import annotations

import hashlib
import itertools
import json
import os
import random
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from functools import cache, cached_property
from pathlib import Path
from typing import NamedTuple, TypeVar

import sumo_reactive
from sumo_reactive.errors import ScenarioError
from sumo_reactive.lab.batch.experiment import Choice, Experiment, Word
from sumo_reactive.lab.drivers.choice import REACTIVE, DriverChoice
from sumo_reactive.lab.drivers.loading import digest_of_driver
from sumo_reactive.lab.scenario import Scenario
from sumo_reactive.lab.simulation import started, versions
from sumo_reactive.lab.task import SHARE, Task, replay_command
from sumo_reactive.sumo.config import INPUT_FILES, OUTPUT_FILES, option_words, read_config
from sumo_reactive.sumo.input_files import inputs_of, words_of
from sumo_reactive.sumo.outputs import AS_READ, read_trips, silenced
from sumo_reactive.sumo.session import is_road_car

SCOUT = "sumo_reactive.lab.batch.trials:scout"
"""Name of `scout`, to be called in another process."""


class Departure(NamedTuple):
    """A road car that arrives when SUMO drives it: when it departs (s after the scenario's begin), how far it goes (m)."""

    vehicle_id: str
    depart_s: float
    length_m: float


def scout(scenario: Scenario) -> list[Departure]:
    """Run the scenario in this process without an ego until it ends or `until_s`; return its trips by departure and id."""
    cars: set[str] = set()

    def look(vehicle_id: str) -> bool:
        if is_road_car(vehicle_id):
            cars.add(vehicle_id)
        return False

    with tempfile.TemporaryDirectory(prefix="sumo_reactive_") as folder:
        trips = Path(folder) / "trips.xml"
        wanted = silenced(read_config(scenario.config).options) | {"tripinfo-output": str(trips), **AS_READ}
        with started(replace(scenario, ego=None), option_words(wanted)) as run:
            run.session.wait_for(look, scenario.until_s, None)
        found = [
            Departure(trip.vehicle_id, round(trip.departure - run.begin, 3), trip.length_m)
            for trip in read_trips(trips)
            if trip.vehicle_id in cars and trip.departure is not None and trip.arrival is not None and not trip.vaporized
        ]
    return sorted(found, key=lambda trip: (trip.depart_s, trip.vehicle_id))


def drawn_egos(trips: Sequence[Departure], count: int, seed: int, min_length_m: float, warm_up_s: float) -> list[str]:
    """Return the ids of `count` trips drawn at random among those that qualify, by departure; fewer if fewer do."""
    fit = [trip for trip in trips if trip.length_m >= min_length_m and trip.depart_s >= warm_up_s]
    chosen = random.Random(seed).sample(range(len(fit)), min(count, len(fit)))
    return [fit[k].vehicle_id for k in sorted(chosen)]


_ROOMS_APART = ("cli", "show")
"""Rooms that no number depends on."""


def key_of(task: Task) -> str:
    """Return the key of a task; raise what reading its scenario raises."""
    scenario = task.scenario
    parts = {
        "files": digest_of_files(scenario.config, scenario.sumo_options),
        "ego": scenario.ego,
        "seed": scenario.seed,
        "step_length_s": scenario.step_length_s,
        "until_s": scenario.until_s,
        "horizon_s": scenario.horizon_s,
        "until_end": scenario.until_end,
        "profile": scenario.profile.value,
        "delays": scenario.delays.value,
        "obstacle_polygons": scenario.obstacle_polygons,
        "sumo_options": scenario.sumo_options,
        "driver": str(scenario.driver),
        "driver_sources": digest_of_driver(scenario.driver),
        "egos": scenario.egos and asdict(scenario.egos),
        "counted": scenario.egos and asdict(task.counted),
        "parameters": scenario.parameters.varied,
        "metrics": {source.name: source.digest for source in scenario.metrics},
        "versions": release(),
    }
    return hashlib.sha256(json.dumps(parts, sort_keys=True).encode()).hexdigest()


def key_of_scouting(scenario: Scenario) -> str:
    """Return the key of a scenario under SUMO's own drivers alone: which trips there are to draw from."""
    files, options = digest_of_files(scenario.config, scenario.sumo_options), scenario.sumo_options
    parts = (files, scenario.seed, scenario.step_length_s, scenario.until_s, options, release()["sumo"])
    return hashlib.sha256(json.dumps(parts).encode()).hexdigest()


def digest_of_files(config_file: Path, sumo_options: Sequence[str] = ()) -> str:
    """Return a digest of what a configuration says, of all files that SUMO reads for it, and of the variables in them.

    Contents count, names do not. Raises ScenarioError for a file that cannot be read. Each file is read once a process.
    """
    return _digest_of_files(config_file, words_of(sumo_options))


@cache
def _digest_of_files(config_file: Path, words: tuple[str, ...]) -> str:
    config = read_config(config_file)
    try:
        inputs = inputs_of(config_file, words)
    except OSError as error:
        raise ScenarioError(f"{error.filename or config_file}: cannot be read: {error.strerror}") from error
    said = {name: value for name, value in config.options.items() if name not in INPUT_FILES and name not in OUTPUT_FILES}
    asked = sorted(INPUT_FILES & set(config.options))
    variables = {name: os.environ.get(name) for name in inputs.variables}
    parts = (said, asked, len(inputs.files), inputs.digest, variables)
    return hashlib.sha256(json.dumps(parts, sort_keys=True).encode()).hexdigest()


@cache
def release() -> dict[str, str]:
    """Return the versions that numbers depend on, and a digest of this package's sources."""
    package = Path(sumo_reactive.__file__).parent
    digest = hashlib.sha256()
    for source in sorted(package.rglob("*.py")):
        name = source.relative_to(package)
        if name.parts[0] not in _ROOMS_APART:
            digest.update(f"{name.as_posix()}\n".encode() + source.read_bytes())
    return {**versions(), "sources": digest.hexdigest()[:16]}


Value = TypeVar("Value")
Scout = Callable[[Scenario], list[Departure]]


@dataclass(frozen=True)
class Trial:
    """One trial: the scenario as the experiment names it, what varies (`parameters`, `options`), and what has to be done."""

    scenario: str
    parameters: Mapping[str, float]
    options: Mapping[str, Word]
    task: Task

    @cached_property
    def key(self) -> str:
        """A digest of everything that its numbers depend on."""
        return key_of(self.task)

    @property
    def replay(self) -> str:
        """The command that runs it again."""
        return replay_command(replace(self.task, scenario=replace(self.task.scenario, sumo_options=self._own_options)))

    @property
    def _own_options(self) -> tuple[str, ...]:
        return _words(self.options)

    def __str__(self) -> str:
        varied = {**self.parameters, **self.options}
        said = "".join(f" {name}={value}" for name, value in varied.items())
        scenario = self.task.scenario
        who = f"{scenario.ego or '(own ego)'} " if scenario.egos is None else ""
        return f"{self.scenario} {who}seed {scenario.seed} {scenario.driver}{said}"


def trials_of(experiment: Experiment, scout: Scout) -> list[Trial]:
    """Return the trials, each once; `scout` finds trips to draw from.

    Raises ScenarioError if nothing is left of a selection.
    """
    if experiment.egos.rules:
        return list({trial.key: trial for trial in _fleets(experiment)}.values())
    egos = {choice.name: _egos(experiment, choice, scout) for choice in experiment.choices}
    found: dict[str, Trial] = {}
    for point, choice, options in itertools.product(
        list(_points(experiment)), experiment.choices, list(_product(experiment.options))
    ):
        for case in itertools.product(choice.seeds, egos[choice.name], experiment.drivers):
            trial = _trial(experiment, choice, case, point, options)
            found.setdefault(trial.key, trial)
    return list(found.values())


def _fleets(experiment: Experiment) -> Iterator[Trial]:
    """Yield a trial for each rule, seed and point; the rule's share is told among what varies."""
    for point, choice, options in itertools.product(
        list(_points(experiment)), experiment.choices, list(_product(experiment.options))
    ):
        for rule, seed in itertools.product(experiment.egos.rules, choice.seeds):
            one = _trial(experiment, choice, (seed, None, REACTIVE), point, options)
            # outputs are dealt with where it is run; of a trip's own metrics there is none
            scenario = replace(one.task.scenario, sumo_options=_words(options), metrics=(), egos=rule)
            yield replace(one, parameters={SHARE: rule.drawn_share, **point}, task=Task(scenario, choice.counted))


def _egos(experiment: Experiment, choice: Choice, scout: Scout) -> list[str | None]:
    rule = experiment.egos
    if rule.drawn is None:
        return list(choice.egos) or [choice.scenario.ego]
    asked = replace(choice.scenario, ego=None, until_s=experiment.keys.until_s or choice.scenario.until_s)
    trips = scout(replace(asked, config=asked.config.absolute(), source=asked.source.absolute()))
    found = drawn_egos(trips, rule.drawn, rule.seed, rule.min_length_m, rule.warm_up_s)
    if len(found) < rule.drawn:
        shown = f"only {len(found)} of the {len(trips)} trips of {choice.name} are at least {rule.min_length_m:g} m long"
        raise experiment.problem(("egos", "drawn"), f"{shown} and depart after {rule.warm_up_s:g} s")
    return list(found)


def _trial(
    experiment: Experiment, choice: Choice, case: tuple[int, str | None, DriverChoice],
    grid_point: Mapping[str, float], options: Mapping[str, Word],
) -> Trial:  # fmt: skip
    """Return one trial. Parameters are this project's driver's: SUMO's own is the same baseline whatever they are."""
    keys, base, (seed, ego, driver) = experiment.keys, choice.scenario, case
    point = grid_point if driver == REACTIVE else {}
    scenario = replace(
        base,
        config=base.config.absolute(),
        source=Path(os.path.normpath(base.source.absolute())),
        ego=ego,
        seed=seed,
        step_length_s=keys.step_length_s or base.step_length_s,
        until_s=keys.until_s or base.until_s,
        horizon_s=keys.horizon_s or base.horizon_s,
        profile=keys.profile or base.profile,
        delays=keys.delays or base.delays,
        parameters=base.parameters.with_values(point),
        sumo_options=(*_quiet(base.config), *_words(options)),
        driver=driver,
    )
    return Trial(choice.name, point, options, Task(scenario))


@cache
def _quiet(config: Path) -> tuple[str, ...]:
    """Return SUMO options against the outputs that a configuration asks for: trials at the same time would share them."""
    return _words(silenced(read_config(config).options))


def _points(experiment: Experiment) -> Iterator[dict[str, float]]:
    """Yield the points of the parameter space: the grid, each with every sample."""
    samples = list(_samples(experiment)) or [{}]
    for point, sample in itertools.product(_product(experiment.grid), samples):
        yield {**point, **sample}


def _samples(experiment: Experiment) -> Iterator[dict[str, float]]:
    if experiment.samples is not None:
        draw = random.Random(experiment.samples.seed)
        for _ in range(experiment.samples.count):
            yield {name: draw.uniform(*limits) for name, limits in experiment.samples.parameters.items()}


def _product(values: Mapping[str, list[Value]]) -> Iterator[dict[str, Value]]:
    for point in itertools.product(*values.values()):
        yield dict(zip(values, point, strict=True))


def _words(options: Mapping[str, Word]) -> tuple[str, ...]:
    """Return options as SUMO's command line takes them."""
    said = {name: str(value).lower() if isinstance(value, bool) else str(value) for name, value in options.items()}
    return tuple(option_words(said))
