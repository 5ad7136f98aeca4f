"""Records that somebody has edited or damaged: one line that names the file and the key, for every reader."""

from __future__ import annotations

import json
from types import SimpleNamespace

import duckdb
import pytest
from helpers.recordings import made_record, step
from pydantic import TypeAdapter

from sumo_reactive.driver.nouns.decision import Behaviour, Decision, Reason
from sumo_reactive.errors import ScenarioError
from sumo_reactive.lab.schema import Number
from sumo_reactive.show import recording
from sumo_reactive.show.explain import moment, story
from sumo_reactive.show.recording import read_run
from sumo_reactive.show.reports import page_of

YIELD = Decision(
    behaviour=Behaviour.CAUTIOUS, reason=Reason.YIELD_TO, region="r", cause="van", passes=False,
    figures=(("arrival_s", 1.0), ("clearance_s", 2.0), ("foe_arrival_s", 1.5), ("foe_clearance_s", 3.0)),
)  # fmt: skip
STEPS = [step(0), step(1, Behaviour.CAUTIOUS, decisions=(YIELD,)), step(2)]


def read_by_all(folder):
    """Read a record in every way there is; return what each made of it."""
    return [*story(read_run(folder)), *moment(read_run(folder), 0.15), page_of(folder, folder / "report.html")]


@pytest.fixture
def record(tmp_path):
    return made_record(tmp_path / "out", STEPS, regions={"r": [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]})


def refused(record):
    with pytest.raises(ScenarioError) as raised:
        read_by_all(record)
    assert "\n" not in str(raised.value)
    return str(raised.value)


def test_an_undamaged_record_is_read(record):
    assert all(read_by_all(record))


@pytest.mark.parametrize(
    ("path", "value", "says"),
    [
        (("ego",), 5, "summary.json: not the summary of a run: key 'ego'"),
        (("verdict",), "", "key 'verdict'"),
        (("figures",), [], "key 'figures'"),
        (("figures", "standstill_s"), "long", "key 'figures.standstill_s'"),
        (("seed",), {}, "key 'seed'"),
        (("end_s",), "[bold]", "key 'end_s'"),
        (("end_s",), float("nan"), "key 'end_s'"),
        (("departure_s",), 1e300, "key 'departure_s'"),
        (("collisions",), {"a": 1}, "key 'collisions'"),
        (("collisions",), [1], "key 'collisions.0'"),
        (("violations",), [{"time_s": 1.0, "user_id": "a", "lane_id": "b"}], "key 'violations.0.kind' is missing"),
        (("hard_brakes",), [{"time_s": None, "user_id": "a", "lane_id": "b"}], "key 'hard_brakes.0.time_s'"),
    ],
)
def test_a_summary_of_other_types_is_refused(record, path, value, says):
    summary = json.loads((record / "summary.json").read_text(encoding="utf-8"))
    place = summary
    for key in path[:-1]:
        place = place[key]
    place[path[-1]] = value
    (record / "summary.json").write_text(json.dumps(summary), encoding="utf-8")
    assert says in refused(record)


@pytest.mark.parametrize(
    ("path", "value", "says"),
    [
        (("time_s",), "soon", "decisions.jsonl:2: not a record of this release: key 'time_s'"),
        (("behaviour",), "flying", "key 'behaviour'"),
        (("events",), None, "key 'events'"),
        (("assessment",), [], "key 'assessment'"),
        (("assessment", "lateness_s"), True, "key 'assessment.lateness_s'"),
        (("decisions", 0, "cause"), 7, "key 'decisions.0.cause'"),
        (("decisions", 0, "reason"), "whim", "key 'decisions.0.reason'"),
        (("decisions", 0, "figures"), {"foe_arrival_s": 1.0}, "'foe_arrival_s' without 'arrival_s'"),
        (("decisions", 0, "figures", "arrival_s"), [], "key 'decisions.0.figures.arrival_s'"),
        (("regions",), [{"region": "r", "state": "mine", "user": ""}], "key 'regions.0.state'"),
    ],
)
def test_decisions_of_other_types_are_refused(record, path, value, says):
    lines = [json.loads(line) for line in (record / "decisions.jsonl").read_text(encoding="utf-8").splitlines()]
    place = lines[1]
    for key in path[:-1]:
        place = place[key]
    place[path[-1]] = value
    (record / "decisions.jsonl").write_text("\n".join(map(json.dumps, lines)), encoding="utf-8")
    assert says in refused(record)


@pytest.mark.parametrize("name", ["summary.json", "decisions.jsonl", "regions.json"])
@pytest.mark.parametrize("text", ["", "[", "null", "7", '"x"', '{"a":' * 30_000, "[" * 30_000, "\x00", "{}{}"])
def test_what_is_no_record_is_refused(record, name, text):
    (record / name).write_text(text, encoding="utf-8")
    if text == "" and name == "decisions.jsonl":
        assert "nothing was decided" in refused(record)
    else:
        assert f"{name}" in refused(record)


@pytest.mark.parametrize("outline", [[], [[0.0]], [[0.0, None]], [[0.0, "x"]], "x", {"x": 1}, [[0.0, 1e300]]])
def test_regions_of_other_shapes_are_refused(record, outline):
    (record / "regions.json").write_text(json.dumps({"r": outline}), encoding="utf-8")
    assert "not the regions of a run" in refused(record)


@pytest.mark.parametrize(
    ("column", "value"),
    [
        ("time_s", "'soon'"), ("time_s", "NULL"), ("x_m", "'nan'::DOUBLE"), ("speed_m_s", "1e300"), ("lane_id", "5"),
        ("behaviour", "'flying'"), ("emergency", "'maybe'"), ("lane_id", "NULL"), ("gap_m", "[1.0]"), ("u", "'inf'::DOUBLE"),
        ("time_s", "DATE '2020-01-01'"),
    ],
)  # fmt: skip
def test_a_trajectory_of_other_types_is_refused(record, column, value):
    path = record / "trajectory.parquet"
    with duckdb.connect() as database:
        database.execute(f"CREATE TABLE t AS SELECT * REPLACE ({value} AS {column}) FROM '{path}'")
        database.execute(f"COPY t TO '{path}' (FORMAT PARQUET)")
    assert f"trajectory.parquet: not the trajectory of a run: column '{column}'" in refused(record)


@pytest.mark.parametrize("text", ["", "PAR1", "PAR1" * 500])
def test_what_is_no_trajectory_is_refused(record, text):
    (record / "trajectory.parquet").write_text(text, encoding="utf-8")
    assert "not the trajectory of a run" in refused(record)


@pytest.mark.parametrize(
    "fleet",
    ["[]", "{", '{"egos": []}', '{"egos": [5], "refused": []}', '{"egos": [{"ego": "a", "verdict": 1}], "refused": []}',
     '{"egos": [{"ego": "a", "verdict": "b", "duration_s": "x"}], "refused": []}', '{"egos": [], "refused": [{}]}'],
)  # fmt: skip
def test_what_is_no_record_of_several_egos_is_refused(tmp_path, fleet):
    (tmp_path / "fleet.json").write_text(fleet, encoding="utf-8")
    with pytest.raises(ScenarioError, match=r"fleet\.json: not the record of several egos"):
        page_of(tmp_path, tmp_path / "report.html")


def test_a_count_stays_a_whole_number():
    assert [repr(TypeAdapter(Number).validate_json(text)) for text in ("86", "86.5")] == ["86", "86.5"]


def test_names_in_a_parquet_file_that_are_no_text_are_told_in_one_line(tmp_path, monkeypatch):
    def raised(*_):
        raise RuntimeError("nanobind::str(): conversion error!")

    monkeypatch.setattr(recording, "parquet_rows", raised)
    with pytest.raises(ScenarioError, match=r"trajectory\.parquet: not the trajectory of a run: nanobind"):
        recording.columns_of(SimpleNamespace(folder=tmp_path), ("time_s",))
