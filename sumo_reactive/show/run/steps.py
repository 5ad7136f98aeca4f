"""The steps of a recorded run as columns, and what a picture is made from: bands, places, faults."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Any, NamedTuple

from sumo_reactive.driver.nouns.decision import Behaviour
from sumo_reactive.lab.result import Collision, Fault, HardBrake, Violation
from sumo_reactive.show.recording import Recording, columns_of

NEEDED = (
    "time_s", "x_m", "y_m", "speed_m_s", "lane_id", "s_m", "desired_speed_m_s", "stop_m", "u", "u1", "u2", "u3", "leader",
    "gap_m", "behaviour", "emergency",
)  # fmt: skip


DECIMALS = 4
"""Enough for a picture; the record has the rest."""

_KINDS: dict[str, type[Fault]] = {"collisions": Collision, "violations": Violation, "hard_brakes": HardBrake}


@dataclass(frozen=True)
class Steps:
    """The columns `NEEDED` of a trajectory, a value a step, None where there is none."""

    columns: Mapping[str, list[Any]]

    def __getitem__(self, name: str) -> list[Any]:
        return self.columns[name]

    @property
    def times(self) -> list[float]:
        """Simulation time of each step, s."""
        return self.columns["time_s"]

    def index_at(self, time: float) -> int:
        """Return the index of the step nearest to a time (s)."""
        return min(range(len(self.times)), key=lambda k: abs(self.times[k] - time))

    def difference(self, first: str, second: str) -> list[float | None]:
        """Return one column less another, None where one of them has no value."""
        pairs = zip(self[first], self[second], strict=True)
        return [None if a is None or b is None else round(a - b, DECIMALS) for a, b in pairs]


class Band(NamedTuple):
    """From step `first` up to and with step `last` the ego showed one behaviour, from `start` to `end` (s)."""

    behaviour: Behaviour
    first: int
    last: int
    start: float
    end: float


def read_steps(recording: Recording) -> Steps:
    """Read the trajectory of a run; raise ScenarioError for one that lacks a column or a step."""
    return Steps({name: [_rounded(one) for one in column] for name, column in columns_of(recording, NEEDED).items()})


def bands_of(steps: Steps) -> list[Band]:
    """Return the behaviours one after another; each ends where the next begins."""
    found = []
    for name, indices in groupby(range(len(steps.times)), key=steps["behaviour"].__getitem__):
        inside = list(indices)
        last = min(inside[-1] + 1, len(steps.times) - 1)
        found.append(Band(Behaviour(name), inside[0], last, steps.times[inside[0]], steps.times[last]))
    return found


def faults_in(summary: Mapping[str, Any]) -> list[Fault]:
    """Return what the ego did to others and against rules, in order of time."""
    found: list[Fault] = []
    for name, kind in _KINDS.items():
        found += (kind(**{key.removesuffix("_s"): value for key, value in one.items()}) for one in _list(summary, name))
    return sorted(found, key=lambda fault: fault.time)


def edges_of(lane_ids: Iterable[str]) -> list[str]:
    """Return the normal edges that the ego was on, in order; lanes inside junctions begin with a colon."""
    edges = (lane.rpartition("_")[0] for lane in lane_ids if lane and not lane.startswith(":"))
    return [edge for edge, _ in groupby(edges)]


def _list(summary: Mapping[str, Any], name: str) -> Sequence[Mapping[str, Any]]:
    found: Sequence[Mapping[str, Any]] = summary.get(name, ())
    return found


def _rounded(value: object) -> object:
    return round(value, DECIMALS) if isinstance(value, float) else value
