"""Scenarios: what to run, by whom, and what is expected of it, from a scenario `.toml` or a SUMO configuration."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any, NamedTuple, TypeVar

from pydantic import AfterValidator, Field, field_validator, model_validator

from sumo_reactive.driver.parameters import USUAL, Delays, Parameters, Profile, name_of
from sumo_reactive.errors import ParameterError, ScenarioError
from sumo_reactive.lab.drivers.choice import (
    REACTIVE,
    REACTIVE_NAME,
    DriverChoice,
    DriverOption,
    chosen_driver,
    driver_problem,
)
from sumo_reactive.lab.ego_rule import EgoRule, region_of, several
from sumo_reactive.lab.metric_names import METRICS, NETWORK
from sumo_reactive.lab.own_metrics import MetricSource, merged, metric_source
from sumo_reactive.lab.schema import TomlTable, nearest, problem_at, problem_in, read_toml
from sumo_reactive.sumo.config import OBSTACLE_POLYGONS, given_options, read_config, seconds_of

NamedValue = TypeVar("NamedValue")


class Limit(TomlTable):
    """A metric's smallest and largest value that is accepted, `{ min = …, max = … }`; at least one of them is given."""

    min: float | None = Field(default=None, allow_inf_nan=False)
    """No less is accepted."""
    max: float | None = Field(default=None, allow_inf_nan=False)
    """No more is accepted."""

    @model_validator(mode="after")
    def _says_something(self) -> Limit:
        if self.min is None and self.max is None:
            raise ValueError("needs min, max or both")
        if self.min is not None and self.max is not None and self.min > self.max:
            raise ValueError(f"min {self.min:g} is above max {self.max:g}")
        return self


class Expectation(TomlTable):
    """The table `[expect]`: whether the ego arrives, how many `collisions` and `violations` it has at most, and limits of
    metrics by name."""

    arrived: bool = True
    """Whether the ego arrives."""
    collisions: int = Field(default=0, ge=0)
    """So many at most."""
    violations: int = Field(default=0, ge=0)
    """So many at most."""
    metrics: dict[str, Limit] = Field(default_factory=dict)
    """Limits by the name of a metric: `{ min = …, max = … }`, or one of them."""


DEFAULT_SEED = 42


@dataclass(frozen=True, kw_only=True)
class Scenario:
    """One run: SUMO configuration `config`, vehicle `ego` (None: to be chosen), as named by the file `source`; or the
    vehicles that the rule `egos` chooses, all at once.

    `step_length_s` None: the scenario's own or 0.1 s, whichever is finer. `until_s` is the simulation time at which the
    run ends at the latest; it ends `horizon_s` after the ego's departure at the latest, too. `until_end` plays the scenario
    out after the ego's arrival. Polygons of the type `obstacle_polygons` stand on the road as bodies. `driver` drives;
    `parameters` are those of this project's, `metrics` the user's own.
    """

    config: Path
    ego: str | None = None
    seed: int = DEFAULT_SEED
    step_length_s: float | None = None
    until_s: float | None = None
    profile: Profile = Profile.DEFAULT
    delays: Delays = Delays.REPLAN
    until_end: bool = False
    sumo_options: tuple[str, ...] = ()
    obstacle_polygons: str = OBSTACLE_POLYGONS
    source: Path = Path()
    parameters: Parameters = USUAL
    horizon_s: float | None = None
    driver: DriverChoice = REACTIVE
    metrics: tuple[MetricSource, ...] = ()
    egos: EgoRule | None = None

    def end_after(self, departure: float) -> float | None:
        """Return the simulation time (s) at which the run ends at the latest if the ego departs at `departure`."""
        horizon = None if self.horizon_s is None else departure + self.horizon_s
        return min((end for end in (self.latest_end, horizon) if end is not None), default=None)

    @property
    def latest_end(self) -> float | None:
        """The simulation time (s) at which the run ends at the latest: `until_s`, or the `end` among SUMO's options.

        The `end` that the configuration names is no such end: who is under way then drives on to the goal.
        """
        given = given_options(self.sumo_options).get("end", "")
        ends = (self.until_s, seconds_of(given) if given and not given.startswith("-") else None)
        return min((end for end in ends if end is not None), default=None)


class ScenarioFile(NamedTuple):
    """What a scenario `.toml` says: the scenario with the first of its `seeds` and of its `rules` for several egos (empty:
    there is one), and what is expected of each."""

    scenario: Scenario
    seeds: tuple[int, ...]
    expectation: Expectation
    rules: tuple[EgoRule, ...] = ()

    @property
    def variants(self) -> tuple[EgoRule | None, ...]:
        """The rules; None in place of them for the one ego."""
        return self.rules or (None,)


Seed = Annotated[int, Field(ge=0, le=2**31 - 1)]
"""A seed as files may name it."""


def _known_driver(name: str) -> str:
    if problem := driver_problem(name):
        raise ValueError(problem)
    return name


DriverName = Annotated[str, AfterValidator(_known_driver)]
"""A driver as files may name it."""


_Share = Annotated[float, Field(ge=0.0, le=1.0)]
_Metres = Annotated[float, Field(allow_inf_nan=False)]


class KindKeys(TomlTable):
    """Which road cars are egos at once: a share of all, or of some kinds of them."""

    share: list[_Share] | None = Field(default=None, min_length=1)
    """Shares that are egos at once, drawn by id and seed, a run each; else all, if kinds or a region are named."""
    types: list[str] = Field(default_factory=list, min_length=1)
    """Only vehicles of these types."""
    classes: list[str] = Field(default_factory=list, min_length=1)
    """Only vehicles of these SUMO vehicle classes."""
    region: list[_Metres] | None = Field(default=None, min_length=4, max_length=4)
    """Only vehicles that depart within a rectangle: x and y of a corner and of the opposite one, m."""

    @property
    def first_kind(self) -> str:
        """The first key of these that the file names; empty: none."""
        return next((name for name in KindKeys.model_fields if name in self.model_fields_set), "")

    @property
    def rules(self) -> tuple[EgoRule, ...]:
        """A rule for each share; none if the file names neither a share nor a kind."""
        region = region_of(self.region) if self.region else None
        of_kind = EgoRule(types=tuple(self.types), classes=tuple(self.classes), region=region)
        shares: list[float | None] = [*self.share] if self.share else [None]
        return tuple(replace(of_kind, share=share) for share in shares) if self.first_kind else ()


class RuleKeys(KindKeys):
    """The table `[egos]`: several egos at once, in place of the one of `[scenario]`."""

    names: list[str] = Field(default_factory=list, min_length=1)
    """Ids of vehicles that are egos besides."""

    @property
    def rules(self) -> tuple[EgoRule, ...]:
        """A rule for each share; none if the file names nobody."""
        ids = tuple(self.names)
        return tuple(replace(rule, ids=ids) for rule in super().rules) or ((EgoRule(ids=ids),) if ids else ())


class ScenarioKeys(TomlTable):
    """The table `[scenario]`."""

    config: str
    """The SUMO configuration, beside this file."""
    ego: str | None = None
    """The vehicle to drive; else one named `ego`, else the first car to depart."""
    seed: Seed = DEFAULT_SEED
    """Seed of the random numbers."""
    seeds: list[Seed] | None = Field(default=None, min_length=1)
    """Several, in place of `seed`: `check`, `compare` and `batch` run each, `run` the first."""
    step_length_s: float | None = Field(default=None, gt=0.0, le=1.0)
    """Simulation step, s; else SUMO's configuration's or 0.1 s, whichever is finer."""
    until_s: float | None = Field(default=None, gt=0.0)
    """The run ends at this simulation time at the latest, s."""
    profile: Profile = Field(default=Profile.DEFAULT, strict=False)
    """The paper's nine commands, or the finer default."""
    delays: Delays = Field(default=Delays.REPLAN, strict=False)
    """Whether a delay shifts the times of the plan, as in the paper, or they are planned anew."""
    obstacle_polygons: str = OBSTACLE_POLYGONS
    """Polygons of this type stand on the road as bodies."""
    parameters: dict[str, Any] = Field(default_factory=dict)
    """Other values for parameters of the driver, by name."""
    driver: DriverName = REACTIVE_NAME
    """Who drives: `reactive`, `sumo`, `module:Class`, `exec:PROGRAM …` or the name of an installed one."""
    driver_options: dict[str, DriverOption] = Field(default_factory=dict)
    """What a driver of yours gets, by name."""
    metrics: list[str] = Field(default_factory=list)
    """Metrics of your own, each `module:function` or the name of an installed one."""

    @field_validator("seeds")
    @classmethod
    def _differ(cls, seeds: list[int]) -> list[int]:
        if len(set(seeds)) < len(seeds):
            raise ValueError("a seed is named twice")
        return seeds

    @field_validator("parameters")
    @classmethod
    def _exist(cls, asked: dict[str, Any]) -> dict[str, float]:
        return named_once(asked, [parameter(name, value) for name, value in asked.items()])

    @model_validator(mode="after")
    def _one_kind_of_seed(self) -> ScenarioKeys:
        if {"seed", "seeds"} <= self.model_fields_set:
            raise problem_at("seeds", "there is 'seed' already")
        return self


def parameter(name: str, value: object) -> tuple[str, float]:
    """Return a parameter's name in small letters, and the value that a file gives it; tell of what cannot be."""
    try:
        return name_of(name), getattr(Parameters.of({name: value}), name_of(name))
    except ParameterError as error:
        raise problem_at(name, str(error)) from error


def named_once(names: Iterable[str], found: Iterable[tuple[str, NamedValue]]) -> dict[str, NamedValue]:
    """Return what was found for the `names` that a file spells, by the driver's own; tell of one that comes twice."""
    values: dict[str, NamedValue] = {}
    for name, (known, value) in zip(names, found, strict=True):
        if known in values:
            raise problem_at(name, f"parameter '{known}' is named twice")
        values[known] = value
    return values


class _File(TomlTable):
    scenario: ScenarioKeys
    egos: RuleKeys = Field(default_factory=RuleKeys)
    expect: Expectation = Field(default_factory=Expectation)


def load_scenario(path: Path) -> Scenario:
    """Read a scenario `.toml`, or a SUMO configuration whatever its name; raise ScenarioError naming file, line and key."""
    if path.suffix == ".toml":
        return load_scenario_file(path).scenario
    config = read_config(path)
    return Scenario(config=path, seed=_own_seed(config.options.get("seed", "")), source=path)


def load_scenario_file(path: Path) -> ScenarioFile:
    """Read a scenario `.toml` with its seeds and what it expects; raise ScenarioError naming file, line and key."""
    file = read_toml(path, _File)
    keys = dict(file.scenario)
    seeds = tuple(keys.pop("seeds") or [keys["seed"]])
    config = path.parent / file.scenario.config
    read_config(config)
    driver = chosen_driver(keys["driver"], keys.pop("driver_options"), path.parent.absolute())
    keys |= {"config": config, "source": path, "seed": seeds[0], "parameters": Parameters.of(keys["parameters"])}
    keys["metrics"] = own_metrics_of(path, ("scenario", "metrics"), dict(enumerate(keys["metrics"])))
    rules = _rules(path, file)
    known = tuple(NETWORK) if rules else (*METRICS, *(source.name for source in keys["metrics"]))
    for name in file.expect.metrics:
        if name not in known:
            what = "metric of several egos" if rules else "metric"
            raise problem_in(path, ("expect", "metrics", name), f"unknown {what} '{name}'{nearest(name, known)}")
    scenario = Scenario(**keys | {"driver": driver, "egos": next(iter(rules), None)})
    return ScenarioFile(scenario, seeds, file.expect, rules)


def _rules(path: Path, file: _File) -> tuple[EgoRule, ...]:
    """Return the rules for several egos, one for each share; raise ScenarioError for what cannot be together."""
    try:
        rules = file.egos.rules
    except ScenarioError as error:
        raise problem_in(path, ("egos", "names"), str(error)) from error
    if "egos" in file.model_fields_set and not rules:
        raise problem_in(path, ("egos",), "names neither a share nor a kind nor anybody")
    if rules and several(rules[0]) is None:
        raise problem_in(path, ("egos", "names"), "names one ego alone, which is the 'ego' of [scenario]")
    if rules and file.scenario.ego is not None:
        raise problem_in(path, ("scenario", "ego"), "there are several under [egos]")
    if rules and not file.expect.arrived:
        raise problem_in(path, ("expect", "arrived"), "only one ego can be expected not to arrive")
    return rules


def own_metrics_of(path: Path, keys: Sequence[str | int], asked: Mapping[int, str]) -> tuple[MetricSource, ...]:
    """Return the user's own metrics that the list at `keys` of a file names, by place in it; tell of what cannot be."""
    found: tuple[MetricSource, ...] = ()
    for place, name in asked.items():
        try:
            found = merged(found, [metric_source(name, path.parent)])
        except ScenarioError as error:
            raise problem_in(path, (*keys, place), str(error)) from error
    return found


def _own_seed(text: str) -> int:
    """Return the seed that the configuration states; SUMO itself judges a text that is no number."""
    return int(text) if text.strip().isdecimal() else DEFAULT_SEED
