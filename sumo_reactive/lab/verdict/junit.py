"""JUnit XML: the verdicts in the form that CI systems read."""

from __future__ import annotations

import re
from collections.abc import Iterable
from itertools import groupby
from pathlib import Path

from junitparser import Error, Failure, JUnitXml, TestCase, TestSuite

from sumo_reactive.lab.process.task import Ending
from sumo_reactive.lab.verdict.check import Verdict
from sumo_reactive.writing import whole_file

Told = tuple[Verdict, str]
"""A verdict, and all that is told about it (empty: it was met)."""

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
    case = TestCase(f"seed {scenario.seed}", ".".join(source.relative_to(source.anchor).parts), verdict.outcome.wall_s)
    if not verdict.is_met:
        message = _NO_XML.sub("", "; ".join(verdict.reasons))
        problem = Failure(message, "unmet") if ending is Ending.DONE else Error(message, ending.value)
        problem.text = _NO_XML.sub("", text)
        case.result = [problem]
    return case
