"""Which files are scenarios: told without anything heavy."""

from __future__ import annotations

import os
import tomllib
from collections.abc import Iterable, Iterator
from pathlib import Path

from sumo_reactive.errors import ScenarioError
from sumo_reactive.files import text_of

SCENARIO_SUFFIX = ".toml"
TABLE = "scenario"


def is_scenario_file(path: Path) -> bool:
    """Whether `path` is a scenario `.toml`; one that is broken counts if a line of it opens the table `[scenario]`."""
    if path.suffix != SCENARIO_SUFFIX:
        return False
    try:
        text = text_of(path)
    except ScenarioError:
        return False
    if TABLE not in text:
        return False
    try:
        return isinstance(tomllib.loads(text).get(TABLE), dict)
    except (ValueError, RecursionError):
        return any(line.strip().startswith(f"[{TABLE}]") for line in text.splitlines())


def scenario_files(paths: Iterable[Path]) -> list[Path]:
    """Return the files named and the scenario files in the folders named, each once.

    Raises ScenarioError for a path that does not exist or is no scenario, and for a folder without any.
    """
    found: dict[Path, Path] = {}
    for path in paths:
        inside = sorted(_inside(path)) if path.is_dir() else [path]
        if not inside:
            raise ScenarioError(f"{path}: no scenario file (a {SCENARIO_SUFFIX} with a table [{TABLE}]) in this folder")
        if not path.exists():
            raise ScenarioError(f"{path}: no such file or folder")
        if path.suffix != SCENARIO_SUFFIX and not path.is_dir():
            raise ScenarioError(f"{path}: not a scenario file: its name does not end with {SCENARIO_SUFFIX}")
        for file in inside:
            found.setdefault(file.resolve(), file)
    return list(found.values())


def _inside(folder: Path) -> Iterator[Path]:
    """Yield the scenario files in a folder and the folders in it, hidden ones apart."""
    for place, folders, files in os.walk(folder):
        folders[:] = [name for name in folders if not name.startswith((".", "__"))]
        yield from (path for name in files if is_scenario_file(path := Path(place, name)))
