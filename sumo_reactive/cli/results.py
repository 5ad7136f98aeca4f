"""`sumo-reactive results`: what the store of an experiment says."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from sumo_reactive.cli.app import app

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    from sumo_reactive.lab.batch.stored_results import Group, Mean, Results

WIDE = 200
"""Columns of a table that goes to a file or another program."""

_UNBOUNDED = 100_000
"""Columns that no table takes."""

MOST_ROWS = 10_000
"""So many rows of a query are shown."""


@app.command(epilog="Example: sumo-reactive results STORE.duckdb --metric time_loss_s")
def results(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="the store (.duckdb) that batch has written")],
    metric: Annotated[list[str] | None, typer.Option(help="show this metric; else those of the experiment")] = None,
    sql: Annotated[str | None, typer.Option(help="a query over trials, metrics, events, diagram, plan, departures")] = None,
    csv: Annotated[Path | None, typer.Option(metavar="F", help="write a row a trial, or the query, as CSV")] = None,
    parquet: Annotated[Path | None, typer.Option(metavar="F", help="the same as Parquet")] = None,
) -> int:
    """Show mean and 95 % interval of each metric by scenario, driver and parameters, or hand the table on."""
    from sumo_reactive.lab.batch.stored_results import Results, written

    for target, form in ((csv, "csv"), (parquet, "parquet")):
        if target:
            written(file, sql, target, form)
    if csv or parquet:
        return 0
    with Results(file) as found:
        if sql:
            table = found.asked(sql, MOST_ROWS)
            _console().print(_plain(table.columns, table.rows))
            if table.is_cut:
                typer.echo(f"the first {MOST_ROWS} rows; --csv or --parquet writes all")
        else:
            _show_means(found, found.metrics(metric or []))
            finished, planned = found.progress
            typer.echo(f"{finished} of {planned} trials finished; mean [bootstrap interval at 95 %]")
    return 0


def _show_means(found: Results, metrics: list[str]) -> None:
    """Print a row a group; where that is too wide for the terminal, a line a group and a row below for each metric."""
    from rich.measure import Measurement

    console, groups = _console(), found.groups(metrics)
    varied = any(group.varied for group in groups)
    columns = ["scenario", "driver", *(["varied"] if varied else []), "results", *metrics]
    rows = [[*_names(group, varied), *(_told(mean) for mean in group.means)] for group in groups]
    table = _plain(columns, rows)
    if Measurement.get(console, console.options.update_width(_UNBOUNDED), table).maximum <= console.width:
        console.print(table)
        return
    for group in groups:
        console.print(_shown("  ".join(filter(None, _names(group, varied)))))
        console.print(_plain(("metric", "mean"), zip(metrics, map(_told, group.means), strict=True)))


def _names(group: Group, varied: bool) -> list[str]:
    return [group.scenario, group.driver, *([group.varied] if varied else []), f"{group.done} of {group.finished}"]


def _told(mean: Mean | None) -> str:
    if mean is None:
        return "none"
    interval = f" [{mean.interval.low:.4g}, {mean.interval.high:.4g}]" if mean.interval else ""
    return f"{mean.mean:.4g}{interval}"


def _plain(columns: Sequence[str], rows: Iterable[Any]) -> Table:
    from rich.box import SIMPLE_HEAD
    from rich.table import Table

    table = Table(box=SIMPLE_HEAD, pad_edge=False)
    for column in columns:
        table.add_column(_shown(column), overflow="fold")
    for row in rows:
        table.add_row(*(_shown("" if value is None else str(value)) for value in row))
    return table


def _shown(text: str) -> Text:
    """Return a text of the store as a terminal may have it: nothing that steers it, nothing that rich takes for markup."""
    from rich.text import Text

    return Text("".join(letter if letter.isprintable() or letter == "\n" else "�" for letter in text))


def _console() -> Console:
    from rich.console import Console

    return Console(width=None if sys.stdout.isatty() else WIDE)
