"""The key of a trial: a digest of everything that its numbers depend on, and of nothing else."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Sequence
from functools import cache
from pathlib import Path

import sumo_reactive
from sumo_reactive.errors import ScenarioError
from sumo_reactive.lab.process.task import Task
from sumo_reactive.lab.scenario import Scenario
from sumo_reactive.lab.trial import versions
from sumo_reactive.sumo.config import INPUT_FILES, OUTPUT_FILES, read_config
from sumo_reactive.sumo.input_files import inputs_of, words_of

_ROOMS_APART = ("cli", "show")
"""Rooms that no number depends on."""


def key_of(task: Task) -> str:
    """Return the key of a task; raise what reading its scenario raises."""
    scenario = task.scenario
    parts = {
        "files": digest_of_files(scenario.config, scenario.sumo_options),
        "ego": scenario.ego,
        "seed": scenario.seed,
        "step_length_s": scenario.step_length_s,
        "until_s": scenario.until_s,
        "horizon_s": scenario.horizon_s,
        "until_end": scenario.until_end,
        "profile": scenario.profile.value,
        "delays": scenario.delays.value,
        "obstacle_polygons": scenario.obstacle_polygons,
        "sumo_options": scenario.sumo_options,
        "driver": task.driver.value,
        "parameters": dict(task.parameters),
        "versions": release(),
    }
    return hashlib.sha256(json.dumps(parts, sort_keys=True).encode()).hexdigest()


def key_of_scouting(scenario: Scenario) -> str:
    """Return the key of a scenario under SUMO's own drivers alone: which trips there are to draw from."""
    files, options = digest_of_files(scenario.config, scenario.sumo_options), scenario.sumo_options
    parts = (files, scenario.seed, scenario.step_length_s, scenario.until_s, options, release()["sumo"])
    return hashlib.sha256(json.dumps(parts).encode()).hexdigest()


def digest_of_files(config_file: Path, sumo_options: Sequence[str] = ()) -> str:
    """Return a digest of what a configuration says, of all files that SUMO reads for it, and of the variables in them.

    Contents count, names do not. Raises ScenarioError for a file that cannot be read. Each file is read once a process.
    """
    return _digest_of_files(config_file, words_of(sumo_options))


@cache
def _digest_of_files(config_file: Path, words: tuple[str, ...]) -> str:
    config = read_config(config_file)
    try:
        inputs = inputs_of(config_file, words)
    except OSError as error:
        raise ScenarioError(f"{error.filename or config_file}: cannot be read: {error.strerror}") from error
    said = {name: value for name, value in config.options.items() if name not in INPUT_FILES and name not in OUTPUT_FILES}
    asked = sorted(INPUT_FILES & set(config.options))
    variables = {name: os.environ.get(name) for name in inputs.variables}
    parts = (said, asked, len(inputs.files), inputs.digest, variables)
    return hashlib.sha256(json.dumps(parts, sort_keys=True).encode()).hexdigest()


@cache
def release() -> dict[str, str]:
    """Return the versions that numbers depend on, and a digest of this package's sources."""
    package = Path(sumo_reactive.__file__).parent
    digest = hashlib.sha256()
    for source in sorted(package.rglob("*.py")):
        name = source.relative_to(package)
        if name.parts[0] not in _ROOMS_APART:
            digest.update(f"{name.as_posix()}\n".encode() + source.read_bytes())
    return {**versions(), "sources": digest.hexdigest()[:16]}
