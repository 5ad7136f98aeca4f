"""The record of a run: complete or not there at all."""

import json
import math

import duckdb
import numpy as np
import pytest
from scenes import record, user

from sumo_reactive.driver.nouns.assessment import Assessment, Encounter, PlanOutcome
from sumo_reactive.driver.nouns.decision import Behaviour, Decision, Instruction, Occupancy, Reason, RegionState
from sumo_reactive.driver.nouns.event import Event, EventKind
from sumo_reactive.driver.nouns.record import Scene, StepRecord
from sumo_reactive.driver.world.regions import ConflictKind, ConflictRegion, Interval, PostConflictRegion
from sumo_reactive.driver.world.road_graph import RoadGraph
from sumo_reactive.errors import OutputError, ScenarioError
from sumo_reactive.lab.columns import COLUMNS
from sumo_reactive.lab.fault import COLLISION, Fault
from sumo_reactive.lab.recorder import Recorder
from sumo_reactive.lab.result import TrialResult, rows_of
from sumo_reactive.lab.trace import entries, entry_of, line_of, read_entries
from sumo_reactive.sumo.launch import OptionOverride

FILES = [
    "decisions.jsonl", "encounters.parquet", "regions.json", "summary.json", "surroundings.json", "trajectory.parquet",
    "users.parquet",
]  # fmt: skip


def result(**others):
    values = {
        "scenario": "a.sumocfg",
        "ego": "cab",
        "chosen": "as named",
        "seed": 42,
        "step_length_s": 0.1,
        "profile": "default",
        "arrived": True,
        "ended": "arrived",
        "begin_s": 0.0,
        "departure_s": 5.0,
        "end_s": 35.0,
        "time_loss_s": 3.0,
        "distance_m": 200.0,
        "length_m": 4.7,
        "width_m": 1.8,
        "figures": {"min_time_to_collision_s": math.inf, "collisions": 0},
    }
    return TrialResult(**(values | others))


def recorded(folder, **options):
    recorder = Recorder(folder, **options)
    for k in range(3):
        recorder.see(Scene(record(0.1 * k, x=float(k)), ()))
    recorder.write(result())


def test_the_exit_code_and_the_verdict_follow_from_what_happened():
    assert (result().exit_code, result().verdict) == (0, "arrived without a violation")
    hit = result(faults=(Fault(41.3, COLLISION, "veh_12", "a_0"),))
    assert (hit.exit_code, hit.verdict) == (1, "collision with veh_12 at 41.3 s")
    assert result(faults=(Fault(3.0, "red light run", "", "a_0"),)).verdict == "red light run at 3.0 s"
    assert result(arrived=False, ended="until 60 s").verdict == "did not arrive (until 60 s)"


def test_the_rows_name_verdict_and_overrides():
    rows = dict(rows_of(result(overrides=(OptionOverride("random", "true", "false"),))))
    assert rows["ego"] == "cab (as named)"
    assert rows["override random"] == "true → false"


def world(*region_ids):
    """Return a world of square conflict regions and nothing else."""
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.23456]])
    where = {"own": Interval(0.0, 1.0), "other": Interval(0.0, 1.0), "polygon": square}
    meeting = {"kind": ConflictKind.CROSSING, "own_id": "a", "other_id": "b"} | where
    regions = {name: ConflictRegion(id=name, **meeting, post=PostConflictRegion("a", 1.0, name)) for name in region_ids}
    return RoadGraph(
        lanes={}, edge_lanes={}, junctions={}, connections={}, regions=regions, arcs=(), opposite={}, left_hand=False
    )


def test_the_rows_tell_how_many_steps_needed_no_pilot():
    rows = dict(rows_of(result(figures={"pilot_free_share": 0.9312})))
    assert rows["steps without the pilot"] == "0.93"


def test_the_outlines_of_the_regions_that_steps_name_are_written_once(tmp_path):
    waits = Decision(behaviour=Behaviour.CAUTIOUS, reason=Reason.YIELD_TO, region="decided", cause="veh_12")
    recorder = Recorder(tmp_path / "out")
    steps = record(0.0, decisions=(waits,)), record(0.1, regions=(RegionState("claimed", Occupancy.CLAIMED, "veh_12"),))
    for step, known in zip(steps, (world("decided"), world("claimed", "elsewhere")), strict=True):
        recorder.see(Scene(step, (), world=known))
    recorder.write(result())
    outlines = json.loads((tmp_path / "out" / "regions.json").read_text(encoding="utf-8"))
    square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.235]]
    assert outlines == {"decided": square, "claimed": square}


def test_a_record_has_its_files_and_nothing_beside_them(tmp_path):
    recorded(tmp_path / "deep" / "out")
    assert [path.name for path in (tmp_path / "deep").iterdir()] == ["out"]
    names = sorted(path.name for path in (tmp_path / "deep" / "out").iterdir())
    assert names == FILES
    summary = json.loads((tmp_path / "deep" / "out" / "summary.json").read_text(encoding="utf-8"))
    assert (summary["exit_code"], summary["duration_s"]) == (0, 30.0)
    assert summary["figures"]["min_time_to_collision_s"] is None


def test_the_trajectory_has_a_row_a_step_and_a_column_a_field(tmp_path):
    elsewhere = {"decisions", "events", "assessment", "regions", "reason", "constraints", "rooms"}
    assert set(COLUMNS) == set(StepRecord._fields) - elsewhere
    recorded(tmp_path / "it's")
    table = duckdb.read_parquet(str(tmp_path / "it's" / "trajectory.parquet"))
    assert table.columns == list(COLUMNS.values())
    assert table.select("time_s, x_m, lane_id, gap_m").fetchall()[1] == (0.1, 1.0, "road_0", None)


def test_a_run_without_steps_can_be_recorded(tmp_path):
    Recorder(tmp_path / "out").write(result(arrived=False))
    assert duckdb.read_parquet(str(tmp_path / "out" / "trajectory.parquet")).fetchall() == []


@pytest.mark.parametrize("name", ["trajectory", "encounters", "users"])
def test_a_column_has_the_same_type_whether_its_driver_has_it_or_not(tmp_path, name):
    recorded(tmp_path / "ours")
    Recorder(tmp_path / "none").write(result(arrived=False))
    plain = Recorder(tmp_path / "plain")
    plain.see(Scene(StepRecord(0.1, 1.0, 2.0, 0.0, 3.0, "a_0"), ()))
    plain.write(result())
    files = [str(tmp_path / folder / f"{name}.parquet") for folder in ("ours", "none", "plain")]
    ours, none, plain = ([(one[0], one[1]) for one in duckdb.sql(f"DESCRIBE FROM '{file}'").fetchall()] for file in files)
    assert ours == none == plain
    assert "NULL" not in str(ours)


def test_another_run_is_kept_unless_overwriting_is_asked_for(tmp_path):
    recorded(tmp_path / "out")
    (tmp_path / "out" / "tripinfo.xml").touch()
    with pytest.raises(ScenarioError, match="holds another run"):
        recorded(tmp_path / "out")
    recorded(tmp_path / "out", overwrite=True)
    assert (tmp_path / "out" / "tripinfo.xml").exists()


def test_overwriting_leaves_nothing_of_the_run_before(tmp_path):
    recorded(tmp_path / "out")
    (tmp_path / "out" / "report.html").write_text("the run before", encoding="utf-8")
    recorded(tmp_path / "out", overwrite=True)
    names = sorted(path.name for path in (tmp_path / "out").iterdir())
    assert names == FILES


def test_an_empty_folder_is_fine_and_a_file_is_not(tmp_path):
    (tmp_path / "empty").mkdir()
    recorded(tmp_path / "empty")
    (tmp_path / "file").touch()
    with pytest.raises(OutputError, match="a file, not a folder"):
        Recorder(tmp_path / "file")
    with pytest.raises(OutputError, match="cannot be written"):
        Recorder(tmp_path / "file" / "out")


def test_a_record_that_fails_leaves_nothing(tmp_path):
    recorder = Recorder(tmp_path / "out")
    with pytest.raises(TypeError):
        recorder.write(result(figures={"x": object()}))
    assert list(tmp_path.iterdir()) == []


def test_decisions_are_written_where_they_change_and_where_an_emergency_begins():
    red = Decision(behaviour=Behaviour.CAUTIOUS, reason=Reason.RED_LIGHT, region="r", cause="tl", figures=(("gap_m", 10.0),))
    nearer = Decision(
        behaviour=Behaviour.CAUTIOUS, reason=Reason.RED_LIGHT, region="r", cause="tl", figures=(("gap_m", 9.0),)
    )
    steps = [
        record(0.0),
        record(0.1, decisions=(red,)),
        record(0.2, decisions=(nearer,)),
        record(0.3, decisions=(nearer,), emergency=True),
        record(0.4, decisions=(nearer,), emergency=True),
        record(0.5),
    ]
    lines = [line_of(entry) for entry in entries(steps)]
    assert [line["time_s"] for line in lines] == [0.0, 0.1, 0.3, 0.5]
    assert lines[1]["decisions"][0]["reason"] == "the light is red"
    assert [line.get("emergency") for line in lines] == [None, None, True, None]


def test_another_instruction_begins_another_line():
    steps = [record(0.0), record(0.1, instruction="pull out and pass"), record(0.2, instruction="return to C")]
    assert [entry.instruction for entry in entries(steps)][1:] == [Instruction.OVERTAKE, Instruction.RETURN]


def test_a_line_holds_the_events_of_the_last_activation():
    light = Event(EventKind.LIGHT_CHANGE, "tl")
    steps = [record(0.0, events=(light,), pilot=True), record(0.1, emergency=True)]
    assert [entry.events for entry in entries(steps)] == [(light,), (light,)]


def test_a_line_gives_back_the_entry_that_it_was_made_of(tmp_path):
    figures = (("arrival_s", math.inf),)
    yields = Decision(behaviour=Behaviour.CAUTIOUS, reason=Reason.YIELD_TO, region="r", cause="veh_12", figures=figures)
    step = record(
        1.5,
        behaviour="cautious driving",
        instruction="stop at the place named",
        emergency=True,
        events=(Event(EventKind.NEW_OBSTACLE, "veh_12"), Event(EventKind.STANDSTILL)),
        assessment=Assessment(PlanOutcome.FAILURE, 2.5, 80.0, Encounter("veh_12", 4.5, 30.0, 1.0, 2.0)),
        decisions=(yields,),
        regions=(RegionState("r", Occupancy.OCCUPIED, "veh_12"),),
    )
    (entry,) = entries([step])
    line = json.dumps(line_of(entry), allow_nan=False)
    assert entry_of(json.loads(line)) == entry
    path = tmp_path / "decisions.jsonl"
    path.write_text(line + "\n", encoding="utf-8")
    assert read_entries(path) == (entry,)


def test_a_record_in_which_a_turn_in_several_moves_was_a_crossing_is_read_still(tmp_path):
    turn = Decision(behaviour=Behaviour.CROSSING, reason=Reason.NARROW_TURN, cause="3 moves", passes=True)
    (entry,) = entries([record(1.5, behaviour="crossing an intersection", instruction="follow C", decisions=(turn,))])
    path = tmp_path / "decisions.jsonl"
    path.write_text(json.dumps(line_of(entry)) + "\n", encoding="utf-8")
    assert '"behaviour": "crossing an intersection", "reason": "the road is too narrow' in path.read_text(encoding="utf-8")
    assert read_entries(path) == (entry,)


@pytest.mark.parametrize(
    ("line", "complaint"),
    [
        ('{"time_s": 1.0}', "1: not a record of this release: key 'events' is missing"),
        ("[1]", "1: not a record"),
        ("{", "1: not a record"),
    ],
)
def test_a_line_of_another_kind_is_refused_with_its_place(tmp_path, line, complaint):
    path = tmp_path / "decisions.jsonl"
    path.write_text(line, encoding="utf-8")
    with pytest.raises(ScenarioError, match=f"jsonl:{complaint}"):
        read_entries(path)


def test_the_encounters_are_a_row_a_pair_and_step_with_every_measure(tmp_path):
    """At 15 m/s behind one at 5 m/s, 50 m away; another comes from behind, a third is beside, a fourth far off."""
    others = (
        user("ahead", x=55.0, speed=5.0), user("behind", x=-20.0, speed=15.0), user("beside", y=2.4, speed=15.0),
        user("elsewhere", y=30.0, speed=15.0),
    )  # fmt: skip
    recorder = Recorder(tmp_path / "out")
    for k in range(2):
        recorder.see(Scene(record(0.1 * k, speed=15.0), others))
    recorder.write(result(length_m=5.0, width_m=1.8))
    found = duckdb.read_parquet(str(tmp_path / "out" / "encounters.parquet"))
    rows = [dict(zip(found.columns, row, strict=True)) for row in found.fetchall()]
    assert [(row["time_s"], row["user_id"], row["relation"]) for row in rows[3:]] == [
        (0.1, "ahead", "ahead"), (0.1, "behind", "behind"), (0.1, "beside", "beside"),
    ]  # fmt: skip
    ahead, behind, beside = rows[3:]
    assert (ahead["gap_m"], ahead["time_to_collision_s"], ahead["ttc_along_s"], ahead["drac_m_s2"]) == (50.0, 5.0, 5.0, 1.0)
    assert (behind["gap_m"], behind["ttc_along_s"], behind["drac_m_s2"]) == (15.0, None, 0.0)
    assert behind["rss_distance_m"] == pytest.approx(15.0 * 2.0 + 0.5 * 3.5 * 4.0 + 22.0**2 / 8.0 - 15.0**2 / 16.0)
    assert beside["lateral_gap_m"] == pytest.approx(0.6)
    assert (beside["gap_m"], beside["drac_m_s2"]) == (None, None)
    assert beside["rss_margin_m"] == pytest.approx(0.6 - 0.725)


def test_who_follows_the_ego_has_the_modified_ttc_of_his_own_acceleration(tmp_path):
    """He gains 0.2 m/s in a step of 0.1 s, and so 2 m/s², at the ego's speed then: 16 m are used up after 4 s."""
    recorder = Recorder(tmp_path / "out")
    for k, speed in enumerate((9.8, 10.0)):
        recorder.see(Scene(record(0.1 * k, speed=10.0), (user(x=-21.0, speed=speed),)))
    recorder.write(result(length_m=5.0, width_m=1.8))
    found = duckdb.read_parquet(str(tmp_path / "out" / "encounters.parquet"))
    rows = found.project("relation, modified_ttc_s").fetchall()
    assert rows[1] == ("behind", pytest.approx(4.0))
