"""What is asked of a process that runs trials, what comes back, and the command that runs a trial again."""

from __future__ import annotations

import shlex
from dataclasses import dataclass
from enum import Enum

from sumo_reactive.lab.drivers.choice import SUMO
from sumo_reactive.lab.result import NetworkResult, TrialResult
from sumo_reactive.lab.scenario import Scenario
from sumo_reactive.lab.trace import Entry

SHARE = "share"
"""What a share of egos is called among the values that vary from trial to trial."""


@dataclass(frozen=True)
class Task:
    """One trial: a scenario with one ego, or with a `share` of all road cars as egos, drawn by id and seed."""

    scenario: Scenario
    share: float | None = None


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
    the trial alone. Where a share of all cars were egos, `network` stands in place of a `result`.
    """

    task: Task
    ending: Ending
    result: TrialResult | None = None
    reason: str = ""
    entries: tuple[Entry, ...] = ()
    trajectory: str = ""
    wall_s: float = 0.0
    network: NetworkResult | None = None

    @property
    def judged(self) -> TrialResult | NetworkResult | None:
        """What the trial came to, of whichever kind; None: to nothing."""
        return self.result or self.network


def replay_command(task: Task) -> str:
    """Return the command line that repeats a task; for SUMO's own driver, the comparison that contains it."""
    scenario = task.scenario
    command = "compare" if scenario.driver == SUMO else "run"
    share = [] if task.share is None else ["--ego-probability", f"{task.share:g}"]
    words = ["sumo-reactive", command, str(scenario.source), *share, *_options(scenario, command == "run")]
    if scenario.sumo_options:
        words += ["--", *scenario.sumo_options]
    return shlex.join(words)


def _options(scenario: Scenario, is_run: bool) -> list[str]:
    words = ["--ego", scenario.ego] if scenario.ego is not None else []
    words += ["--seed", str(scenario.seed)]
    if scenario.step_length_s is not None:
        words += ["--step-length", f"{scenario.step_length_s:g}"]
    if scenario.until_s is not None:
        words += ["--until", f"{scenario.until_s:g}"]
    for name, value in scenario.parameters.varied.items():
        words += ["--parameter", f"{name}={value!r}"]
    return [*words, "--profile", scenario.profile.value, "--delays", scenario.delays.value] if is_run else words
