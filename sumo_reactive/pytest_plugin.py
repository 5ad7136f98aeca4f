"""Scenario files as pytest items, one a seed: `pytest scenarios/` runs what `sumo-reactive check scenarios/` runs.

Every pytest process of this environment loads this file, so it imports nothing heavy before it meets a scenario.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from sumo_reactive.lab.check import Case
    from sumo_reactive.lab.runner import Runner

TIME_LIMIT = "scenario_time_limit"
_RUNNER = pytest.StashKey["Runner"]()


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the setting for the time that a scenario may take."""
    parser.addini(TIME_LIMIT, "wall-clock time that a scenario of sumo-reactive may take, s", default="600")


def pytest_configure(config: pytest.Config) -> None:
    """Refuse a setting that is no time."""
    try:
        float(config.getini(TIME_LIMIT))
    except ValueError as error:
        raise pytest.UsageError(f"{TIME_LIMIT}: {config.getini(TIME_LIMIT)!r} is not a number of seconds") from error


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> ScenarioCollector | None:
    """Collect a `.toml` that has a table `[scenario]`; leave all others alone."""
    from sumo_reactive.lab.discovery import is_scenario_file

    return ScenarioCollector.from_parent(parent, path=file_path) if is_scenario_file(file_path) else None


def pytest_unconfigure(config: pytest.Config) -> None:
    """End the process that ran the scenarios."""
    if _RUNNER in config.stash:
        config.stash[_RUNNER].close()
        del config.stash[_RUNNER]


class UnmetExpectationError(Exception):
    """A scenario's expectation was not met; its text tells everything."""


class ScenarioCollector(pytest.File):
    """A scenario file."""

    def collect(self) -> Iterator[ScenarioItem]:
        """Yield an item a seed; a file that cannot be run is an error of one line."""
        from sumo_reactive.errors import ReactiveError
        from sumo_reactive.lab.check import cases_of

        try:
            cases = cases_of(self.path)
        except ReactiveError as error:
            raise self.CollectError(str(error)) from error
        shown = _as_typed(self.path, self.config.invocation_params.dir)
        for case in cases:
            named = replace(case, scenario=replace(case.scenario, source=shown))
            yield ScenarioItem.from_parent(self, name=case.label, case=named)


class ScenarioItem(pytest.Item):
    """A scenario with one of its seeds, run in the one child process that this pytest process keeps."""

    def __init__(self, *, case: Case, **others: Any) -> None:
        super().__init__(**others)
        self._case = case

    def runtest(self) -> None:
        """Run the scenario and compare with what is expected."""
        from sumo_reactive.lab.check import verdict_on
        from sumo_reactive.show.faults import failure_told

        limit = float(self.config.getini(TIME_LIMIT))
        verdict = verdict_on(self._case, _runner(self.config).run(self._case.task, limit))
        if not verdict.is_met:
            raise UnmetExpectationError("\n".join(failure_told(verdict)))

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: Any = None) -> Any:
        """Return what failed and the decisions around it, not a stack."""
        if isinstance(excinfo.value, UnmetExpectationError):
            return str(excinfo.value)
        return super().repr_failure(excinfo, style)

    def reportinfo(self) -> tuple[Path, None, str]:
        """Return the file and the name that a report shows."""
        return self.path, None, f"{self.path.stem}, {self.name}"


def _runner(config: pytest.Config) -> Runner:
    if _RUNNER not in config.stash:
        from sumo_reactive.lab.runner import Runner

        config.stash[_RUNNER] = Runner()
    return config.stash[_RUNNER]


def _as_typed(path: Path, here: Path) -> Path:
    """Return a path as short as it can be typed in the folder `here`, for the command that replays a scenario."""
    return path.relative_to(here) if path.is_relative_to(here) else path
