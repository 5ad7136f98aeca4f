"""Drivers of the user's, found by name: a class in a module, an entry point of a package, or a program."""

from __future__ import annotations

import hashlib
import importlib
import inspect
import sys
from collections.abc import Callable
from functools import cache, partial
from importlib.metadata import entry_points
from pathlib import Path
from typing import Any

from sumo_reactive.driver.controller import PARTS, Parts
from sumo_reactive.errors import ScenarioError
from sumo_reactive.lab.drivers.choice import ENTRY_POINTS, PROGRAM, DriverChoice
from sumo_reactive.lab.drivers.program import ProgramDriver, words_of_program
from sumo_reactive.lab.drivers.protocol import Driver

_METHODS = ("start", "step", "end")


def controller_parts(choice: DriverChoice) -> Parts:
    """Return the parts of this project's controller that a choice asks for: the usual ones, or those that it names."""
    if not choice.is_users or choice.name.startswith(PROGRAM):
        return PARTS
    found = _found(choice)
    if isinstance(found, Parts) and choice.options:
        raise ScenarioError(f"driver '{choice}': parts take no options")
    return found if isinstance(found, Parts) else PARTS


def is_of_parts(choice: DriverChoice) -> bool:
    """Whether a choice is this project's controller, of whatever parts."""
    return not choice.is_users or controller_parts(choice) is not PARTS


def maker_of(choice: DriverChoice) -> Callable[[], Driver]:
    """Return what makes a new driver of this kind; raise ScenarioError if there is none, before anything is simulated."""
    if choice.name.startswith(PROGRAM):
        words = words_of_program(choice)
        return partial(ProgramDriver, words, choice.folder, dict(choice.options))
    found = class_of(choice)
    options = dict(choice.options)
    try:
        inspect.signature(found).bind(**options)
    except TypeError as error:
        raise ScenarioError(f"driver '{choice}': {error}") from error
    return partial(found, **options)


def require_driver(choice: DriverChoice) -> None:
    """Raise ScenarioError unless a driver can be made."""
    if not is_of_parts(choice):
        maker_of(choice)


def class_of(choice: DriverChoice) -> Callable[..., Driver]:
    """Return the class that a choice names; raise ScenarioError for what is no driver."""
    found = _found(choice)
    missing = [name for name in _METHODS if not callable(getattr(found, name, None))]
    if missing:
        raise ScenarioError(f"driver '{choice.name}' is no driver: it has no {' and no '.join(missing)}")
    driver: Callable[..., Driver] = found
    return driver


def _found(choice: DriverChoice) -> Any:
    """Return what a choice names; raise ScenarioError if that cannot be loaded."""
    installed = {entry.name: entry for entry in entry_points(group=ENTRY_POINTS)}
    try:
        if choice.name in installed:
            return installed[choice.name].load()
        module, _, name = choice.name.partition(":")
        return getattr(_imported(module, choice.folder), name)
    except (Exception, SystemExit) as error:  # the user's module may raise anything while it is imported
        raise ScenarioError(f"driver '{choice.name}' cannot be loaded: {type(error).__name__}: {error}") from error


def _imported(module: str, folder: Path) -> Any:
    """Import a module, from `folder` if it is there."""
    place = str(folder.absolute())
    if place not in sys.path:
        sys.path.insert(0, place)
    return importlib.import_module(module)


@cache
def digest_of_driver(choice: DriverChoice) -> str:
    """Return a digest of the sources of a driver, empty for one that is built in: what its trips' numbers depend on.

    It is of the file that its class is written in, or of the program and the files that its command names. Raises
    ScenarioError for what cannot be found.
    """
    if not choice.is_users:
        return ""
    digest = hashlib.sha256()
    for file in _files_of(choice):
        digest.update(file.read_bytes())
    return digest.hexdigest()[:16]


def _files_of(choice: DriverChoice) -> list[Path]:
    if choice.name.startswith(PROGRAM):
        named = (choice.folder / word for word in words_of_program(choice))
        return [file for file in named if file.is_file()]
    found = _found(choice)
    source = getattr(sys.modules.get(choice.name.partition(":")[0]), "__file__", None) or inspect.getsourcefile(type(found))
    return [Path(source)] if source else []
