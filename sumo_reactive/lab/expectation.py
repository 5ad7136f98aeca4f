"""What a scenario file expects of its trials, and what of it a trial did not meet."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

from pydantic import BaseModel, ConfigDict, Field, field_validator, model_validator

from sumo_reactive.lab.metric_names import METRICS
from sumo_reactive.lab.result import TrialResult
from sumo_reactive.lab.toml_file import nearest, problem_at


class Limit(NamedTuple):
    """A metric's smallest and largest value that is accepted; None: no such bound."""

    min: float | None = None
    max: float | None = None


@dataclass(frozen=True)
class Expectation:
    """Whether the ego `arrived`, how many `collisions` and `violations` it has at most, and limits of metrics by name."""

    arrived: bool = True
    collisions: int = 0
    violations: int = 0
    metrics: Mapping[str, Limit] = field(default_factory=dict)


class LimitKeys(BaseModel):
    """`{ min = …, max = … }`, at least one of them."""

    model_config = ConfigDict(extra="forbid", strict=True)

    min: float | None = Field(default=None, allow_inf_nan=False)
    max: float | None = Field(default=None, allow_inf_nan=False)

    @model_validator(mode="after")
    def _says_something(self) -> LimitKeys:
        if self.min is None and self.max is None:
            raise ValueError("needs min, max or both")
        if self.min is not None and self.max is not None and self.min > self.max:
            raise ValueError(f"min {self.min:g} is above max {self.max:g}")
        return self


class ExpectKeys(BaseModel):
    """The table `[expect]`."""

    model_config = ConfigDict(extra="forbid", strict=True)

    arrived: bool = True
    collisions: int = Field(default=0, ge=0)
    violations: int = Field(default=0, ge=0)
    metrics: dict[str, LimitKeys] = Field(default_factory=dict)

    @field_validator("metrics")
    @classmethod
    def _known(cls, metrics: dict[str, LimitKeys]) -> dict[str, LimitKeys]:
        for name in metrics:
            if name not in METRICS:
                raise problem_at(name, f"unknown metric '{name}'{nearest(name, METRICS)}")
        return metrics

    def expectation(self) -> Expectation:
        """Return what the table expects."""
        limits = {name: Limit(keys.min, keys.max) for name, keys in self.metrics.items()}
        return Expectation(self.arrived, self.collisions, self.violations, limits)


def unmet(expectation: Expectation, result: TrialResult) -> tuple[str, ...]:
    """Return a readable reason for everything that was expected and did not come."""
    return tuple(_unmet(expectation, result))


def _unmet(expectation: Expectation, result: TrialResult) -> Iterator[str]:
    if expectation.arrived and not result.arrived:
        yield f"did not arrive ({result.ended})"
    if result.arrived and not expectation.arrived:
        yield f"arrived at {result.end_s:.1f} s, expected not to"
    faults = (("collisions", result.collisions), ("violations", result.violations))
    for name, found in faults:
        allowed = getattr(expectation, name)
        if len(found) > allowed:
            told = ", ".join(map(str, found))
            yield f"{told}" if allowed == 0 else f"{len(found)} {name}, expected at most {allowed}: {told}"
    metrics = result.metrics
    for name, limit in expectation.metrics.items():
        yield from _outside(name, metrics.get(name), limit)


def _outside(name: str, value: float | None, limit: Limit) -> Iterator[str]:
    """Yield what is wrong with a metric; a value that is missing lies beyond every measure (nobody ever came near)."""
    if limit.max is not None and (value is None or value > limit.max):
        yield f"{name} is {'none' if value is None else f'{value:g}'}, expected at most {limit.max:g}"
    if limit.min is not None and value is not None and value < limit.min:
        yield f"{name} is {value:g}, expected at least {limit.min:g}"
