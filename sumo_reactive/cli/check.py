"""`sumo-reactive check`: scenario files as tests, for CI."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from sumo_reactive.cli.app import (
    DRIVER_HELP,
    JOBS,
    DriverOptions,
    SeedsOption,
    app,
    compile_first,
    drivers_named,
    seeds_named,
)
from sumo_reactive.errors import ExitCode

if TYPE_CHECKING:
    from sumo_reactive.lab.check import Verdict


@app.command(epilog="Example: sumo-reactive check scenarios/ --jobs 2 --junit verdicts.xml --out failed")
def check(
    paths: Annotated[list[Path], typer.Argument(metavar="PATH...", help="scenario .toml files, or folders that hold some")],
    junit: Annotated[Path | None, typer.Option(metavar="FILE", help="write the verdicts as JUnit XML")] = None,
    jobs: Annotated[int, typer.Option(*JOBS, min=1, metavar="N", help="processes to run at the same time")] = 1,
    seed: SeedsOption = None,
    time_limit: Annotated[float, typer.Option(min=1.0, help="wall-clock time that a case may take, s")] = 600.0,
    out: Annotated[Path | None, typer.Option(metavar="DIR", help="keep record and page of what was not met there")] = None,
    driver: Annotated[list[str] | None, typer.Option(help=f"{DRIVER_HELP} (repeatable); else as the file says")] = None,
    driver_option: DriverOptions = None,
) -> int:
    """Run every scenario with every seed it names, or those given, and tell what of its expectations was not met."""
    from sumo_reactive.lab.check import cases_of, run_cases
    from sumo_reactive.lab.discovery import scenario_files

    drivers = drivers_named(driver or [], driver_option or [])
    seeds = seeds_named(seed or [])
    cases = [case for file in scenario_files(paths) for case in cases_of(file, drivers, seeds)]
    for target in (junit, out):
        if target is not None:
            from sumo_reactive.writing import require_writable

            require_writable(target, is_folder=target is out)
    compile_first()
    width = max(len(case.name) for case in cases)
    verdicts = []
    for verdict in run_cases(cases, jobs, time_limit):
        typer.echo(_line(verdict, width))
        verdicts.append(verdict)
    if out is not None:
        verdicts = _kept(verdicts, out, time_limit)
    return _conclude(verdicts, junit)


def _line(verdict: Verdict, width: int) -> str:
    result, network = verdict.outcome.result, verdict.outcome.network
    if verdict.is_met:
        came = f"{result.duration_s:.1f} s driven" if result else network.verdict if network else ""
        return f"met     {verdict.case.name:<{width}}  {came} in {verdict.outcome.wall_s:.1f} s"
    return f"FAILED  {verdict.case.name:<{width}}  {'; '.join(verdict.reasons)}"


def _kept(verdicts: list[Verdict], out: Path, time_limit: float) -> list[Verdict]:
    """Record each case that was not met in a folder of its own, with its page; return the verdicts with where that is."""
    from sumo_reactive.lab.check import blamed, recorded
    from sumo_reactive.lab.recorder import EgoFolders
    from sumo_reactive.show.reports import page_beside, page_of
    from sumo_reactive.writing import write_whole

    folders, cases, kept = EgoFolders(()), set[str](), []
    for verdict in verdicts:
        if verdict.is_met:
            kept.append(verdict)
            continue
        scenario = verdict.case.scenario
        share = "" if scenario.egos is None or scenario.egos.share is None else f"_share_{scenario.egos.share:g}"
        short = f"{scenario.source.stem}_seed_{scenario.seed}{share}"
        found = recorded(verdict, out / folders.of(verdict.case.name if short in cases else short), time_limit)
        cases.add(short)
        for folder in [found.record, *blamed(found)] if found.record is not None else []:
            write_whole(page_beside(folder), page_of(folder, page_beside(folder)))
        kept.append(found)
    return kept


def _failure(verdict: Verdict) -> str:
    from sumo_reactive.show.faults import failure_told

    return "\n".join(failure_told(verdict))


def _conclude(verdicts: list[Verdict], junit: Path | None) -> int:
    """Tell about the failed cases, write the file asked for, and return the exit code."""
    from sumo_reactive.lab.check import write_junit

    told = [(verdict, "" if verdict.is_met else _failure(verdict)) for verdict in verdicts]
    for verdict, text in told:
        if text:
            typer.echo("\n" + "\n".join((verdict.case.name, *(f"  {line}" for line in text.splitlines()))))
    met = sum(verdict.is_met for verdict in verdicts)
    typer.echo(f"\n{met} of {len(verdicts)} met")
    if junit is not None:
        write_junit(junit, told)
    return ExitCode.DONE if met == len(verdicts) else ExitCode.WANTING
