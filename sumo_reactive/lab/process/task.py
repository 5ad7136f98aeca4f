"""What is asked of a process that runs trials, and what comes back: plain values that travel between processes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum

from sumo_reactive.lab.process.driver import Driver
from sumo_reactive.lab.result import TrialResult
from sumo_reactive.lab.scenario import Scenario
from sumo_reactive.lab.trace import Entry


@dataclass(frozen=True)
class Task:
    """One trial: a scenario, who drives, and other values for constants of `parameters.py`."""

    scenario: Scenario
    driver: Driver = Driver.REACTIVE
    parameters: Mapping[str, float] = field(default_factory=dict)


class Ending(Enum):
    """How a trial ended: judged, refused or failed in one line, by a crash, or over its limit of wall-clock time."""

    DONE = "done"
    FAILED = "failed"
    CRASHED = "crashed"
    TIMEOUT = "timeout"


@dataclass(frozen=True)
class Outcome:
    """What became of a task. `reason` is empty when it is done; `entries` are the decisions of the reactive driver.

    `trajectory` is a digest of every step but for its wall-clock time: equal trajectories, equal digests. `wall_s` counts
    the trial alone.
    """

    task: Task
    ending: Ending
    result: TrialResult | None = None
    reason: str = ""
    entries: tuple[Entry, ...] = ()
    trajectory: str = ""
    wall_s: float = 0.0
