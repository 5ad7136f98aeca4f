"""JUnit XML: the verdicts in the form that CI systems read."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable
from itertools import groupby
from pathlib import Path

from junitparser import Error, Failure, JUnitXml, TestCase, TestSuite

from sumo_reactive.errors import ScenarioError
from sumo_reactive.experiment.process.task import Ending
from sumo_reactive.experiment.verdict.check import Verdict

Told = tuple[Verdict, str]
"""A verdict, and all that is told about it (empty: it was met)."""

_NO_XML = re.compile("[^\t\n\r -\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""What XML cannot hold, such as the colours of a terminal."""


def require_writable(path: Path) -> None:
    """Raise ScenarioError if no file can be written at `path`; make nothing yet."""
    if path.is_dir():
        raise ScenarioError(f"{path}: a folder, not a file for the verdicts")
    existing = next(place for place in (path, *path.absolute().parents) if place.exists())
    if not os.access(existing, os.W_OK) or (existing != path and not existing.is_dir()):
        raise ScenarioError(f"{path}: cannot be written: no file can be made in {existing}")


def write_junit(path: Path, verdicts: Iterable[Told]) -> None:
    """Write a suite a scenario file and a case a seed: what was not met is a failure, what did not end an error."""
    report = JUnitXml("sumo-reactive check")
    for source, group in groupby(verdicts, key=lambda told: told[0].case.scenario.source):
        suite = TestSuite(str(source))
        for verdict, text in group:
            suite.add_testcase(_case(verdict, text))
        report.add_testsuite(suite)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        report.write(str(path), pretty=True)
    except OSError as error:
        raise ScenarioError(f"{path}: cannot be written: {error.strerror}") from error


def _case(verdict: Verdict, text: str) -> TestCase:
    scenario, ending = verdict.case.scenario, verdict.outcome.ending
    source = scenario.source.with_suffix("")
    case = TestCase(f"seed {scenario.seed}", ".".join(source.relative_to(source.anchor).parts), verdict.outcome.wall_s)
    if not verdict.is_met:
        message = _NO_XML.sub("", "; ".join(verdict.reasons))
        problem = Failure(message, "unmet") if ending is Ending.DONE else Error(message, ending.value)
        problem.text = _NO_XML.sub("", text)
        case.result = [problem]
    return case
