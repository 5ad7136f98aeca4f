"""Files that somebody else may have written: read as what they are, and nothing besides."""

import os
from pathlib import Path

import duckdb
import pytest

from sumo_reactive.errors import InputError
from sumo_reactive.lab.tables import opened, parquet_rows, require_regular

NAME = "steps.parquet"


def written(folder, told):
    """Write a table that tells what it is into a folder."""
    folder.mkdir(parents=True)
    with duckdb.connect() as database, pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        database.execute(f"COPY (SELECT '{told}' AS told) TO '{NAME}' (FORMAT parquet)")
    return folder / NAME


@pytest.mark.parametrize("pattern", ["out[1]", "out*", "out?", "o[!x]t1", "**", "{out1,out2}", "it's out", "out[", "[]"])
def test_a_path_is_never_a_pattern(tmp_path, pattern):
    written(tmp_path / "out1", "another")
    assert parquet_rows(written(tmp_path / pattern, "the one"), "SELECT told FROM steps", 1) == [("the one",)]


def test_a_relative_path_is_read_from_here(tmp_path, monkeypatch):
    path = written(tmp_path / "out[1]", "the one")
    monkeypatch.chdir(path.parent)
    assert parquet_rows(path.relative_to(path.parent), "SELECT told FROM steps", 1) == [("the one",)]


def test_a_query_reads_no_other_file(tmp_path):
    other, path = written(tmp_path / "other", "secret"), written(tmp_path / "out", "the one")
    with pytest.raises(duckdb.Error, match="disabled by configuration"):
        parquet_rows(path, f"SELECT * FROM read_parquet('{other}')", 1)


def test_more_rows_than_asked_for_are_refused(tmp_path):
    with pytest.raises(InputError, match=r"steps\.parquet: more than 1 rows"):
        parquet_rows(written(tmp_path / "out", "one"), "SELECT * FROM steps, range(5)", 1)


@pytest.mark.parametrize(
    "order",
    ["SELECT * FROM read_text('secret.txt')", "COPY (SELECT 1) TO 'new.csv'", "ATTACH 'new.duckdb'", "LOAD httpfs",
     "INSTALL spatial", "SET enable_external_access = true", "SET allowed_paths = ['secret.txt']", "SELECT * FROM present"],
)  # fmt: skip
def test_a_sealed_database_opens_nothing_else(tmp_path, monkeypatch, order):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "secret.txt").write_text("secret")
    present = duckdb.sql("SELECT 1")
    for files in ((), (str(tmp_path / "out.csv"),)):
        with opened(Path("store.duckdb"), files=files) as database, pytest.raises(duckdb.Error):
            database.execute(order)
    assert present and {path.name for path in tmp_path.iterdir()} <= {"secret.txt", "store.duckdb", "store.duckdb.wal"}


def test_what_is_no_regular_file_is_told_and_never_opened(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "large").write_bytes(b"12345")
    (tmp_path / "loop").symlink_to("loop")
    told = {
        tmp_path / "pipe": "a pipe, not a file", tmp_path: "a directory", tmp_path / "none": "no such file",
        tmp_path / "large": "more than", tmp_path / ("x" * 300): "too long", tmp_path / "loop": "symbolic links",
    }  # fmt: skip
    for path, words in told.items():
        with pytest.raises(InputError, match=words):
            require_regular(path, 4)
