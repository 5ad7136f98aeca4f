"""`sumo-reactive bundle` and `reproduce`: a record with all that drives it again, in one file, and the proof."""

from __future__ import annotations

import os
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from sumo_reactive.cli.app import DRIVER_HELP, JOBS, app, compile_first, status_shown
from sumo_reactive.errors import ExitCode

if TYPE_CHECKING:
    from sumo_reactive.lab.bundle.reproduction import Reproduction


@app.command(epilog="Example: sumo-reactive bundle runs/grid.duckdb --out grid.zip")
def bundle(
    path: Annotated[
        Path, typer.Argument(metavar="PATH", help="store of a batch (.duckdb), or folder of run --out or compare --out")
    ],
    out: Annotated[Path, typer.Option("--out", "-o", metavar="FILE", help="the bundle (.zip)")],
    digests_only: Annotated[bool, typer.Option("--digests-only", help="leave the scenarios' files out")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="show no progress")] = False,
) -> int:
    """Put a record, the files that its runs read, their commands, seeds and versions into one file, to be published."""
    from sumo_reactive.lab.bundle.packing import write_bundle
    from sumo_reactive.writing import require_writable

    require_writable(out)
    with status_shown(quiet, "looking for the files") as show:
        manifest = write_bundle(path, out, has_inputs=not digests_only, progress=show or (lambda name: None))
    runs, size_mb = len(manifest.runs), sum(one.bytes for one in manifest.inputs) / 1e6
    inputs = f"{len(manifest.inputs)} inputs of {size_mb:.1f} MB"
    typer.echo(f"{out}: {runs} {'run' if runs == 1 else 'runs'}, {'digests of ' if digests_only else ''}{inputs}")
    return ExitCode.DONE


@app.command(epilog="Example: sumo-reactive reproduce grid.zip --jobs 4")
def reproduce(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="a bundle (.zip)")],
    inputs: Annotated[Path | None, typer.Option(metavar="DIR", help="the inputs' folder, of a bundle without them")] = None,
    driver: Annotated[list[str] | None, typer.Option(help=f"{DRIVER_HELP}; one that the bundle was driven by")] = None,
    jobs: Annotated[int | None, typer.Option(*JOBS, min=1, metavar="N", help="runs at a time; else cores")] = None,
    time_limit: Annotated[float, typer.Option(min=1.0, help="wall-clock time that a run may take, s")] = 3600.0,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="tell runs that differ only")] = False,
) -> int:
    """Drive the runs of a bundle again, and tell whether every step is the same."""
    from sumo_reactive.lab.bundle import reproduction

    compile_first()
    numbers = count(1)
    with status_shown(quiet, "unpacking and checking") as show:
        found = reproduction.drive_again(
            file, inputs=inputs, drivers=driver or (), jobs=jobs or os.cpu_count() or 1, wall_limit_s=time_limit,
            progress=(lambda _: show(f"{next(numbers)} runs driven")) if show else None,
        )  # fmt: skip
    return _tell(found, quiet)


def _tell(found: Reproduction, quiet: bool) -> int:
    same = sum(one.is_same for one in found.runs)
    for one in found.runs:
        if not one.is_same or not quiet:
            typer.echo(f"{one.verdict}: {one.run.command}")
    for name, then, now in found.changed if same < len(found.runs) else ():
        typer.echo(f"{name}: {then} then, {now} now")
    typer.echo(f"{same} of {len(found.runs)} {'run' if len(found.runs) == 1 else 'runs'} the same to the last bit")
    return ExitCode.DONE if same == len(found.runs) else ExitCode.WANTING
