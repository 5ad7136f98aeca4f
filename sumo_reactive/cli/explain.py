"""`sumo-reactive explain`: why the ego of a recorded run did what it did."""

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
