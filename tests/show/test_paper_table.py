"""Tables for papers: what they hold, and that each form is one that its readers take."""

import csv
from dataclasses import replace
from io import StringIO

import pytest
from helpers.stores import made_store, outcome, trial

from sumo_reactive.driver.parameters import USUAL
from sumo_reactive.errors import ScenarioError
from sumo_reactive.lab.batch.store import Store
from sumo_reactive.lab.comparison.record import CSV_FILE
from sumo_reactive.lab.drivers.choice import SUMO
from sumo_reactive.show.paper_table import TITLES, Format, table_of

DURATIONS = ("duration_s", "rms_jerk_m_s3")

COLUMNS = "scenario", "ego", "seed", "metric", "sumo", "reactive", "compared"


@pytest.fixture(scope="module")
def store(tmp_path_factory):
    return made_store(tmp_path_factory.mktemp("store") / "made.duckdb")


def compared(folder, *lines):
    """Write a comparison's pairs; return its folder."""
    rows = "\n".join(",".join(map(str, line)) for line in (COLUMNS, *lines))
    (folder / CSV_FILE).write_text(f"{rows}\n", encoding="utf-8")
    return folder


def pairs(n, metric="duration_s"):
    """Return the lines of `n` pairs in which this driver is 2 s, and a little, faster."""
    return [("a.toml", "ego", k, metric, 40.0 + k, 38.0 + 0.9 * k, 1) for k in range(n)]


def test_both_drivers_are_compared_over_the_pairs_of_a_store(store):
    (head, first, second) = csv.reader(StringIO(table_of(store, Format.CSV, DURATIONS)))
    row = dict(zip(head, first, strict=True))
    told = [row[name] for name in ("metric", "n", "sumo", "reactive", "difference")]
    assert told == ["duration_s", "6", "52.0", "44.0", "-8.0"]
    assert float(row["low"]) < -8.0 < float(row["high"]) < 0.0
    assert float(row["p"]) == 2 / 64 < float(row["corrected_p"])
    assert second[1] == "rms_jerk_m_s3"


def test_what_varies_in_a_batch_begins_a_part_of_the_table(tmp_path):
    ones = [trial(seed, SUMO) for seed in (1, 2)]
    for margin in (0.1, 0.3):
        varied = {"corridor_margin_m": margin}
        for one in (trial(seed, parameters=varied) for seed in (1, 2)):
            scenario = replace(one.task.scenario, parameters=USUAL.with_values(varied))
            ones.append(replace(one, task=replace(one.task, scenario=scenario)))
    with Store(tmp_path / "s.duckdb") as kept:
        kept.plan(ones, ["duration_s"])
        for k, one in enumerate(ones):
            kept.put(one, outcome(one, 30.0 + k // 2), 1)
    rows = list(csv.DictReader(StringIO(table_of(tmp_path / "s.duckdb", Format.CSV, ["duration_s"]))))
    told = [(row["varied"], row["difference"]) for row in rows]
    assert told == [("corridor_margin_m=0.1", "1.0"), ("corridor_margin_m=0.3", "2.0")]
    assert "| *corridor\\_margin\\_m=0.1* |" in table_of(tmp_path / "s.duckdb", Format.MARKDOWN, ["duration_s"])


def test_a_table_in_latex_has_as_many_cells_in_each_row_and_none_of_its_signs_unescaped(store):
    text = table_of(store, Format.LATEX, DURATIONS)
    body = text[text.index("\\toprule") : text.index("\\bottomrule")]
    rows = [line for line in body.splitlines() if "&" in line]
    assert len(rows) == 3 and {line.count("&") for line in rows} == {len(TITLES) - 1}
    assert all(line.endswith(r" \\") for line in rows)
    assert "RMS jerk (m/s$^3$)" in body and r"95 \% interval" in body and "³" not in body


@pytest.mark.parametrize(("n", "is_bold"), [(9, False), (10, True)])
def test_what_ten_pairs_show_beyond_doubt_is_bold(tmp_path, n, is_bold):
    folder = compared(tmp_path, *pairs(n))
    assert ("**" in table_of(folder, Format.MARKDOWN)) is is_bold
    assert (r"\textbf" in table_of(folder, Format.LATEX)) is is_bold


def test_only_pairs_that_can_be_compared_count(tmp_path):
    folder = compared(tmp_path, *pairs(3), ("a.toml", "ego", 9, "duration_s", 40.0, "", 0))
    (row,) = csv.DictReader(StringIO(table_of(folder, Format.CSV)))
    assert row["n"] == "3"


@pytest.mark.parametrize(
    ("lines", "says"),
    [
        ([("a.toml", "ego", 1, "bogus", 1.0, 2.0, 1)], r"comparison\.csv:2: not a metric with two numbers"),
        ([("a.toml", "ego", 1, "duration_s", "x", 2.0, 1)], r"comparison\.csv:2: not a metric with two numbers"),
        ([("a.toml", "ego", 1, "duration_s", "nan", 2.0, 1)], r"comparison\.csv:2: not a metric with two numbers"),
        ([("a.toml",)], "no trip that both drivers have driven"),
        ([], "no trip that both drivers have driven"),
    ],
)
def test_what_is_no_comparison_is_told_with_its_place(tmp_path, lines, says):
    with pytest.raises(ScenarioError, match=says):
        table_of(compared(tmp_path, *lines), Format.CSV)


def test_a_folder_without_a_comparison_and_an_unknown_metric_are_told(tmp_path, store):
    with pytest.raises(ScenarioError, match=r"comparison\.csv: no such file"):
        table_of(tmp_path, Format.CSV)
    (tmp_path / CSV_FILE).write_text("a,b\n1,2\n", encoding="utf-8")
    with pytest.raises(ScenarioError, match="not the pairs of a comparison: its first line lacks some of scenario"):
        table_of(tmp_path, Format.CSV)
    with pytest.raises(ScenarioError, match=r"unknown metric 'durations'.*duration_s"):
        table_of(store, Format.CSV, ["durations"])
