"""What the commands share: the application they register with, progress and notes on the terminal."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Annotated

import typer

from sumo_reactive import __version__

Progress = Callable[[float, str], None]

COMPILING_NOTE = "compiling the kernels once (about 20 s)…"
COMPILING_ALWAYS_NOTE = (
    "compiling the kernels (about 20 s), for this run alone: others can write to what leads to XDG_CACHE_HOME or ~/.cache…"
)

app = typer.Typer(name="sumo-reactive", add_completion=False, pretty_exceptions_enable=False, rich_markup_mode=None)


def _show_version(asked: bool) -> None:
    if asked:
        typer.echo(f"sumo-reactive {__version__}")
        raise typer.Exit


@app.callback()
def _common(version: Annotated[bool, typer.Option("--version", callback=_show_version, is_eager=True)] = False) -> None:
    """Drive a car in SUMO after Fraichard & Laugier (1991): symbolic pilot, potential-field executor."""


def note_compiling() -> None:
    """Say so if the kernels are about to be compiled."""
    from sumo_reactive.driver.compilation import is_cached, is_kept

    if not is_cached():
        typer.echo(COMPILING_NOTE if is_kept() else COMPILING_ALWAYS_NOTE, err=True)


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
def progress_shown(quiet: bool) -> Iterator[Progress | None]:
    """Give a function that shows simulation time and a text on the terminal; None where nobody looks."""
    if quiet or not sys.stderr.isatty():
        yield None
        return
    from rich.console import Console
    from rich.text import Text

    with Console(stderr=True).status("starting SUMO") as status:
        yield lambda time, text: status.update(Text(f"{time:8.1f} s  {text}"))
