"""The experiment `.toml`: which scenarios, egos, seeds, parameters, options and drivers make up the trials."""

from __future__ import annotations

import os
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple

from pydantic import Field, field_validator

from sumo_reactive.driver.parameters import Delays, Profile
from sumo_reactive.errors import ReactiveError, ScenarioError
from sumo_reactive.lab.batch.network_keys import NetworkKeys, counted_of
from sumo_reactive.lab.drivers.choice import REACTIVE_NAME, SUMO_NAME, DriverChoice, DriverOption, chosen_driver
from sumo_reactive.lab.fundamental_diagram import EVERY_CLASS, CountedEdges
from sumo_reactive.lab.metric_names import IN_BATCHES, METRICS, NETWORK, cut_key
from sumo_reactive.lab.own_metrics import merged
from sumo_reactive.lab.scenario import (
    DriverName,
    KindKeys,
    Scenario,
    Seed,
    load_scenario,
    load_scenario_file,
    named_once,
    own_metrics_of,
    parameter,
)
from sumo_reactive.lab.schema import TomlTable, nearest, problem_at, problem_in, read_toml
from sumo_reactive.sumo.config import OUTPUT_FILES, canonical

OURS = ("seed", "step-length")
"""SUMO options that the experiment names in keys of their own."""

Word = str | int | float | bool


class ExperimentKeys(TomlTable):
    """The table `[experiment]`."""

    scenarios: list[str] = Field(min_length=1)
    """Scenario files and SUMO configurations, beside this file."""
    seeds: list[Seed] | None = Field(default=None, min_length=1)
    """Seeds of every scenario; else each scenario's own."""
    drivers: list[DriverName] = Field(default=[REACTIVE_NAME, SUMO_NAME], min_length=1)
    """Who drives each trip in turn, as `driver` of a scenario names them."""
    metrics: list[str] = Field(default=["arrived", "collisions", "violations", "duration_s", "time_loss_s"])
    """What `results` shows, metrics of your own as `module:function` among them; all are stored."""
    store: str | None = None
    """The store; else beside this file, with its name and `.duckdb`."""
    step_length_s: float | None = Field(default=None, gt=0.0, le=1.0)
    """Simulation step, s; else each scenario's own."""
    until_s: float | None = Field(default=None, gt=0.0)
    """Trials end at this simulation time at the latest, s; else each scenario's own."""
    horizon_s: float | None = Field(default=None, gt=0.0)
    """Trials end this long after the ego's departure at the latest, s."""
    profile: Profile | None = Field(default=None, strict=False)
    """As in a scenario; else each scenario's own."""
    delays: Delays | None = Field(default=None, strict=False)
    """As in a scenario; else each scenario's own."""
    wall_limit_s: float = Field(default=600.0, gt=0.0)
    """Wall-clock time that a trial may take, s."""
    retries: int = Field(default=1, ge=0)
    """A trial that crashed or took too long is tried so many times again."""

    @field_validator("scenarios", "seeds", "drivers", "metrics")
    @classmethod
    def _differ(cls, values: list[Any] | None) -> list[Any] | None:
        for k, value in enumerate(values or ()):
            if values and value in values[:k]:
                raise problem_at(k, "named twice")
        return values


SHARE_METRICS = (
    "egos", "network_arrived", "network_mean_time_loss_s", "network_mean_speed_m_s", "network_co2_g_per_km",
    "egos_collisions", "egos_violations", "egos_near_misses_by_ttc", "egos_near_misses_by_pet", "egos_near_misses_per_km",
)  # fmt: skip
"""What is shown of an experiment with shares of egos that names no metrics."""


class EgoKeys(KindKeys):
    """The table `[egos]`: ids, for every scenario or by scenario, or how many trips to draw, one a trial; or which share of
    all road cars, or of some kinds of them, are egos at once."""

    names: list[str] | dict[str, list[str]] | None = Field(default=None)
    """Ids of egos, a trial each, for every scenario or in a table by scenario; else each scenario's own ego."""
    drawn: int | None = Field(default=None, ge=1)
    """So many trips are drawn as egos, one a trial, in place of `names`."""
    seed: Seed = 0
    """Seed of the draw."""
    min_length_m: float = Field(default=0.0, ge=0.0)
    """Trips drawn are at least so long, m."""
    warm_up_s: float = Field(default=0.0, ge=0.0)
    """Trips drawn depart at least so long after the scenario's begin, s."""


class SampleKeys(TomlTable):
    """The table `[samples]`: `count` points drawn evenly from the ranges [low, high] of `parameters`."""

    count: int = Field(ge=1)
    """How many points."""
    seed: Seed = 0
    """Seed of the draw."""
    parameters: dict[str, list[float]] = Field(min_length=1)
    """The range [low, high] of each parameter, by name."""

    @field_validator("parameters")
    @classmethod
    def _ranges(cls, asked: dict[str, list[float]]) -> dict[str, list[float]]:
        for name, limits in asked.items():
            if len(limits) != 2 or limits[0] >= limits[1]:
                raise problem_at(name, "not a range [low, high]")
        return _by_name(asked)


class ExperimentFile(TomlTable):
    """All tables: values of `parameters` and `options` that are lists make a grid; `driver_options` are by driver."""

    experiment: ExperimentKeys
    """What is run."""
    egos: EgoKeys = Field(default_factory=EgoKeys)
    """Who is driven."""
    parameters: dict[str, float | list[float]] = Field(default_factory=dict)
    """Values of the driver's parameters by name; lists make a grid."""
    samples: SampleKeys | None = None
    """Points drawn from ranges of parameters, each with every point of the grid."""
    options: dict[str, Word | list[Word]] = Field(default_factory=dict)
    """Values of SUMO's options by name; lists make a grid."""
    driver_options: dict[str, dict[str, DriverOption]] = Field(default_factory=dict)
    """What drivers of yours get, a table a driver."""
    network: NetworkKeys = Field(default_factory=NetworkKeys)
    """What is counted in the network of a run with a share of egos."""

    @field_validator("parameters")
    @classmethod
    def _exist(cls, asked: dict[str, float | list[float]]) -> dict[str, float | list[float]]:
        return dict(_by_name({name: value if isinstance(value, list) else [value] for name, value in asked.items()}))

    @field_validator("options")
    @classmethod
    def _free(cls, asked: dict[str, Word | list[Word]]) -> dict[str, Word | list[Word]]:
        for name, values in asked.items():
            if canonical(name) in OUTPUT_FILES:
                raise problem_at(name, "an output that every trial would write to")
            if canonical(name) in OURS:
                raise problem_at(name, "named under [experiment], as 'seeds' or 'step_length_s'")
            if values == []:
                raise problem_at(name, "no value")
        return asked


def _by_name(asked: dict[str, list[float]]) -> dict[str, list[float]]:
    """Return the values of parameters by the driver's own names."""
    return named_once(asked, [_values(name, values) for name, values in asked.items()])


def _values(name: str, values: list[float]) -> tuple[str, list[float]]:
    if not values:
        raise problem_at(name, "no value")
    found = [parameter(name, value) for value in values]
    return found[0][0], [value for _, value in found]


STORE_SUFFIX = ".duckdb"


class Choice(NamedTuple):
    """A scenario of an experiment: as the file names it, as loaded, the egos named for it (empty: none), its seeds, what is
    counted of its network in a run with a share of egos."""

    name: str
    scenario: Scenario
    egos: tuple[str, ...]
    seeds: tuple[int, ...]
    counted: CountedEdges = EVERY_CLASS


@dataclass(frozen=True)
class Experiment:
    """An experiment file as read; a path in it is relative to it. `keys.metrics` are keys of metrics."""

    path: Path
    store: Path
    keys: ExperimentKeys
    choices: tuple[Choice, ...]
    egos: EgoKeys
    grid: dict[str, list[float]]
    samples: SampleKeys | None
    options: dict[str, list[Word]]
    drivers: tuple[DriverChoice, ...]

    def problem(self, keys: tuple[str | int, ...], message: str) -> ScenarioError:
        """Return the error that names the line of a key."""
        return problem_in(self.path, keys, message)


def load_experiment(path: Path) -> Experiment:
    """Read an experiment file; raise ScenarioError naming file, line and key of what cannot be run."""
    file = read_toml(path, ExperimentFile)
    keys = file.experiment
    _check_egos(path, file)
    if file.egos.rules and "metrics" not in keys.model_fields_set:
        keys = keys.model_copy(update={"metrics": [*SHARE_METRICS, *map(cut_key, file.network.cuts)]})
    choices = tuple(_choice(path, file, k, name) for k, name in enumerate(keys.scenarios))
    if file.egos.rules:
        counted = counted_of(path, file.network, {one.name: one.scenario.config for one in choices})
        choices = tuple(one._replace(counted=counted[one.name]) for one in choices)
    keys, choices = _with_own(path, keys, choices, file)
    store = Path(os.path.normpath(path.parent / keys.store)) if keys.store else path.with_suffix(STORE_SUFFIX)
    grid = {name: value if isinstance(value, list) else [value] for name, value in file.parameters.items()}
    options = {name: value if isinstance(value, list) else [value] for name, value in file.options.items()}
    return Experiment(path, store, keys, choices, file.egos, grid, file.samples, options, _drivers(path, file))


def _drivers(path: Path, file: ExperimentFile) -> tuple[DriverChoice, ...]:
    for name in file.driver_options:
        if name not in file.experiment.drivers:
            near = nearest(name, file.experiment.drivers)
            raise problem_in(path, ("driver_options", name), f"no driver of this experiment{near}")
    folder = path.parent.absolute()
    return tuple(chosen_driver(name, file.driver_options.get(name, {}), folder) for name in file.experiment.drivers)


def _check_egos(path: Path, file: ExperimentFile) -> None:
    egos = file.egos
    if egos.names is not None and egos.drawn is not None:
        raise problem_in(path, ("egos", "drawn"), "there are 'names' already")
    if egos.names is not None and not egos.names:
        raise problem_in(path, ("egos", "names"), "names nobody: no trial is left")
    for name, ids in (egos.names if isinstance(egos.names, dict) else {}).items():
        if name not in file.experiment.scenarios:
            near = nearest(name, file.experiment.scenarios)
            raise problem_in(path, ("egos", "names", name), f"no scenario of this experiment{near}")
        if not ids:
            raise problem_in(path, ("egos", "names", name), "names nobody: no trial is left")
    _check_share(path, file)
    both = set(file.parameters) & set(file.samples.parameters if file.samples else ())
    for name in both:
        raise problem_in(path, ("samples", "parameters", name), "there is a grid of it already")


def _check_share(path: Path, file: ExperimentFile) -> None:
    egos, keys = file.egos, file.experiment
    known = METRICS if not egos.rules else NETWORK
    for k, name in enumerate(keys.metrics if "metrics" in keys.model_fields_set else ()):
        if name in IN_BATCHES and name not in known:
            what = "a trip, and there is none with a 'share'" if egos.rules else "a network, which takes [egos] share = […]"
            raise problem_in(path, ("experiment", "metrics", k), f"'{name}' is a metric of {what}")
    if not egos.rules:
        if "network" in file.model_fields_set:
            raise problem_in(path, ("network",), "counts all vehicles of a run with a share of egos: [egos] share = […]")
        return
    for name in ("names", "drawn"):
        if getattr(egos, name) is not None:
            raise problem_in(path, ("egos", egos.first_kind), f"there are '{name}' already")
    if "drivers" in keys.model_fields_set:
        raise problem_in(path, ("experiment", "drivers"), "with a 'share', who is no ego has SUMO's own driver")
    if keys.horizon_s is not None:
        raise problem_in(path, ("experiment", "horizon_s"), "with a 'share', all runs end at one time: 'until_s'")


def _choice(path: Path, file: ExperimentFile, k: int, name: str) -> Choice:
    source, keys = path.parent / name, file.experiment
    try:
        is_ours = source.suffix == ".toml"
        scenario = load_scenario_file(source).scenario if is_ours else load_scenario(source)
        seeds = load_scenario_file(source).seeds if is_ours else (scenario.seed,)
    except ReactiveError as error:
        raise problem_in(path, ("experiment", "scenarios", k), str(error)) from error
    names = file.egos.names
    egos = names.get(name, []) if isinstance(names, dict) else names or []
    return Choice(name, scenario, tuple(egos), tuple(keys.seeds or seeds))


def _with_own(
    path: Path, keys: ExperimentKeys, choices: tuple[Choice, ...], file: ExperimentFile
) -> tuple[ExperimentKeys, tuple[Choice, ...]]:
    """Return the metrics to show by their keys, and scenarios that measure the user's own among them as well."""
    place, cuts = ("experiment", "metrics"), set(map(cut_key, file.network.cuts))
    theirs = {source.name for choice in choices for source in choice.scenario.metrics} | cuts
    asked = {k: name for k, name in enumerate(keys.metrics) if name not in IN_BATCHES and name not in theirs}
    own = own_metrics_of(path, place, asked)
    names = dict(enumerate(keys.metrics)) | dict(zip(asked, (source.name for source in own), strict=True))
    if file.egos.rules and not set(names.values()) <= {*NETWORK, *cuts}:
        raise problem_in(path, place, "a metric of one's own is of a trip, and there is none with a 'share'")
    try:
        measured = [replace(one.scenario, metrics=merged(one.scenario.metrics, own)) for one in choices]
    except ScenarioError as error:
        raise problem_in(path, place, str(error)) from error
    shown = keys.model_copy(update={"metrics": list(names.values())})
    return shown, tuple(one._replace(scenario=scenario) for one, scenario in zip(choices, measured, strict=True))
