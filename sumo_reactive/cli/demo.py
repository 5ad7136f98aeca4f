"""`sumo-reactive demo`: the paper's experiment, driven from files that the package brings along."""

from __future__ import annotations

import shlex
import webbrowser
from pathlib import Path
from typing import Annotated

import typer

from sumo_reactive.cli.app import app, compile_first, progress_shown

DEMO_CONFIG = Path(__file__).resolve().parent.parent / "demo" / "figure4.sumocfg"
"""networks/figure4, to which a clone has links here and a wheel the files themselves."""

_FOLDER = Path("sumo_reactive_demo")
_PASSES_AT_S = 46
"""A moment worth a look: the ego is beside the car that it overtakes."""


@app.command(epilog="Example: sumo-reactive demo --open")
def demo(
    out: Annotated[Path, typer.Option("--out", "-o", metavar="DIR", help="folder for record and page")] = _FOLDER,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="replace another run in that folder")] = False,
    is_opened: Annotated[bool, typer.Option("--open", help="open the page in the browser")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="name the page only")] = False,
) -> int:
    """Drive the paper's experiment (overtake, then cross), record it, and make the page that shows it."""
    from sumo_reactive.lab.recorder import PAGE, Recorder
    from sumo_reactive.lab.scenario import load_scenario
    from sumo_reactive.lab.simulation import run_trial
    from sumo_reactive.show.reports import page_of
    from sumo_reactive.sumo.crash import crashes_told
    from sumo_reactive.writing import write_whole

    recorder, page = Recorder(out, overwrite=overwrite), out / PAGE
    compile_first()
    with progress_shown(quiet) as progress, crashes_told():
        result = run_trial(load_scenario(DEMO_CONFIG), observer=recorder.see, progress=progress)
    recorder.write(result)
    write_whole(page, page_of(out, page))
    typer.echo(str(page) if quiet else "\n".join(_told(result.verdict, out, page)))
    if is_opened and not webbrowser.open(page.resolve().as_uri()):
        typer.echo(f"no browser could be opened: open {page} by hand", err=True)
    return int(result.exit_code)


def _told(verdict: str, out: Path, page: Path) -> list[str]:
    """Return what came of it, and what to try next."""
    folder = shlex.quote(str(out))
    return [
        f"The ego overtook a slow car and crossed behind cars from the right: {verdict}.",
        f"page    {page}",
        f"record  {out}",
        "next    " + f"sumo-reactive explain {folder}",
        f"        sumo-reactive explain {folder} --at {_PASSES_AT_S}",
        "        sumo-reactive run your.sumocfg --ego ID --out DIR",
    ]
