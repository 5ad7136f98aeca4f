"""`sumo-reactive explain`, `report` and `table`: what has been recorded, in sentences, on a page, in a paper."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from sumo_reactive.cli.app import app, status_shown


@app.command(epilog="Example: sumo-reactive explain DIR --at 75")
def explain(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="folder that a run has written with --out")],
    at: Annotated[float | None, typer.Option(help="tell all that was in force at this simulation time, s")] = None,
    user: Annotated[str | None, typer.Option("--about", metavar="ID", help="tell what this user had to do with it")] = None,
    in_brief: Annotated[bool, typer.Option("--brief", help="tell a line a behaviour")] = False,
) -> int:
    """Tell in sentences why the ego of a recorded run did what it did."""
    from sumo_reactive.show.explain import about, brief, moment, story
    from sumo_reactive.show.recording import read_run

    if (at is not None) + (user is not None) + in_brief > 1:
        raise typer.BadParameter("--at, --about and --brief: one of them at a time")
    recording = read_run(folder)
    told = story(recording)
    if at is not None:
        told = moment(recording, at)
    elif user is not None:
        told = about(recording, user)
    elif in_brief:
        told = brief(recording)
    typer.echo("\n".join(told))
    return 0


@app.command(epilog="Example: sumo-reactive report DIR")
def report(
    path: Annotated[
        Path, typer.Argument(metavar="PATH", help="store of a batch (.duckdb), or folder of run --out or compare --out")
    ],
    out: Annotated[Path | None, typer.Option(metavar="FILE", help="else beside the store, or in the folder")] = None,
    is_followed: Annotated[bool, typer.Option("--follow", help="of a run that drives: anew until it ends")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="show no progress")] = False,
) -> int:
    """Write one HTML page that shows a batch, a comparison or a run, and loads nothing from anywhere."""
    from sumo_reactive.lab.recorder import PAGE
    from sumo_reactive.show.following import follow
    from sumo_reactive.show.reports import page_beside, page_of
    from sumo_reactive.writing import write_whole

    target = out or (path / PAGE if is_followed else page_beside(path))
    with status_shown(quiet, "drawing the page") as show:
        if is_followed:
            follow(path, target, show or (lambda text: None))
        else:
            write_whole(target, page_of(path, target))
    typer.echo(str(target))
    return 0


class FormatName(StrEnum):
    """Forms of a table, as the command line names them."""

    LATEX = "latex"
    MD = "md"
    CSV = "csv"


@app.command("table", epilog="Example: sumo-reactive table STORE.duckdb --format latex --out table.tex")
def paper_table(
    path: Annotated[Path, typer.Argument(metavar="PATH", help="store of a batch (.duckdb), or folder of compare --out")],
    form: Annotated[FormatName, typer.Option("--format", help="latex (booktabs), md or csv")] = FormatName.MD,
    metric: Annotated[list[str] | None, typer.Option(help="this metric, repeatable; else all")] = None,
    out: Annotated[Path | None, typer.Option(metavar="FILE", help="write it there instead of to the terminal")] = None,
) -> int:
    """Make a table for a paper: both drivers' means, their paired differences, intervals, effect sizes and tests."""
    from sumo_reactive.show.paper_table import Format, table_of
    from sumo_reactive.writing import write_whole

    text = table_of(path, Format(form.value), metric or [])
    if out is None:
        typer.echo(text, nl=False)
    else:
        write_whole(out, text)
    return 0
