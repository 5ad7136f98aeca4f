"""Which driver an ego gets, by name and options."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from importlib.metadata import entry_points
from pathlib import Path

from sumo_reactive.errors import ScenarioError
from sumo_reactive.lab.schema import nearest

DriverOption = str | int | float | bool


@dataclass(frozen=True)
class DriverChoice:
    """A driver by its `name`: `reactive` (this project's), `sumo` (SUMO's own), or one of the user's, with `options` for it.

    `folder` is where the user's modules and programs are looked for first. Raises ScenarioError for options of a driver
    that has none.
    """

    name: str
    options: tuple[tuple[str, DriverOption], ...] = ()
    folder: Path = Path()

    def __post_init__(self) -> None:
        if not self.name:
            raise ScenarioError("a driver without a name")
        if self.options and not self.is_users:
            raise ScenarioError(f"driver '{self.name}' takes no options; its parameters are the scenario's")

    @property
    def is_users(self) -> bool:
        """Whether somebody else than this project and SUMO has written it."""
        return self.name not in (REACTIVE_NAME, SUMO_NAME)

    @property
    def short(self) -> str:
        """The name for the head of a column: the class, or the program."""
        return Path(self.name.removeprefix(PROGRAM).split()[-1].rpartition(":")[2] or self.name).name

    def __str__(self) -> str:
        """Return name and options as people read them, which also tells two choices apart."""
        told = ", ".join(f"{name}={value}" for name, value in self.options)
        return f"{self.name}({told})" if told else self.name


REACTIVE_NAME, SUMO_NAME = "reactive", "sumo"

REACTIVE, SUMO = DriverChoice(REACTIVE_NAME), DriverChoice(SUMO_NAME)
"""This project's controller, and SUMO's own driver, the baseline."""


ENTRY_POINTS = "sumo_reactive.drivers"
"""The group of entry points that packages name their drivers in."""

PROGRAM = "exec:"
"""What the name of a driver begins with that is a program of its own, run by this command line."""


def driver_problem(name: str) -> str:
    """Return what is wrong with a driver's name; empty: nothing, as far as its form tells."""
    installed = {entry.name for entry in entry_points(group=ENTRY_POINTS)}
    if name in (REACTIVE_NAME, SUMO_NAME) or ":" in name or name in installed:
        return ""
    near = nearest(name, (REACTIVE_NAME, SUMO_NAME, *sorted(installed)))
    return f"unknown driver '{name}'{near}; one of the user's is named as module:Class"


def chosen_driver(name: str, options: Mapping[str, DriverOption], folder: Path) -> DriverChoice:
    """Return the driver of that name, the same value wherever one of the two that are built in is asked for."""
    known = {one.name: one for one in (REACTIVE, SUMO)}
    return known[name] if name in known and not options else DriverChoice(name, tuple(sorted(options.items())), folder)
