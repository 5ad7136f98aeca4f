"""The command that runs a trial again."""

from __future__ import annotations

import json
import shlex

from sumo_reactive.driver.overrides import VARIABLE
from sumo_reactive.lab.process.driver import Driver
from sumo_reactive.lab.process.task import Task
from sumo_reactive.lab.scenario import Scenario


def replay_command(task: Task) -> str:
    """Return the command line that repeats a task; for SUMO's own driver, the comparison that contains it."""
    scenario = task.scenario
    command = "run" if task.driver is Driver.REACTIVE else "compare"
    words = ["sumo-reactive", command, str(scenario.source), *_options(scenario, command == "run")]
    if scenario.sumo_options:
        words += ["--", *scenario.sumo_options]
    asked = f"{VARIABLE}={shlex.quote(json.dumps(dict(task.parameters), sort_keys=True))} " if task.parameters else ""
    return asked + shlex.join(words)


def _options(scenario: Scenario, is_run: bool) -> list[str]:
    words = ["--ego", scenario.ego] if scenario.ego is not None else []
    words += ["--seed", str(scenario.seed)]
    if scenario.step_length_s is not None:
        words += ["--step-length", f"{scenario.step_length_s:g}"]
    if scenario.until_s is not None:
        words += ["--until", f"{scenario.until_s:g}"]
    return [*words, "--profile", scenario.profile.value, "--delays", scenario.delays.value] if is_run else words
