"""What is asked of a process that runs trials, what comes back, and the command that runs a trial again."""

from __future__ import annotations

import json
import shlex
from dataclasses import dataclass
from enum import Enum

from sumo_reactive.lab.drivers.choice import REACTIVE, DriverChoice
from sumo_reactive.lab.fundamental_diagram import EVERY_CLASS, CountedEdges
from sumo_reactive.lab.result import NetworkResult, TrialResult
from sumo_reactive.lab.scenario import Scenario
from sumo_reactive.lab.trace import Entry

SHARE = "share"
"""What a share of egos is called among the values that vary from trial to trial."""


@dataclass(frozen=True)
class Task:
    """One trial: a scenario with one ego, or with a `share` of all road cars as egos, drawn by id and seed, and with what is
    `counted` of the network."""

    scenario: Scenario
    share: float | None = None
    counted: CountedEdges = EVERY_CLASS


class Ending(Enum):
    """How a trial ended."""

    DONE = "done"
    """It came to a result, whatever that is."""
    FAILED = "failed"
    """It was refused, or failed: one line tells why."""
    CRASHED = "crashed"
    """Its process died or held too much memory."""
    TIMEOUT = "timeout"
    """It took more wall-clock time than it may."""


@dataclass(frozen=True, kw_only=True)
class Outcome:
    """What became of a task. `reason` is empty when it is done; `entries` are the decisions of the reactive driver,
    `reasons` what a driver of the user's gave from when on (s).

    `trajectory` is a digest of every step but for its wall-clock time: equal trajectories, equal digests. `wall_s` counts
    the trial alone. Where a share of all cars were egos, `network` stands in place of a `result`.
    """

    task: Task
    ending: Ending
    result: TrialResult | None = None
    reason: str = ""
    entries: tuple[Entry, ...] = ()
    reasons: tuple[tuple[float, str], ...] = ()
    trajectory: str = ""
    wall_s: float = 0.0
    network: NetworkResult | None = None

    @property
    def judged(self) -> TrialResult | NetworkResult | None:
        """What the trial came to, of whichever kind; None: to nothing."""
        return self.result or self.network


def replay_command(task: Task) -> str:
    """Return the command line that repeats a task."""
    scenario = task.scenario
    share = [] if task.share is None else ["--ego-probability", f"{task.share:g}"]
    words = ["sumo-reactive", "run", str(scenario.source), *share, *_options(scenario)]
    if scenario.sumo_options:
        words += ["--", *scenario.sumo_options]
    return shlex.join(words)


def driver_words(driver: DriverChoice) -> list[str]:
    """Return the options of the command line that name a driver; none for this project's."""
    if driver == REACTIVE:
        return []
    told = [f"{name}={json.dumps(value)}" for name, value in driver.options]
    return ["--driver", driver.name, *(word for one in told for word in ("--driver-option", one))]


def _options(scenario: Scenario) -> list[str]:
    words = ["--ego", scenario.ego] if scenario.ego is not None else []
    words += ["--seed", str(scenario.seed)]
    if scenario.step_length_s is not None:
        words += ["--step-length", f"{scenario.step_length_s:g}"]
    if scenario.until_s is not None:
        words += ["--until", f"{scenario.until_s:g}"]
    for name, value in scenario.parameters.varied.items():
        words += ["--parameter", f"{name}={value!r}"]
    if scenario.driver != REACTIVE:
        return [*words, *driver_words(scenario.driver)]
    return [*words, "--profile", scenario.profile.value, "--delays", scenario.delays.value]
