"""The command line. Heavy packages are imported inside the commands, so that `--help` answers at once."""

from __future__ import annotations

import sys
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NoReturn

import typer

from sumo_reactive import __version__
from sumo_reactive.errors import ReactiveError

if TYPE_CHECKING:
    from sumo_reactive.experiment.recorder import Recorder
    from sumo_reactive.experiment.result import TrialResult
    from sumo_reactive.experiment.scenario import Scenario

Progress = Callable[[float, str], None]

USAGE_ERROR, INTERNAL_ERROR, INTERRUPTED = 2, 70, 130

COMPILING_NOTE = "compiling the kernels once (about 20 s)…"

UsageErrors: tuple[type[Exception], ...] = typer.BadParameter.__bases__
"""Click's `UsageError`, which some releases of typer bring along and others import."""

app = typer.Typer(name="sumo-reactive", add_completion=False, pretty_exceptions_enable=False, rich_markup_mode=None)


class ProfileName(StrEnum):
    """The values of `--profile`."""

    DEFAULT = "default"
    PAPER = "paper"


class DelaysName(StrEnum):
    """The values of `--delays`."""

    SHIFT = "shift"
    REPLAN = "replan"


def _show_version(asked: bool) -> None:
    if asked:
        typer.echo(f"sumo-reactive {__version__}")
        raise typer.Exit


@app.callback()
def _common(version: Annotated[bool, typer.Option("--version", callback=_show_version, is_eager=True)] = False) -> None:
    """Drive a car in SUMO after Fraichard & Laugier (1991): symbolic pilot, potential-field executor."""


@app.command(epilog="Options after -- go to SUMO unchanged.")
def run(
    context: typer.Context,
    config: Annotated[Path, typer.Argument(help="a .sumocfg, or a scenario .toml")],
    ego: Annotated[str | None, typer.Option(help="vehicle to drive; else one named 'ego', else the first car")] = None,
    seed: Annotated[int | None, typer.Option(min=0, help="seed of the random numbers; else the scenario's, else 42")] = None,
    step_length: Annotated[float | None, typer.Option(help="simulation step, s")] = None,
    profile: Annotated[ProfileName | None, typer.Option(help="the paper's nine commands, or the finer default")] = None,
    delays: Annotated[DelaysName | None, typer.Option(help="shift times by a delay, as in the paper, or re-plan")] = None,
    until: Annotated[float | None, typer.Option(help="end at this simulation time, s")] = None,
    until_end: Annotated[bool, typer.Option("--until-end", help="play on after the ego has arrived")] = False,
    out: Annotated[Path | None, typer.Option(help="folder for summary, trajectory and decisions")] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="replace another run in that folder")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="print the verdict only")] = False,
) -> int:
    """Let the ego drive to its goal in a SUMO scenario, and judge the trip."""
    from sumo_reactive.experiment.recorder import Recorder
    from sumo_reactive.experiment.scenario import load_scenario

    scenario = load_scenario(config)
    scenario = _with_options(scenario, ego, seed, step_length, profile, delays, until)
    scenario = replace(scenario, until_end=until_end, sumo_options=tuple(context.obj or ()))
    recorder = Recorder(out, overwrite=overwrite) if out else None
    result = _drive(scenario, recorder, quiet)
    if recorder:
        recorder.write(result)
    _show(result, quiet)
    return result.exit_code


@app.command()
def explain(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="folder that a run has written with --out")],
    at: Annotated[float | None, typer.Option(help="tell all that was in force at this simulation time, s")] = None,
) -> int:
    """Tell in sentences why the ego of a recorded run did what it did."""
    from sumo_reactive.report.explain import moment, story
    from sumo_reactive.report.recording import load

    recording = load(folder)
    typer.echo("\n".join(story(recording) if at is None else moment(recording, at)))
    return 0


def _with_options(
    scenario: Scenario,
    ego: str | None,
    seed: int | None,
    step_length: float | None,
    profile: ProfileName | None,
    delays: DelaysName | None,
    until: float | None,
) -> Scenario:
    """Return the scenario with what the command line says in place of what the file says."""
    from sumo_reactive.controller import Profile
    from sumo_reactive.pilot.schedule import Delays

    return replace(
        scenario,
        ego=scenario.ego if ego is None else ego,
        seed=scenario.seed if seed is None else seed,
        step_length_s=scenario.step_length_s if step_length is None else step_length,
        profile=scenario.profile if profile is None else Profile(profile.value),
        delays=scenario.delays if delays is None else Delays(delays.value),
        until_s=scenario.until_s if until is None else until,
    )


def _drive(scenario: Scenario, recorder: Recorder | None, quiet: bool) -> TrialResult:
    from sumo_reactive.compilation import is_cached
    from sumo_reactive.experiment.trial import run_trial

    if not is_cached():
        typer.echo(COMPILING_NOTE, err=True)
    with _progress(quiet) as progress:
        if recorder is None:
            return run_trial(scenario, progress=progress)
        return run_trial(scenario, observer=recorder.see, progress=progress, survey=recorder.survey)


@contextmanager
def _progress(quiet: bool) -> Iterator[Progress | None]:
    """Give a function that shows simulation time and a text on the terminal; None where nobody looks."""
    if quiet or not sys.stderr.isatty():
        yield None
        return
    from rich.console import Console

    with Console(stderr=True).status("starting SUMO") as status:
        yield lambda time, text: status.update(f"{time:8.1f} s  {text}")


def _show(result: TrialResult, quiet: bool) -> None:
    from sumo_reactive.experiment.summary import rows_of

    if quiet:
        typer.echo(f"{result.ego}: {result.verdict}")
        return
    rows = rows_of(result)
    if not sys.stdout.isatty():
        wide = max(len(label) for label, _ in rows)
        typer.echo("\n".join(f"{label:<{wide}}  {text}" for label, text in rows))
        return
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    table = Table(title=result.scenario, show_header=False)
    for label, text in rows:
        table.add_row(Text(label), Text(text, style="bold" if label == "verdict" else ""))
    Console().print(table)


def main() -> NoReturn:
    """Run the command line and exit with its code; errors of the user become one line."""
    arguments = sys.argv[1:]
    split = arguments.index("--") if "--" in arguments else len(arguments)
    raise SystemExit(_exit_code(arguments[:split], arguments[split + 1 :]))


def _exit_code(arguments: list[str], sumo_options: list[str]) -> int:
    try:
        code = int(app(args=arguments, prog_name="sumo-reactive", standalone_mode=False, obj=sumo_options) or 0)
        return _fail("interrupted", code) if code == INTERRUPTED else code
    except ReactiveError as error:
        return _fail(str(error), error.exit_code)
    except UsageErrors as error:
        message = getattr(error, "format_message", error.__str__)()
        asked = getattr(getattr(error, "ctx", None), "command_path", "sumo-reactive")
        return _fail(f"{message} (see {asked} --help)", USAGE_ERROR)
    except (typer.Abort, KeyboardInterrupt):
        return _fail("interrupted", INTERRUPTED)
    except Exception:
        traceback.print_exc()
        return _fail("internal error, please report it with the lines above", INTERNAL_ERROR)


def _fail(message: str, code: int) -> int:
    typer.echo(f"sumo-reactive: {' '.join(message.split())}", err=True)
    return code
