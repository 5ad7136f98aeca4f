"""`sumo-reactive report`: a page of pictures and tables from a batch's store or a recorded run."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from sumo_reactive.cli.app import app


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
