"""The key of a trial: a digest of everything that its numbers depend on, and of nothing else."""

from __future__ import annotations

import hashlib
import json
from functools import cache
from pathlib import Path

from sumo_reactive.experiment.process.task import Task
from sumo_reactive.experiment.scenario import Scenario
from sumo_reactive.experiment.trial import versions
from sumo_reactive.sumo.config import read_config
from sumo_reactive.sumo.option_names import INPUT_FILES, OUTPUT_FILES

_ROOMS_APART = ("cli", "report")
"""Rooms that no number depends on."""


def key_of(task: Task) -> str:
    """Return the key of a task; raise what reading its scenario raises."""
    scenario = task.scenario
    parts = {
        "files": digest_of_files(scenario.config),
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
    files, options = digest_of_files(scenario.config), scenario.sumo_options
    parts = (files, scenario.seed, scenario.step_length_s, scenario.until_s, options, release()["sumo"])
    return hashlib.sha256(json.dumps(parts).encode()).hexdigest()


@cache
def digest_of_files(config_file: Path) -> str:
    """Return a digest of what a configuration says and of the contents of the files it reads, whatever their names."""
    config = read_config(config_file)
    digest = hashlib.sha256()
    for name, value in sorted(config.options.items()):
        if name not in INPUT_FILES and name not in OUTPUT_FILES:
            digest.update(f"{name}={value}\n".encode())
    for name in sorted(INPUT_FILES & set(config.options)):
        digest.update(f"{name}\n".encode())
        for part in config.options[name].split(","):
            file = config_file.absolute().parent / part.strip()
            digest.update(hashlib.sha256(file.read_bytes() if file.is_file() else part.encode()).digest())
    return digest.hexdigest()


@cache
def release() -> dict[str, str]:
    """Return the versions that numbers depend on, and a digest of this package's sources."""
    package = Path(__file__).parents[1]
    digest = hashlib.sha256()
    for source in sorted(package.rglob("*.py")):
        name = source.relative_to(package)
        if name.parts[0] not in _ROOMS_APART:
            digest.update(f"{name.as_posix()}\n".encode() + source.read_bytes())
    return {**versions(), "sources": digest.hexdigest()[:16]}
