"""Scenario files as tests: the cases that they hold, one a seed, the verdict on each, and JUnit XML of all."""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import groupby, product
from pathlib import Path

from junitparser import Error, Failure, JUnitXml, TestCase, TestSuite

from sumo_reactive.lab.drivers.choice import REACTIVE, DriverChoice
from sumo_reactive.lab.fault import COLLISION, FAULT_MEANINGS, HARD_BRAKING
from sumo_reactive.lab.result import NetworkResult, TrialResult
from sumo_reactive.lab.runner import Runner, run_all
from sumo_reactive.lab.scenario import Expectation, Limit, Scenario, load_scenario_file
from sumo_reactive.lab.task import Ending, Outcome, Task, driver_words, rule_words
from sumo_reactive.writing import whole_file


@dataclass(frozen=True)
class Case:
    """One scenario with one seed and, if it has several egos, one rule for them, and what is expected of it."""

    scenario: Scenario
    expectation: Expectation

    @property
    def name(self) -> str:
        """The file and the label."""
        return f"{self.scenario.source} {self.label}"

    @property
    def label(self) -> str:
        """The seed, who is an ego where that is a rule, and the driver if it is another than this project's."""
        scenario = self.scenario
        driver = "" if scenario.driver == REACTIVE else f" driver {scenario.driver}"
        return f"seed {scenario.seed}{f' {scenario.egos}' if scenario.egos else ''}{driver}"

    @property
    def replay(self) -> str:
        """The command that runs the same trial again."""
        words = ("sumo-reactive", "run", str(self.scenario.source), "--seed", str(self.scenario.seed))
        return shlex.join((*words, *rule_words(self.scenario.egos), *driver_words(self.scenario.driver)))

    @property
    def task(self) -> Task:
        """What a process has to do for it."""
        return Task(self.scenario)


@dataclass(frozen=True)
class Verdict:
    """What became of a case: why it was not met, line by line (empty: it was met); `record`: the folder that it is recorded
    in, as is the page of it (None: nowhere)."""

    case: Case
    outcome: Outcome
    reasons: tuple[str, ...]
    record: Path | None = None

    @property
    def is_met(self) -> bool:
        """Whether everything that was expected came."""
        return not self.reasons


def cases_of(file: Path, drivers: Sequence[DriverChoice] = (), seeds: Sequence[int] = ()) -> list[Case]:
    """Return the cases of a scenario file, one for each of `seeds` and each of `drivers` (none: its own) and each rule for
    its egos; raise ScenarioError for what cannot be run."""
    read = load_scenario_file(file)
    found, numbers = drivers or (read.scenario.driver,), seeds or read.seeds
    for driver in found:
        if driver.is_users:
            from sumo_reactive.lab.drivers.loading import require_driver

            require_driver(driver)
    varied = product(found, read.variants, numbers)
    scenarios = [replace(read.scenario, seed=seed, driver=driver, egos=rule) for driver, rule, seed in varied]
    return [Case(scenario, read.expectation) for scenario in scenarios]


def run_cases(cases: Sequence[Case], jobs: int, wall_limit_s: float) -> Iterator[Verdict]:
    """Run the cases in `jobs` processes and yield the verdicts in their order."""
    outcomes = run_all([case.task for case in cases], jobs, wall_limit_s)
    return (verdict_on(case, outcome) for case, outcome in zip(cases, outcomes, strict=True))


def verdict_on(case: Case, outcome: Outcome) -> Verdict:
    """Judge what became of a case."""
    if outcome.ending is Ending.DONE and outcome.result is not None:
        return Verdict(case, outcome, tuple(unmet(case.expectation, outcome.result)))
    if outcome.ending is Ending.DONE and outcome.network is not None:
        return Verdict(case, outcome, tuple(unmet_by_several(case.expectation, outcome.network)))
    return Verdict(case, outcome, (f"{outcome.ending.value}: {outcome.reason}",))


def recorded(verdict: Verdict, folder: Path, wall_limit_s: float) -> Verdict:
    """Drive a case that came to its end again, which is the same trip, and record it in `folder`, in place of what is
    recorded there; return the verdict with the folder, or with one reason more if that cannot be done."""
    if verdict.outcome.ending is not Ending.DONE:
        return verdict
    with Runner() as runner:
        record = _RECORD if verdict.case.scenario.egos is None else _RECORD_FLEET
        ending, why, _ = runner.call(record, (verdict.case.task, folder), wall_limit_s)
    if ending is Ending.DONE:
        return replace(verdict, record=folder)
    return replace(verdict, reasons=(*verdict.reasons, f"not recorded: {why}"))


def blamed(verdict: Verdict) -> list[Path]:
    """Return the folders, in that of a recorded case of several egos, of those that are to blame for something."""
    from sumo_reactive.lab.recorder import read_fleet

    network = verdict.outcome.network
    if verdict.record is None or network is None:
        return []
    names = {ego for ego, fault in network.by_ego if fault.kind != HARD_BRAKING} | {ego for ego, _ in network.stranded}
    return [verdict.record / one.folder for one in read_fleet(verdict.record).egos if one.ego in names]


Told = tuple[Verdict, str]
"""A verdict, and all that is told about it (empty: it was met)."""

_RECORD = "sumo_reactive.lab.simulation:run_recorded"
_RECORD_FLEET = "sumo_reactive.lab.penetration:record_fleet"

_TOLD = 3
"""So many of the egos that are to blame are named."""

_NO_XML = re.compile("[^\t\n\r -\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""What XML cannot hold, such as the colours of a terminal."""


def write_junit(path: Path, verdicts: Iterable[Told]) -> None:
    """Write a suite a scenario file and a case a seed: what was not met is a failure, what did not end an error.

    Raises OutputError if that cannot be done.
    """
    report = JUnitXml("sumo-reactive check")
    for source, group in groupby(verdicts, key=lambda told: told[0].case.scenario.source):
        suite = TestSuite(str(source))
        for verdict, text in group:
            suite.add_testcase(_case(verdict, text))
        report.add_testsuite(suite)
    with whole_file(path) as partial:
        report.write(str(partial), pretty=True)


def _case(verdict: Verdict, text: str) -> TestCase:
    scenario, ending = verdict.case.scenario, verdict.outcome.ending
    source = scenario.source.with_suffix("")
    case = TestCase(verdict.case.label, ".".join(source.relative_to(source.anchor).parts), verdict.outcome.wall_s)
    if not verdict.is_met:
        message = _NO_XML.sub("", "; ".join(verdict.reasons))
        problem = Failure(message, "unmet") if ending is Ending.DONE else Error(message, ending.value)
        problem.text = _NO_XML.sub("", text)
        case.result = [problem]
    if verdict.record is not None:
        from sumo_reactive.lab.recorder import FLEET, PAGE, SUMMARY

        attached = (verdict.record / name for name in (PAGE, SUMMARY if scenario.egos is None else FLEET))
        case.system_out = _NO_XML.sub("", "\n".join(f"[[ATTACHMENT|{path}]]" for path in attached))
    return case


def unmet(expectation: Expectation, result: TrialResult) -> Iterator[str]:
    """Yield a readable reason for everything that was expected of the one ego and did not come."""
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
    yield from map(str, result.metric_failures)
    yield from _out_of_limits(expectation, result.metrics)


def unmet_by_several(expectation: Expectation, network: NetworkResult) -> Iterator[str]:
    """Yield a readable reason for everything that was expected of several egos together and did not come."""
    if expectation.arrived and network.stranded:
        told = [f"{ego} did not arrive ({ended})" for ego, ended in network.stranded]
        yield _first(told)
    for name, of_kind in (("collisions", {COLLISION}), ("violations", set(FAULT_MEANINGS) - {COLLISION, HARD_BRAKING})):
        found, allowed = int(network.metrics[f"egos_{name}"] or 0), getattr(expectation, name)
        if found > allowed:
            told = [f"{ego}: {fault}" for ego, fault in network.by_ego if fault.kind in of_kind]
            yield f"{found} {name}, expected at most {allowed}: {_first(told)}"
    yield from _out_of_limits(expectation, network.metrics)


def _first(told: Sequence[str]) -> str:
    more = [f"… and {len(told) - _TOLD} more"] if len(told) > _TOLD else []
    return ", ".join((*told[:_TOLD], *more))


def _out_of_limits(expectation: Expectation, metrics: Mapping[str, float | None]) -> Iterator[str]:
    for name, limit in expectation.metrics.items():
        yield from _outside(name, metrics.get(name), limit)


def _outside(name: str, value: float | None, limit: Limit) -> Iterator[str]:
    """Yield what is wrong with a metric; a value that is missing lies beyond every measure (nobody ever came near)."""
    if limit.max is not None and (value is None or value > limit.max):
        yield f"{name} is {'none' if value is None else f'{value:g}'}, expected at most {limit.max:g}"
    if limit.min is not None and value is not None and value < limit.min:
        yield f"{name} is {value:g}, expected at least {limit.min:g}"
