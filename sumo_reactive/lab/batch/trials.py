"""The trials of an experiment: scenarios × egos × seeds × parameters × options × drivers, each with its key."""

from __future__ import annotations

import itertools
import os
import random
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cache, cached_property
from pathlib import Path
from typing import TypeVar

from sumo_reactive.driver import parameters
from sumo_reactive.driver.overrides import overrides
from sumo_reactive.lab.batch.experiment_file import Choice, Experiment
from sumo_reactive.lab.batch.experiment_keys import Word
from sumo_reactive.lab.batch.scouting import Departure, drawn_egos
from sumo_reactive.lab.batch.trial_key import key_of
from sumo_reactive.lab.process.driver import Driver
from sumo_reactive.lab.process.replay import replay_command
from sumo_reactive.lab.process.task import Task
from sumo_reactive.lab.scenario import Scenario
from sumo_reactive.sumo.config import read_config
from sumo_reactive.sumo.outputs import silenced

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
        return f"{self.scenario} {scenario.ego or '(own ego)'} seed {scenario.seed} {self.task.driver.value}{said}"


def trials_of(experiment: Experiment, scout: Scout) -> list[Trial]:
    """Return the trials, each once, those with the same parameters one after another; `scout` finds trips to draw from.

    Raises ScenarioError if nothing is left of a selection.
    """
    egos = {choice.name: _egos(experiment, choice, scout) for choice in experiment.choices}
    found: dict[str, Trial] = {}
    for point, choice, options in itertools.product(
        list(_points(experiment)), experiment.choices, list(_product(experiment.options))
    ):
        for seed, ego, driver in itertools.product(choice.seeds, egos[choice.name], experiment.keys.drivers):
            trial = _trial(experiment, choice, ego, seed, driver, point, options)
            found.setdefault(trial.key, trial)
    return _by_parameters(list(found.values()))


def _by_parameters(trials: list[Trial]) -> list[Trial]:
    """Return the trials so that those with the same parameters, which one process can run, follow each other."""
    place: dict[str, int] = {}
    for trial in trials:
        place.setdefault(str(trial.task.parameters), len(place))
    return sorted(trials, key=lambda trial: place[str(trial.task.parameters)])


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
    experiment: Experiment, choice: Choice, ego: str | None, seed: int, driver: Driver,
    grid_point: Mapping[str, float], options: Mapping[str, Word],
) -> Trial:  # fmt: skip
    """Return one trial. Parameters are this project's driver's: SUMO's own is the same baseline whatever they are."""
    keys, base = experiment.keys, choice.scenario
    point = grid_point if driver is Driver.REACTIVE else {}
    asked = {**base.parameters, **overrides(), **point}
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
        parameters=asked,
        sumo_options=(*_quiet(base.config), *_words(options)),
    )
    return Trial(choice.name, point, options, Task(scenario, driver, asked))


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
            yield {name: _drawn(draw, name, *limits) for name, limits in experiment.samples.parameters.items()}


def _drawn(draw: random.Random, name: str, low: float, high: float) -> float:
    is_whole = isinstance(vars(parameters)[name], int)
    return draw.randint(int(low), int(high)) if is_whole else draw.uniform(low, high)


def _product(values: Mapping[str, list[Value]]) -> Iterator[dict[str, Value]]:
    for point in itertools.product(*values.values()):
        yield dict(zip(values, point, strict=True))


def _words(options: Mapping[str, Word]) -> tuple[str, ...]:
    """Return options as SUMO's command line takes them."""
    said = {name: str(value).lower() if isinstance(value, bool) else str(value) for name, value in options.items()}
    return tuple(word for name, value in said.items() for word in (f"--{name.lstrip('-')}", value))
