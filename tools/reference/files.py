"""The page of the files that are written: of a run that is recorded for it, of several egos, of comparisons and batches."""

from __future__ import annotations

import inspect
import json
import re
import tempfile
import typing
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import duckdb
from api_pages import ROOT

from reference.markdown import coded, page, said_below, table
from sumo_reactive.lab.batch.store_file import STORE_TABLES, VERSION
from sumo_reactive.lab.bundle.manifest import BUNDLE_VERSION, MANIFEST
from sumo_reactive.lab.columns import STEP_COLUMNS
from sumo_reactive.lab.comparison.record import COMPARISON_VERSION, CSV_FILE, CSV_MEANINGS, JSON_FILE, JSON_MEANINGS
from sumo_reactive.lab.metric_names import metric_of
from sumo_reactive.lab.metrics.safety.series import ENCOUNTER_MEANINGS
from sumo_reactive.lab.recorder import DECISIONS, ENCOUNTERS, FILES, FLEET, FLEET_MEANINGS, SUMMARY, TRAJECTORY, Recorder
from sumo_reactive.lab.result import TrialResult
from sumo_reactive.lab.scenario import load_scenario
from sumo_reactive.lab.schema import RECORD_VERSION
from sumo_reactive.lab.simulation import run_trial
from sumo_reactive.lab.surroundings_record import SURROUNDINGS, SURROUNDINGS_MEANINGS, USER_MEANINGS, USERS
from sumo_reactive.lab.trace import EntryKeys, NounKeys

RECORDED = ROOT / "scenarios" / "four_way_priority.toml"
"""The scenario whose record is looked at."""

STEP_MEANINGS = {one.name: one.meaning for one in STEP_COLUMNS.values()}
_JSON_TYPES = {str: "text", bool: "true or false", int: "number", float: "number", list: "list", dict: "table"}

_VERSIONS = table(
    ("files", "version", "where it stands"),
    [
        (
            "a record: all files of `run --out`, of one ego or several", str(RECORD_VERSION),
            f"`version` in `{SUMMARY}`, `{FLEET}` and `{SURROUNDINGS}`; in the metadata of each Parquet file, beside the "
            "`units` of its columns as JSON",
        ),
        ("a comparison: both files of `compare --out`", str(COMPARISON_VERSION), f"`version` in `{JSON_FILE}`"),
        ("a batch's store", str(VERSION), "its table `store`"),
        ("a bundle", str(BUNDLE_VERSION), f"`version` in its `{MANIFEST}`"),
    ],
)  # fmt: skip

READING = f"""A name ends in its unit; `null` or NULL is where there is none. Each kind of file has a version, which is
raised when its keys or columns change; a file of another is refused. `versions` in `{SUMMARY}` tell what program wrote it.

{_VERSIONS}

| in one line | Parquet | JSON lines |
| --- | --- | --- |
| pandas | `pandas.read_parquet("DIR/{TRAJECTORY}")` | `pandas.read_json("DIR/{DECISIONS}", lines=True)` |
| polars | `polars.read_parquet("DIR/{TRAJECTORY}")` | `polars.read_ndjson("DIR/{DECISIONS}")` |
| DuckDB | `duckdb.sql("FROM 'DIR/{TRAJECTORY}'")` | `duckdb.sql("FROM 'DIR/{DECISIONS}'")` |

A store: `duckdb.connect("STORE.duckdb", read_only=True).sql("FROM trials JOIN metrics USING (key)")`, or
`sumo-reactive results STORE.duckdb --parquet F`, a row a trial."""


COMPARED = """

Before the last stands a column with the name of the driver that is compared: the value with it."""


def files() -> str:
    """Return the page."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name) / "record"
        recorder = Recorder(folder)
        recorder.write(run_trial(load_scenario(RECORDED), observer=recorder.see))
        tables = _record(folder)
    tables |= {
        FLEET: table(("key", "meaning"), coded(FLEET_MEANINGS)), JSON_FILE: table(("key", "meaning"), coded(JSON_MEANINGS)),
        CSV_FILE: table(("column", "meaning"), coded(CSV_MEANINGS)) + COMPARED,
    }  # fmt: skip
    parts = [READING, "## The record of a run", table(("file", "holds"), coded(FILES))]
    parts += [part for file, told in tables.items() for part in (f"## `{file}`", told)]
    return page("Files and columns", *parts, "## The store of a batch", *_store())


def _record(folder: Path) -> dict[str, str]:
    """Return the table of each file in a record that has columns or keys."""
    summary, around = (json.loads((folder / name).read_text(encoding="utf-8")) for name in (SUMMARY, SURROUNDINGS))
    found = {name: inspect.getdoc(one) for name, one in vars(TrialResult).items() if isinstance(one, property)}
    return {
        SUMMARY: _keys(summary, found | said_below(TrialResult) | {"version": "Of the files of a record."}),
        TRAJECTORY: _columns(folder / TRAJECTORY, STEP_MEANINGS),
        ENCOUNTERS: _columns(folder / ENCOUNTERS, ENCOUNTER_MEANINGS),
        USERS: _columns(folder / USERS, USER_MEANINGS),
        DECISIONS: table(("key", "meaning"), _within(EntryKeys)),
        SURROUNDINGS: _keys(around, SURROUNDINGS_MEANINGS),
    }


def _columns(path: Path, meanings: Mapping[str, str]) -> str:
    found = [(name, kind) for name, kind, *_ in duckdb.sql(f"DESCRIBE FROM '{path}'").fetchall()]
    rows = ((f"`{name}`", kind, "" if kind == "VARCHAR" else metric_of(name).unit, meanings[name]) for name, kind in found)
    return table(("column", "type", "unit", "meaning"), rows)


def _keys(told: Mapping[str, Any], meanings: Mapping[str, Any]) -> str:
    rows = ((f"`{name}`", _JSON_TYPES[type(value)], meanings[name]) for name, value in told.items())
    return table(("key", "value", "meaning"), rows)


def _within(keys: type[NounKeys], place: str = "") -> Iterator[tuple[str, str]]:
    """Yield each key of a line with what it holds, then those of a table or of a list's tables in it."""
    said = said_below(keys)
    for name, field in keys.model_fields.items():
        path = f"{place}{field.alias or name}"
        yield f"`{path}`", said[name]
        is_list = typing.get_origin(field.annotation) is tuple
        for inner in (field.annotation, *typing.get_args(field.annotation)):
            if isinstance(inner, type) and issubclass(inner, NounKeys):
                yield from _within(inner, f"{path}[]." if is_list else f"{path}.")


def _store() -> Iterator[str]:
    """Yield heading, line and table for each table of a store."""
    for name, told, body in re.findall(r"CREATE TABLE (\w+) \( -- (.*)\n((?:.*\n)*?)\);", STORE_TABLES):
        rows = re.findall(r"^    (\w+) ([A-Z]+).* -- (.*)$", body, re.MULTILINE)
        yield from (f"### `{name}`", f"{told[0].upper()}{told[1:]}.")
        yield table(("column", "type", "meaning"), ((f"`{column}`", kind, meaning) for column, kind, meaning in rows))
