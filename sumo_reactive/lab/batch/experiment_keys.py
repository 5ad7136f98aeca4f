"""The tables of an experiment `.toml`, checked key by key."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, field_validator

from sumo_reactive.driver import parameters
from sumo_reactive.driver.controller import Profile
from sumo_reactive.driver.overrides import overridden
from sumo_reactive.driver.pilot.schedule import Delays
from sumo_reactive.errors import ParameterError
from sumo_reactive.lab.metric_names import METRICS
from sumo_reactive.lab.process.driver import Driver
from sumo_reactive.lab.toml_file import nearest, problem_at
from sumo_reactive.sumo.config import OUTPUT_FILES, canonical

OURS = ("seed", "step-length")
"""SUMO options that the experiment names in keys of their own."""

_Seed = Annotated[int, Field(ge=0, le=2**31 - 1)]
_Driver = Annotated[Driver, Field(strict=False)]
Word = str | int | float | bool


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True)


class ExperimentKeys(_Strict):
    """The table `[experiment]`."""

    scenarios: list[str] = Field(min_length=1)
    seeds: list[_Seed] | None = Field(default=None, min_length=1)
    drivers: list[_Driver] = Field(default=[Driver.REACTIVE, Driver.SUMO], min_length=1)
    metrics: list[str] = ["arrived", "collisions", "violations", "duration_s", "time_loss_s"]
    store: str | None = None
    step_length_s: float | None = Field(default=None, gt=0.0, le=1.0)
    until_s: float | None = Field(default=None, gt=0.0)
    horizon_s: float | None = Field(default=None, gt=0.0)
    profile: Profile | None = Field(default=None, strict=False)
    delays: Delays | None = Field(default=None, strict=False)
    wall_limit_s: float = Field(default=600.0, gt=0.0)
    retries: int = Field(default=1, ge=0)

    @field_validator("metrics")
    @classmethod
    def _known(cls, metrics: list[str]) -> list[str]:
        for k, name in enumerate(metrics):
            if name not in METRICS:
                raise problem_at(k, f"unknown metric '{name}'{nearest(name, METRICS)}")
        return metrics

    @field_validator("scenarios", "seeds", "drivers", "metrics")
    @classmethod
    def _differ(cls, values: list[Any] | None) -> list[Any] | None:
        for k, value in enumerate(values or ()):
            if values and value in values[:k]:
                raise problem_at(k, "named twice")
        return values


class EgoKeys(_Strict):
    """The table `[egos]`: ids, for every scenario or by scenario, or how many trips to draw."""

    names: list[str] | dict[str, list[str]] | None = Field(default=None)
    drawn: int | None = Field(default=None, ge=1)
    seed: _Seed = 0
    min_length_m: float = Field(default=0.0, ge=0.0)
    warm_up_s: float = Field(default=0.0, ge=0.0)


class SampleKeys(_Strict):
    """The table `[samples]`: `count` points drawn evenly from the ranges [low, high] of `parameters`."""

    count: int = Field(ge=1)
    seed: _Seed = 0
    parameters: dict[str, list[float]] = Field(min_length=1)

    @field_validator("parameters")
    @classmethod
    def _ranges(cls, asked: dict[str, list[float]]) -> dict[str, list[float]]:
        for name, limits in asked.items():
            if len(limits) != 2 or limits[0] >= limits[1]:
                raise problem_at(name, "not a range [low, high]")
            _values(name, limits)
        return asked


class ExperimentFile(_Strict):
    """All tables: values of `parameters` and `options` that are lists make a grid."""

    experiment: ExperimentKeys
    egos: EgoKeys = Field(default_factory=EgoKeys)
    parameters: dict[str, float | list[float]] = Field(default_factory=dict)
    samples: SampleKeys | None = None
    options: dict[str, Word | list[Word]] = Field(default_factory=dict)

    @field_validator("parameters")
    @classmethod
    def _exist(cls, asked: dict[str, float | list[float]]) -> dict[str, float | list[float]]:
        return {name: _values(name, value if isinstance(value, list) else [value]) for name, value in asked.items()}

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


def _values(name: str, values: list[float]) -> list[float]:
    try:
        found = [overridden(vars(parameters), name, value) for value in values]
    except ParameterError as error:
        raise problem_at(name, str(error)) from error
    if not found:
        raise problem_at(name, "no value")
    return found
