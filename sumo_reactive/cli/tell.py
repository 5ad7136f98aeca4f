"""`sumo-reactive explain` and `report`: what has been recorded, told in sentences and shown on a page."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from sumo_reactive.cli.app import app


@app.command()
def explain(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="folder that a run has written with --out")],
    at: Annotated[float | None, typer.Option(help="tell all that was in force at this simulation time, s")] = None,
    user: Annotated[str | None, typer.Option("--about", metavar="ID", help="tell what this user had to do with it")] = None,
    in_brief: Annotated[bool, typer.Option("--brief", help="tell a line a behaviour")] = False,
) -> int:
    """Tell in sentences why the ego of a recorded run did what it did."""
    from sumo_reactive.show.explain import about, brief, moment, story
    from sumo_reactive.show.recording import load

    if (at is not None) + (user is not None) + in_brief > 1:
        raise typer.BadParameter("--at, --about and --brief: one of them at a time")
    recording = load(folder)
    told = story(recording)
    if at is not None:
        told = moment(recording, at)
    elif user is not None:
        told = about(recording, user)
    elif in_brief:
        told = brief(recording)
    typer.echo("\n".join(told))
    return 0


@app.command()
def report(
    path: Annotated[Path, typer.Argument(metavar="PATH", help="the store of a batch (.duckdb), or a folder of run --out")],
    out: Annotated[Path | None, typer.Option(metavar="FILE", help="else beside the store, or in the folder")] = None,
) -> int:
    """Write one HTML page that shows a batch or a run, and loads nothing from anywhere."""
    from sumo_reactive.show.reports import page_beside, page_of
    from sumo_reactive.writing import write_whole

    target = out or page_beside(path)
    write_whole(target, page_of(path, target))
    typer.echo(str(target))
    return 0
