"""`sumo-reactive figure` and `film`: a recorded run in pictures."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path
from typing import Annotated

import typer

from sumo_reactive.cli.app import app, status_shown
from sumo_reactive.errors import ScenarioError

_Folder = Annotated[Path, typer.Argument(metavar="DIR", help="folder that a run has written with --out")]


def _require_library(module: str, extra: str) -> None:
    """Raise ScenarioError for an optional library that is not installed, with the command that installs it."""
    if find_spec(module) is None:
        raise ScenarioError(f"this needs {module}: pip install 'sumo-reactive[{extra}]'")


@app.command(epilog="Example: sumo-reactive figure DIR --at 83.2 -o moment.pdf")
def figure(
    folder: _Folder,
    at: Annotated[float, typer.Option(help="simulation time, s")],
    out: Annotated[Path, typer.Option("--out", "-o", metavar="FILE", help="the picture: .svg, .pdf or .png")],
    height: Annotated[float, typer.Option(min=5.0, max=2000.0, help="height of the ground shown, m")] = 20.0,
    field: Annotated[bool, typer.Option("--field", help="draw the potential U of the chosen command, too")] = False,
) -> int:
    """Draw a moment of a recorded run: the ego, its way, regions by state, where it will stop, its speed."""
    _require_library("matplotlib", "plot")
    from sumo_reactive.show import run_drawing as drawing
    from sumo_reactive.show.recording import read_run, state_at

    if out.suffix.lower().removeprefix(".") not in drawing.FORMATS:
        raise ScenarioError(f"{out}: a figure is a file .{', .'.join(drawing.FORMATS)}")
    recording = read_run(folder)
    state_at(recording, at)
    with drawing.drawn_in_style():
        drawn = drawing.RunDrawing(recording, drawing.Shown(height, has_field=field))
        drawn.show(drawn.steps.index_at(at))
        drawing.save_figure(drawn.figure, out)
    for note in (*drawn.notes, *([drawing.FIELD_NOTE] if field else [])):
        typer.echo(note, err=True)
    typer.echo(str(out))
    return 0


@app.command(epilog="Example: sumo-reactive film DIR --from 70 --to 100 --speed 2 -o crossing.mp4")
def film(
    folder: _Folder,
    out: Annotated[Path, typer.Option("--out", "-o", metavar="FILE", help="the film: .mp4 or .gif")],
    start: Annotated[float | None, typer.Option("--from", help="begin at this simulation time, s")] = None,
    end: Annotated[float | None, typer.Option("--to", help="end at this simulation time, s")] = None,
    fps: Annotated[int, typer.Option(min=1, max=60, help="frames a second")] = 20,
    speed: Annotated[float, typer.Option(min=0.01, max=1000.0, help="times faster than life")] = 1.0,
    height: Annotated[float, typer.Option(min=5.0, max=2000.0, help="height of the ground shown, m")] = 20.0,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="show no progress")] = False,
) -> int:
    """Film a recorded run: what `figure` draws, moving."""
    _require_library("matplotlib", "plot")
    if out.suffix.lower() == ".mp4":
        _require_library("imageio_ffmpeg", "film")
    from sumo_reactive.show import film as filming
    from sumo_reactive.show.recording import read_run
    from sumo_reactive.show.run_drawing import RunDrawing, Shown, drawn_in_style

    if out.suffix.lower().removeprefix(".") not in filming.FILM_FORMATS:
        raise ScenarioError(f"{out}: a film is a file .{' or .'.join(filming.FILM_FORMATS)}")
    with drawn_in_style(), status_shown(quiet, "drawing the roads") as progress:
        drawing = RunDrawing(read_run(folder), Shown(height, filming.FILM_DPI))
        count = filming.write_film(drawing, filming.Cut(start, end, fps, speed), out, progress)
    for note in drawing.notes:
        typer.echo(note, err=True)
    typer.echo(f"{out}: {count} frames")
    return 0
