"""`sumo-reactive results`: what the store of an experiment says."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from sumo_reactive.cli.app import app

if TYPE_CHECKING:
    from rich.table import Table
    from rich.text import Text

    from sumo_reactive.lab.batch.stored_results import Mean, Results

WIDE = 200
"""Columns of a table that goes to a file or another program."""

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
            _print(_plain(table.columns, table.rows))
            if table.is_cut:
                typer.echo(f"the first {MOST_ROWS} rows; --csv or --parquet writes all")
        else:
            _print(_means(found, found.metrics(metric or [])))
            finished, planned = found.progress
            typer.echo(f"{finished} of {planned} trials finished; mean [bootstrap interval at 95 %]")
    return 0


def _means(found: Results, metrics: list[str]) -> Table:
    groups = found.groups(metrics)
    varied = any(group.varied for group in groups)
    columns = ["scenario", "driver", *(["varied"] if varied else []), "results", *metrics]
    rows = [
        [group.scenario, group.driver, *([group.varied] if varied else []), f"{group.done} of {group.finished}",
         *(_told(mean) for mean in group.means)]
        for group in groups
    ]  # fmt: skip
    return _plain(columns, rows)


def _told(mean: Mean | None) -> str:
    if mean is None:
        return "none"
    interval = f" [{mean.interval.low:.4g}, {mean.interval.high:.4g}]" if mean.interval else ""
    return f"{mean.mean:.4g}{interval}"


def _plain(columns: Sequence[str], rows: Sequence[Any]) -> Table:
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


def _print(table: Table) -> None:
    from rich.console import Console

    Console(width=None if sys.stdout.isatty() else WIDE).print(table)
