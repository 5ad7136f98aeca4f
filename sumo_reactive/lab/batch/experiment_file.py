"""The experiment `.toml`: which scenarios, egos, seeds, parameters, options and drivers make up the trials."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from sumo_reactive.errors import ReactiveError, ScenarioError
from sumo_reactive.files import text_of
from sumo_reactive.lab.batch.experiment_keys import EgoKeys, ExperimentFile, ExperimentKeys, SampleKeys, Word
from sumo_reactive.lab.scenario import Scenario, load_scenario, load_scenario_file
from sumo_reactive.lab.toml_file import line_of, nearest, read_toml

SUFFIX = ".duckdb"


class Choice(NamedTuple):
    """A scenario of an experiment: as the file names it, as loaded, the egos named for it (empty: none), its seeds."""

    name: str
    scenario: Scenario
    egos: tuple[str, ...]
    seeds: tuple[int, ...]


@dataclass(frozen=True)
class Experiment:
    """An experiment file as read; a path in it is relative to it."""

    path: Path
    store: Path
    keys: ExperimentKeys
    choices: tuple[Choice, ...]
    egos: EgoKeys
    grid: dict[str, list[float]]
    samples: SampleKeys | None
    options: dict[str, list[Word]]

    def problem(self, keys: tuple[str | int, ...], message: str) -> ScenarioError:
        """Return the error that names the line of a key."""
        return _problem(self.path, keys, message)


def load_experiment(path: Path) -> Experiment:
    """Read an experiment file; raise ScenarioError naming file, line and key of what cannot be run."""
    file = read_toml(path, ExperimentFile)
    keys = file.experiment
    _check_egos(path, file)
    choices = tuple(_choice(path, file, k, name) for k, name in enumerate(keys.scenarios))
    store = Path(os.path.normpath(path.parent / keys.store)) if keys.store else path.with_suffix(SUFFIX)
    grid = {name: value if isinstance(value, list) else [value] for name, value in file.parameters.items()}
    options = {name: value if isinstance(value, list) else [value] for name, value in file.options.items()}
    return Experiment(path, store, keys, choices, file.egos, grid, file.samples, options)


def _check_egos(path: Path, file: ExperimentFile) -> None:
    egos = file.egos
    if egos.names is not None and egos.drawn is not None:
        raise _problem(path, ("egos", "drawn"), "there are 'names' already")
    if egos.names is not None and not egos.names:
        raise _problem(path, ("egos", "names"), "names nobody: no trial is left")
    for name, ids in (egos.names if isinstance(egos.names, dict) else {}).items():
        if name not in file.experiment.scenarios:
            near = nearest(name, file.experiment.scenarios)
            raise _problem(path, ("egos", "names", name), f"no scenario of this experiment{near}")
        if not ids:
            raise _problem(path, ("egos", "names", name), "names nobody: no trial is left")
    both = set(file.parameters) & set(file.samples.parameters if file.samples else ())
    for name in both:
        raise _problem(path, ("samples", "parameters", name), "there is a grid of it already")


def _choice(path: Path, file: ExperimentFile, k: int, name: str) -> Choice:
    source, keys = path.parent / name, file.experiment
    try:
        is_ours = source.suffix == ".toml"
        scenario = load_scenario_file(source).scenario if is_ours else load_scenario(source)
        seeds = load_scenario_file(source).seeds if is_ours else (scenario.seed,)
    except ReactiveError as error:
        raise _problem(path, ("experiment", "scenarios", k), str(error)) from error
    names = file.egos.names
    egos = names.get(name, []) if isinstance(names, dict) else names or []
    return Choice(name, scenario, tuple(egos), tuple(keys.seeds or seeds))


def _problem(path: Path, keys: tuple[str | int, ...], message: str) -> ScenarioError:
    line = line_of(text_of(path), keys)
    return ScenarioError(f"{path}{f':{line}' if line else ''}: key '{'.'.join(map(str, keys))}': {message}")
