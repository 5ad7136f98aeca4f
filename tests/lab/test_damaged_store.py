"""A store from somebody else: whatever it holds, it is read as a store or refused in one line."""

import os
import random
import shutil
import subprocess
import sys

import duckdb
import pytest
from helpers.stores import made_store

from sumo_reactive.cli.results import results as show
from sumo_reactive.errors import OutputError, StoreError
from sumo_reactive.lab.batch.store import Store
from sumo_reactive.lab.batch.stored_results import Results, written
from sumo_reactive.show.batch_page import batch_page

DEEP = '{"a": ' + "[" * 20_000 + "]" * 20_000 + "}"


@pytest.fixture(scope="module")
def sound(tmp_path_factory):
    return made_store(tmp_path_factory.mktemp("store") / "made.duckdb")


@pytest.fixture
def store(sound, tmp_path):
    return shutil.copy(sound, tmp_path / "s.duckdb") and tmp_path / "s.duckdb"


def edited(path, *orders):
    """Change a store as whoever has DuckDB can."""
    with duckdb.connect(str(path)) as database:
        for order in orders:
            database.execute(order)


def replaced(table, definition):
    return f"DROP TABLE {table}; CREATE {definition}"


def as_table(table, column, kind):
    return (f"CREATE TABLE other AS SELECT * REPLACE ({column}::{kind} AS {column}) FROM {table}; DROP TABLE {table}; "
            f"ALTER TABLE other RENAME TO {table}")  # fmt: skip


EDITS = {
    "a view in place of a table": (replaced("metrics", "VIEW metrics AS SELECT 1 AS key"), "view"),
    "a view of a file": (replaced("trials", "VIEW trials AS SELECT * FROM read_text('/etc/passwd')"), "view 'trials'"),
    "a view beside the tables": ("CREATE VIEW mine AS SELECT 1", "a view 'mine'"),
    "a function in place of DuckDB's": ("CREATE MACRO count(x) AS 99", "a function 'count'"),
    "a type in place of DuckDB's": ("CREATE TYPE JSON AS ENUM ('a')", "a type"),
    "no table of events": ("DROP TABLE events", "no table 'events'"),
    "no table of metrics": ("DROP TABLE metrics", "no table 'metrics'"),
    "no version": ("DELETE FROM store", "version unknown"),
    "another version": ("UPDATE store SET version = 7", "version 7"),
    "a version in words": (
        as_table("store", "version", "VARCHAR") + "; UPDATE store SET version = repeat('9', 999)", "99999"),
    "two versions": ("INSERT INTO store VALUES (1)", "version"),
    "a seed in words": (as_table("trials", "seed", "VARCHAR"), "columns of 'trials'"),
    "a time in words": (as_table("events", "time_s", "VARCHAR"), "columns of 'events'"),
    "a column too few": ("ALTER TABLE trials DROP COLUMN replay", "columns of 'trials'"),
    "a column that computes": (
        replaced("plan", "TABLE plan (key VARCHAR PRIMARY KEY, number INTEGER AS (length(key)))"), "columns of 'plan'"),
    "no scenario": ("UPDATE trials SET scenario = NULL", "'trials' has a row"),
    "no seed": ("UPDATE trials SET seed = NULL", "'trials' has a row"),
    "no driver": ("UPDATE trials SET driver = ''", "'trials' has a row"),
    "another ending": ("UPDATE trials SET ending = '[bold]'", "'trials' has a row"),
    "parameters that are a list": ("UPDATE trials SET parameters = '[1]'", "'trials' has a row"),
    "options that nest deeply": (f"UPDATE trials SET options = '{DEEP}'", "are none"),
    "options with a huge number": ("UPDATE trials SET options = '{\"a\": ' || repeat('9', 9000) || '}'", "are none"),
    "a reason of a million letters": ("UPDATE trials SET reason = repeat('x', 1000000)", "'trials' has a row"),
    "a figure that is none": ("UPDATE metrics SET value = 'nan'", "'metrics' has a row"),
    "a figure that is infinite": ("UPDATE metrics SET value = '-inf'", "'metrics' has a row"),
    "a figure that overflows": ("UPDATE metrics SET value = 1e308", "'metrics' has a row"),
    "no place in the plan": ("UPDATE plan SET number = NULL", "'plan' has a row"),
    "a figure that nobody knows": ("UPDATE shown SET name = 'x\"); DROP TABLE plan; --'", "'shown' has a row"),
    "a group of edges without a name": ("INSERT INTO diagram VALUES ('a', '', 0, 1, 1, 1, 1)", "'diagram' has a row"),
    "a flow that is none": ("INSERT INTO diagram VALUES ('a', 'b', 0, 1, 'nan', 1, 1)", "'diagram' has a row"),
    "a density without a value": ("INSERT INTO diagram VALUES ('a', 'b', 0, 1, 1, NULL, 1)", "'diagram' has a row"),
    "a speed that overflows": ("INSERT INTO diagram VALUES ('a', 'b', 0, 1, 1, 1, 1e308)", "'diagram' has a row"),
    "a trip without a length": ("INSERT INTO departures VALUES ('a', 'b', 1.0, NULL)", "'departures' has a row"),
}  # fmt: skip


@pytest.mark.parametrize("how", EDITS)
def test_an_edited_store_is_refused_in_one_line(store, how):
    order, said = EDITS[how]
    edited(store, order)
    for use in (read, batch_page):
        with pytest.raises(StoreError) as raised:
            use(store)
        assert_one_line(raised, store, said)


def read(store):
    """Do with a store what `results` and `batch` do."""
    with Results(store) as found:
        found.groups(found.metrics([]))
        assert found.trials().rows and found.progress
    with Store(store) as kept:
        kept.without_result()
        kept.departures("key")


def assert_one_line(raised, store, said):
    line = str(raised.value)
    assert line.startswith(str(store)) and "\n" not in line and len(line) < len(str(store)) + 200, line
    assert said in line


@pytest.mark.parametrize(
    "order",
    ["UPDATE events SET entry = '[1]'", "UPDATE events SET entry = '{}'", f"UPDATE events SET entry = '{DEEP}'",
     "UPDATE events SET kind = NULL", "UPDATE events SET time_s = NULL"],
)  # fmt: skip
def test_an_event_that_is_none_is_told_by_the_page(store, order):
    edited(store, order)
    with pytest.raises(StoreError) as raised:
        batch_page(store)
    assert_one_line(raised, store, "of trial ")


def test_a_metric_with_a_quote_in_its_name_is_a_column(store):
    edited(store, "INSERT INTO metrics SELECT key, 'it''s \"here\"', 1.0 FROM trials")
    with Results(store) as found:
        assert 'it\'s "here"' in found.trials().columns


FILES = {
    "empty": lambda path: path.write_bytes(b""),
    "cut": lambda path: path.write_bytes(path.read_bytes()[: path.stat().st_size // 2]),
    "a head alone": lambda path: path.write_bytes(path.read_bytes()[:100]),
    "zeros": lambda path: path.write_bytes(bytes(path.stat().st_size)),
    "text": lambda path: path.write_text("[experiment]\n"),
    "a directory": lambda path: (path.unlink(), path.mkdir()),
    "a pipe": lambda path: (path.unlink(), os.mkfifo(path)),
    "a device": lambda path: (path.unlink(), path.symlink_to("/dev/zero")),
    "a link to nowhere": lambda path: (path.unlink(), path.symlink_to("nowhere")),
    "a link to itself": lambda path: (path.unlink(), path.symlink_to(path.name)),
    "a log that is a pipe": lambda path: os.mkfifo(f"{path}.wal"),
}


@pytest.mark.parametrize("how", FILES)
def test_a_damaged_file_is_refused_in_one_line(store, how):
    FILES[how](store)
    with pytest.raises(StoreError) as raised:
        read(store)
    assert_one_line(raised, store, "")


def test_a_store_that_another_process_writes_to_is_refused(store):
    code = f"import duckdb; held = duckdb.connect({str(store)!r}); print('held', flush=True); input()"
    with subprocess.Popen([sys.executable, "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as other:
        assert other.stdout.readline() == "held\n"
        with pytest.raises(StoreError, match=f"in use by process {other.pid}"):
            read(store)
        other.stdin.close()


def test_flipped_bytes_are_a_store_or_one_line(sound, tmp_path):
    draw, whole, path = random.Random(14), sound.read_bytes(), tmp_path / "s.duckdb"
    refused = 0
    for _ in range(30):
        damaged = bytearray(whole)
        for _ in range(draw.choice((1, 20, 400))):
            damaged[draw.randrange(len(damaged))] = draw.randrange(256)
        path.write_bytes(damaged)
        try:
            read(path)
        except StoreError as error:
            refused += 1
            assert "\n" not in str(error)
    assert refused > 5


QUERIES = [
    "SELECT nothing FROM trials", "SELECT", "(", "", " -- nothing", "SELECT 1; SELECT 2", "SELECT error('x')",
    "SELECT 'a'::INTEGER", "BEGIN", "DROP TABLE trials", "DELETE FROM trials", "CREATE TABLE mine AS SELECT 1",
    "UPDATE store SET version = 2", "SELECT * FROM read_text('/etc/passwd')", "SELECT * FROM '/etc/passwd'",
    "SELECT * FROM glob('/*')", "COPY trials TO 'stolen.csv'", "ATTACH 'new.duckdb'", "INSTALL httpfs", "LOAD spatial",
    "SET enable_external_access = true", "EXPORT DATABASE 'here'", "SELECT * FROM show", "\udcff", "SELECT 1" + "+1" * 5000,
]  # fmt: skip


@pytest.mark.parametrize("query", QUERIES)
def test_a_query_reads_the_store_alone_and_fails_in_one_line(store, tmp_path, monkeypatch, query):
    monkeypatch.chdir(tmp_path)
    before = store.read_bytes()
    with Results(store) as found, pytest.raises(StoreError) as raised:
        found.asked(query)
        raise StoreError(f"{store}: it gave nothing that could be shown")
    assert "\n" not in str(raised.value)
    with pytest.raises(StoreError):
        written(store, query or " ", tmp_path / "t.csv", "csv")
    assert store.read_bytes() == before and [path.name for path in tmp_path.iterdir()] == ["s.duckdb"]


def test_a_query_is_cut_and_cannot_steer_the_terminal(store, capsys, monkeypatch):
    monkeypatch.setattr("sumo_reactive.cli.results.MOST_ROWS", 3)
    show(store, sql="SELECT chr(27) || '[2J[bold]x' AS \"[red]a\", range FROM range(9)")
    said = capsys.readouterr().out
    assert "�[2J[bold]x" in said and "[red]a" in said and "\x1b" not in said
    assert "the first 3 rows" in said and len(said.splitlines()) < 9


@pytest.mark.parametrize("form", ["csv", "parquet"])
def test_a_table_is_written_whole_and_never_through_a_link(store, tmp_path, form):
    target, other = tmp_path / f"t.{form}", tmp_path / "other"
    other.write_text("mine")
    target.symlink_to(other)
    written(store, "SELECT key, seed FROM trials ORDER BY seed", target, form)
    assert other.read_text() == "mine" and not target.is_symlink()
    with duckdb.connect() as database:
        rows = database.execute(f"SELECT seed FROM read_{form}('{target}')").fetchall()
    assert [seed for (seed,) in rows] == sorted(seed for (seed,) in rows) and len(rows) == 15
    assert sorted(path.name for path in tmp_path.iterdir()) == ["other", "s.duckdb", target.name]


@pytest.mark.parametrize(("target", "said"), [("x" * 300, "too long"), ("pipe", "a pipe or a device")])
def test_a_table_that_cannot_be_written_is_one_line(store, tmp_path, target, said):
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(OutputError, match=said):
        written(store, None, tmp_path / target, "csv")
