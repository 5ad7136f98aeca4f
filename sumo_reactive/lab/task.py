"""What is asked of a process that runs trials, what comes back, and the command that runs a trial again."""

from __future__ import annotations

import json
import shlex
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from pathlib import Path
from typing import Any

from sumo_reactive.driver.parameters import Delays, Profile
from sumo_reactive.errors import ScenarioError
from sumo_reactive.lab.drivers.choice import REACTIVE, DriverChoice, chosen_driver
from sumo_reactive.lab.ego_rule import EgoRule, region_of, region_text, several
from sumo_reactive.lab.fundamental_diagram import EVERY_CLASS, CountedEdges
from sumo_reactive.lab.result import NetworkResult, TrialResult
from sumo_reactive.lab.scenario import Scenario, load_scenario
from sumo_reactive.lab.trace import Entry
from sumo_reactive.sumo.config import OBSTACLE_POLYGONS

SHARE = "share"
"""What a share of egos is called among the values that vary from trial to trial."""


_RUN = "sumo-reactive", "run"

_FIELDS: Mapping[str, tuple[str, Callable[[str], Any]]] = {
    "--ego": ("ego", str), "--seed": ("seed", int), "--step-length": ("step_length_s", float),
    "--until": ("until_s", float), "--horizon": ("horizon_s", float), "--until-end": ("until_end", bool),
    "--obstacle-polygons": ("obstacle_polygons", str), "--profile": ("profile", Profile), "--delays": ("delays", Delays),
}  # fmt: skip
"""Options that stand for a field of a scenario: its name, and what reads the option's text."""

_OF_RULE = "--ego-type", "--ego-class", "--ego-region", "--ego-probability"
_MORE = "--parameter", "--driver", "--driver-option", *_OF_RULE


@dataclass(frozen=True)
class Task:
    """One trial: a scenario with one ego, or with those that its rule chooses, drawn by id and seed, and then with what is
    `counted` of the network."""

    scenario: Scenario
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
    the trial alone. Where a rule chose the egos, `network` stands in place of a `result`.
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
    words = [*_RUN, str(scenario.source), *rule_words(scenario.egos), *_options(scenario)]
    if scenario.sumo_options:
        words += ["--", *scenario.sumo_options]
    return shlex.join(words)


def task_of(command: str) -> Task:
    """Return what a command written by `replay_command` runs: with the same files the same task, but for what is `counted`.

    Raises ScenarioError for another command, and what reading the scenario raises.
    """
    try:
        program, verb, source, *words = shlex.split(command)
        if (program, verb) != _RUN:
            raise ValueError(program)
        end = words.index("--") if "--" in words else len(words)
        given = _given(words[:end])
        fields = {key: read(given[option][-1]) for option, (key, read) in _FIELDS.items() if option in given}
        varied = {name: float(value) for name, value in map(_halves, given.get("--parameter", ()))}
        rule = several(_rule_in(given))
        options = {name: json.loads(value) for name, value in map(_halves, given.get("--driver-option", ()))}
    except ValueError as error:
        raise ScenarioError(f"not the command of a run: {command}") from error
    scenario = load_scenario(Path(source))
    fields["driver"] = chosen_driver(given["--driver"][-1], options, Path.cwd()) if "--driver" in given else REACTIVE
    parameters, sumo_options = scenario.parameters.with_values(varied), tuple(words[end + 1 :])
    fields |= {"egos": rule} | ({"ego": None} if rule else {})
    return Task(replace(scenario, parameters=parameters, sumo_options=sumo_options, **fields))


def _rule_in(given: Mapping[str, Sequence[str]]) -> EgoRule:
    """Return the rule that options say; raise ValueError for what is no number."""
    types, classes, region, share = (given.get(option, ()) for option in _OF_RULE)
    corners = region_of([float(one) for one in region[-1].split(",")]) if region else None
    return EgoRule(
        ids=tuple(given.get("--ego", ())), types=tuple(types), classes=tuple(classes), region=corners,
        share=float(share[-1]) if share else None,
    )  # fmt: skip


def rule_words(rule: EgoRule | None) -> list[str]:
    """Return the options of the command line that say a rule."""
    if rule is None:
        return []
    corners = [] if rule.region is None else [region_text(rule.region)]
    share = [] if rule.share is None else [_digits(rule.share)]
    named = ("--ego", rule.ids), *zip(_OF_RULE, (rule.types, rule.classes, corners, share), strict=True)
    return [word for option, values in named for value in values for word in (option, value)]


def _given(words: Sequence[str]) -> dict[str, list[str]]:
    """Return the values of each option; raise ValueError for what is none of those that `replay_command` writes."""
    given: dict[str, list[str]] = {}
    rest = iter(words)
    for option in rest:
        if option not in _FIELDS and option not in _MORE:
            raise ValueError(option)
        value = option if option == "--until-end" else next(rest, None)
        if value is None:
            raise ValueError(option)
        given.setdefault(option, []).append(value)
    return given


def _halves(text: str) -> tuple[str, str]:
    name, _, value = text.partition("=")
    return name, value


def driver_words(driver: DriverChoice) -> list[str]:
    """Return the options of the command line that name a driver; none for this project's."""
    if driver == REACTIVE:
        return []
    told = [f"{name}={json.dumps(value)}" for name, value in driver.options]
    return ["--driver", driver.name, *(word for one in told for word in ("--driver-option", one))]


def _options(scenario: Scenario) -> list[str]:
    words = ["--ego", scenario.ego] if scenario.ego is not None else []
    words += ["--seed", str(scenario.seed), *_ends(scenario)]
    if scenario.obstacle_polygons != OBSTACLE_POLYGONS:
        words += ["--obstacle-polygons", scenario.obstacle_polygons]
    for name, value in scenario.parameters.varied.items():
        words += ["--parameter", f"{name}={value!r}"]
    if scenario.driver != REACTIVE:
        return [*words, *driver_words(scenario.driver)]
    return [*words, "--profile", scenario.profile.value, "--delays", scenario.delays.value]


def _ends(scenario: Scenario) -> Iterator[str]:
    """Yield the options about time."""
    named = {"step-length": scenario.step_length_s, "until": scenario.until_s, "horizon": scenario.horizon_s}
    for name, value in named.items():
        if value is not None:
            yield from (f"--{name}", _digits(value))
    if scenario.until_end:
        yield "--until-end"


def _digits(value: float) -> str:
    """Return a number with all its digits, and no more."""
    return f"{value:g}" if float(f"{value:g}") == value else repr(value)
