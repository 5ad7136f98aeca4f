"""Scenario files as tests: the cases that they hold, one a seed, and the verdict on each."""

from __future__ import annotations

import shlex
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from sumo_reactive.driver.overrides import overrides
from sumo_reactive.lab.expectation import Expectation, unmet
from sumo_reactive.lab.process.runner import run_all
from sumo_reactive.lab.process.task import Ending, Outcome, Task
from sumo_reactive.lab.scenario import Scenario, load_scenario_file


@dataclass(frozen=True)
class Case:
    """One scenario with one seed, and what is expected of it."""

    scenario: Scenario
    expectation: Expectation

    @property
    def name(self) -> str:
        """The file and the seed."""
        return f"{self.scenario.source} seed {self.scenario.seed}"

    @property
    def replay(self) -> str:
        """The command that runs the same trial again."""
        return shlex.join(("sumo-reactive", "run", str(self.scenario.source), "--seed", str(self.scenario.seed)))

    @property
    def task(self) -> Task:
        """What a process has to do for it."""
        return Task(self.scenario, parameters={**self.scenario.parameters, **overrides()})


@dataclass(frozen=True)
class Verdict:
    """What became of a case: why it was not met, line by line (empty: it was met)."""

    case: Case
    outcome: Outcome
    reasons: tuple[str, ...]

    @property
    def is_met(self) -> bool:
        """Whether everything that was expected came."""
        return not self.reasons


def cases_of(file: Path) -> list[Case]:
    """Return the cases of a scenario file in the order of its seeds; raise ScenarioError for what cannot be run."""
    scenario, seeds, expectation = load_scenario_file(file)
    return [Case(replace(scenario, seed=seed), expectation) for seed in seeds]


def run_cases(cases: Sequence[Case], jobs: int, wall_limit_s: float) -> Iterator[Verdict]:
    """Run the cases in `jobs` processes and yield the verdicts in their order."""
    outcomes = run_all([case.task for case in cases], jobs, wall_limit_s)
    return (verdict_on(case, outcome) for case, outcome in zip(cases, outcomes, strict=True))


def verdict_on(case: Case, outcome: Outcome) -> Verdict:
    """Judge what became of a case."""
    if outcome.ending is not Ending.DONE or outcome.result is None:
        return Verdict(case, outcome, (f"{outcome.ending.value}: {outcome.reason}",))
    return Verdict(case, outcome, unmet(case.expectation, outcome.result))
