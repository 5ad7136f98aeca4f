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
) -> int:
    """Tell in sentences why the ego of a recorded run did what it did."""
    from sumo_reactive.show.explain import moment, story
    from sumo_reactive.show.recording import load

    recording = load(folder)
    typer.echo("\n".join(story(recording) if at is None else moment(recording, at)))
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
