"""What the commands share: the application they register with, options, progress, notes and tables on the terminal."""

from __future__ import annotations

import sys
import tomllib
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from itertools import zip_longest
from pathlib import Path
from textwrap import wrap
from typing import TYPE_CHECKING, Annotated, Any

import typer

from sumo_reactive import __version__

if TYPE_CHECKING:
    from sumo_reactive.driver.parameters import Parameters
    from sumo_reactive.lab.drivers.choice import DriverChoice, DriverOption
    from sumo_reactive.lab.scenario import Scenario
    from sumo_reactive.sumo.session import Progress

_COMPILING = "compiling the kernels once (about 15 s)…"
_COMPILING_ALWAYS = (
    "compiling the kernels (about 15 s), for this run alone: others can write to what leads to XDG_CACHE_HOME or ~/.cache…"
)

JOBS = ("--jobs", "-j", "--workers")
"""What every command calls the number of processes that it may start."""

_PAGE, _GAP, _LEAST = 80, 2, 20
"""Columns of a page of text, between the columns of a table, and of its first one at least."""

_SEED, _MAX_SEED = "'--seed'", 2**31 - 1


def _one_seed(text: str) -> int:
    seeds = _seeds(text)
    if len(seeds) > 1:
        raise typer.BadParameter(f"'{text}' are several, and run drives once: compare, check and batch take them")
    return seeds[0]


SeedOption = Annotated[
    int | None, typer.Option(parser=_one_seed, metavar="N", help="seed of the random numbers; else the scenario's, else 42")
]
"""The option `--seed` of a command that drives once."""

SeedsOption = Annotated[
    list[str] | None, typer.Option("--seed", metavar="N", help="a number or a range as 1-10, repeatable")
]
"""The option `--seed` of a command that drives a trip with several."""

ParameterOption = Annotated[
    list[str] | None, typer.Option(metavar="NAME=VALUE", help="another value for a parameter of the driver (repeatable)")
]
"""The option `--parameter` of a command."""

DRIVER_HELP = "who drives: reactive, sumo, module:Class, 'exec:PROGRAM …' or the name of an installed one"

DriverOptions = Annotated[
    list[str] | None, typer.Option("--driver-option", metavar="NAME=VALUE", help="for the driver named (repeatable)")
]
"""The option `--driver-option` of a command."""

app = typer.Typer(name="sumo-reactive", pretty_exceptions_enable=False, rich_markup_mode=None)


def _show_version(asked: bool) -> None:
    if asked:
        typer.echo(f"sumo-reactive {__version__}")
        raise typer.Exit


@app.callback()
def _common(version: Annotated[bool, typer.Option("--version", callback=_show_version, is_eager=True)] = False) -> None:
    """Drive a car in SUMO after Fraichard & Laugier (1991): symbolic pilot, potential-field executor."""


def with_options(scenario: Scenario, **given: Any) -> Scenario:
    """Return the scenario with what the command line says in place of what the file says; None: it says nothing."""
    return replace(scenario, **{name: value for name, value in given.items() if value is not None})


def parameters_with(scenario: Scenario, said: Sequence[str]) -> Parameters:
    """Return the scenario's parameters with those that the command line says, each as NAME=VALUE."""
    values: dict[str, object] = {}
    for text in said:
        name, _, value = text.partition("=")
        try:
            values[name.strip()] = float(value)
        except ValueError as error:
            raise typer.BadParameter(f"--parameter: '{text}' is not NAME=VALUE with a number") from error
    return scenario.parameters.with_values(values)


def drivers_named(names: Sequence[str], said: Sequence[str]) -> list[DriverChoice]:
    """Return the drivers that the command line names, those of the user's with the options that it says."""
    from sumo_reactive.lab.drivers.choice import REACTIVE_NAME, SUMO_NAME, chosen_driver, driver_problem

    for name in names:
        if problem := driver_problem(name):
            raise typer.BadParameter(f"--driver: {problem}")
    options = dict(_driver_option(text) for text in said)
    built_in = (REACTIVE_NAME, SUMO_NAME)
    if options and not set(names) - set(built_in):
        raise typer.BadParameter("--driver-option: there is no --driver of the user's that takes it")
    return [chosen_driver(name, {} if name in built_in else options, Path.cwd()) for name in names]


def seeds_named(said: Sequence[str]) -> list[int]:
    """Return the seeds that the command line names, each once."""
    seeds = [seed for text in said for seed in _seeds(text)]
    if len(set(seeds)) < len(seeds):
        raise typer.BadParameter("a value is given twice", param_hint=_SEED)
    return seeds


def _seeds(text: str) -> range:
    """Return the seeds that a number or a range stands for."""
    first, is_range, last = text.partition("-")
    if not first.isdecimal() or (is_range and not last.isdecimal()):
        raise typer.BadParameter(f"'{text}' is neither a whole number nor a range such as 1-10", param_hint=_SEED)
    seeds = range(int(first), int(last if is_range else first) + 1)
    if not seeds or seeds[-1] > _MAX_SEED:
        raise typer.BadParameter(f"'{text}' is empty or goes beyond {_MAX_SEED}", param_hint=_SEED)
    return seeds


def _driver_option(text: str) -> tuple[str, DriverOption]:
    """Return an option NAME=VALUE with the value as TOML reads it, or as text where that says nothing."""
    name, is_there, value = text.partition("=")
    if not name or not is_there:
        raise typer.BadParameter(f"--driver-option: '{text}' is not NAME=VALUE")
    try:
        read = tomllib.loads(f"value = {value}")["value"]
    except tomllib.TOMLDecodeError:
        read = value
    return name, read if isinstance(read, str | int | float | bool) else value


def compile_first() -> None:
    """Have the kernels compiled if they are not, and say so before."""
    from sumo_reactive.driver.kernel_folder import is_cached, is_kept
    from sumo_reactive.lab.compiling import compile_ahead

    if not is_cached():
        typer.echo(_COMPILING if is_kept() else _COMPILING_ALWAYS, err=True)
        compile_ahead()


@contextmanager
def figures_kept(quiet: bool, show: Callable[[], None]) -> Iterator[None]:
    """Write what has been worked out: if that fails, the terminal has it at least, also where it was to be quiet."""
    from sumo_reactive.errors import OutputError

    try:
        yield
    except OutputError:
        if quiet:
            show()
        raise


@contextmanager
def status_shown(quiet: bool, first: str) -> Iterator[Callable[[str], None] | None]:
    """Give a function that replaces the text `first` on the terminal; None where nobody looks."""
    if quiet or not sys.stderr.isatty():
        yield None
        return
    from rich.console import Console
    from rich.text import Text

    with Console(stderr=True).status(first) as status:
        yield lambda text: status.update(Text(text))


@contextmanager
def progress_shown(quiet: bool) -> Iterator[Progress | None]:
    """Give a function that shows simulation time and a text on the terminal; None where nobody looks."""
    with status_shown(quiet, "starting SUMO") as show:
        yield None if show is None else lambda time, text: show(f"{time:8.1f} s  {text}")


def _widths(rows: Sequence[Sequence[str]], head: Sequence[str]) -> list[int]:
    """Return the width of each column: where that is too much below a head, its words and those of the first column wrap."""
    wide = [max(map(len, column)) for column in zip(*(head, *rows) if head else rows, strict=True)]
    if not head or sum(wide) + _GAP * (len(wide) - 1) <= _PAGE:
        return wide
    words = [max(map(len, name.split()), default=0) for name in head]
    wide = [max(word, *map(len, column)) for word, column in zip(words, zip(*rows, strict=True), strict=True)]
    return [max(words[0], _LEAST, _PAGE - sum(wide[1:]) - _GAP * (len(wide) - 1)), *wide[1:]]


def show_table(rows: Sequence[Sequence[str]], head: Sequence[str] = (), title: str = "") -> None:
    """Print rows in columns, as a table on a terminal; below a head all but the first stand right."""
    lines = [head, *rows] if head else rows
    sides = ["<", *(">" if head else "<" for _ in rows[0][1:])]
    if not sys.stdout.isatty():
        wide = _widths(rows, head)
        for line in lines:
            cells = [wrap(cell, width) if head else [cell] for cell, width in zip(line, wide, strict=True)]
            for parts in zip_longest(*cells, fillvalue=""):
                told = (f"{part:{side}{width}}" for part, side, width in zip(parts, sides, wide, strict=True))
                typer.echo("  ".join(told).rstrip())
        return
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    table = Table(title=Text(title) if title else None, show_header=bool(head))
    for name, side in zip(head or [""] * len(sides), sides, strict=True):
        table.add_column(name, justify="left" if side == "<" else "right")
    for row in rows:
        table.add_row(*map(Text, row), style="bold" if row[0] == "verdict" else None)
    Console().print(table)
