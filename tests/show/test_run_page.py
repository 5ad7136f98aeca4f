"""The page of a run: what its figures are made from."""

from pathlib import Path

import numpy as np
import pytest
from helpers.recordings import made_record, step

from sumo_reactive.driver.geometry.polyline import Polyline
from sumo_reactive.driver.nouns.decision import Behaviour
from sumo_reactive.driver.world.lane import Lane
from sumo_reactive.errors import ScenarioError
from sumo_reactive.lab.fault import COLLISION, HARD_BRAKING, Fault
from sumo_reactive.show.faults import faults_in
from sumo_reactive.show.recording import read_run, read_steps
from sumo_reactive.show.reports import run_page
from sumo_reactive.show.run_map import RoadMap, closed, edges_of, map_figure, roads_of, views_of
from sumo_reactive.show.run_timeline import spans_of, timeline_figure
from sumo_reactive.sumo.net_reader import read_net

ROOT = Path(__file__).parents[2]
FOUR_WAY = ROOT / "scenarios" / "four_way_priority.toml"
HIT = Fault(1.5, COLLISION, "veh_<7>", "a_0")

STEPS = [
    *(step(k) for k in range(10)),
    *(step(k, Behaviour.CAUTIOUS, stop_s=30.0, leader="", gap=float("nan")) for k in range(10, 20)),
    *(step(k, Behaviour.CROSSING, lane_id=":J_0_0") for k in range(20, 25)),
    *(step(k, lane_id="b_0") for k in range(25, 30)),
]


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    folder = tmp_path_factory.mktemp("record") / "out"
    return read_run(made_record(folder, STEPS, {"a|b": [[20.0, 0.0], [24.0, 0.0], [24.0, 4.0]]}, faults=(HIT,)))


@pytest.fixture(scope="module")
def steps(recording):
    return read_steps(recording)


def trace(figure, name):
    (found,) = (one for one in figure.data if one.name == name)
    return found


def test_a_span_ends_where_the_next_begins(steps):
    spans = spans_of(steps)
    assert [(span.behaviour, span.start, span.end) for span in spans] == [
        (Behaviour.NORMAL, 0.0, 1.0),
        (Behaviour.CAUTIOUS, 1.0, 2.0),
        (Behaviour.CROSSING, 2.0, 2.5),
        (Behaviour.NORMAL, 2.5, 2.9),
    ]


def test_lanes_inside_junctions_are_on_no_edge_of_the_route(steps):
    assert edges_of(steps["lane_id"]) == ["a", "b"]


def test_the_way_to_a_stop_is_known_only_where_there_is_one(steps):
    ways = steps.difference("stop_m", "s_m")
    assert ways[9:12] == [None, 20.0, 19.0] and ways[20] is None


def test_faults_come_back_from_the_summary_in_order_of_time(tmp_path):
    faults = (Fault(3.0, COLLISION, "x", "l"), Fault(1.0, "red light", "", "l"), Fault(2.0, HARD_BRAKING, "y", "l"))
    made = made_record(tmp_path / "out", STEPS, faults=faults)
    assert faults_in(read_run(made).summary) == sorted(faults, key=lambda fault: fault.time)


def test_the_lines_over_time_are_the_columns_of_the_trajectory(recording, steps):
    figure = timeline_figure(steps, spans_of(steps), recording.entries, [HIT])
    assert list(trace(figure, "speed").x) == steps.times
    assert list(trace(figure, "desired speed").y) == steps["desired_speed_m_s"] == [12.0] * 30
    assert list(trace(figure, "gap to the leader").y) == [50.0] * 10 + [None] * 10 + [50.0] * 10
    terms = ("U₁ (valley of C)", "U₂ (moving obstacles)", "U₃ (speed)")
    assert [trace(figure, name).y[0] for name in terms] == [0.1, 0.2, 0.0]
    titles = [figure.layout[f"yaxis{k}"].title.text for k in (2, 3, 4)]
    assert titles == ["speed (m/s)", "way ahead (m)", "potential (–)"]
    assert figure.layout.xaxis4.title.text == "simulation time (s)"


def test_the_track_of_decisions_has_a_bar_a_span_and_a_mark_an_entry(recording, steps):
    figure = timeline_figure(steps, spans_of(steps), recording.entries, [HIT])
    bars, marks = trace(figure, "behaviour"), trace(figure, "decision")
    assert (list(bars.base), list(bars.y)) == ([0.0, 1.0, 2.0, 2.5], [span.behaviour.value for span in spans_of(steps)])
    assert list(marks.x) == [0.0, 1.0, 2.0, 2.5]
    assert "Cautious driving" in marks.text[1]
    assert "ran into veh_&lt;7&gt;" in trace(figure, "fault").text[0]


def test_the_map_shows_the_track_by_behaviour_the_region_and_the_fault(recording, steps):
    roads = RoadMap({"a_0": np.array([[0.0, 0.0], [30.0, 0.0], [30.0, 4.0], [0.0, 4.0]])}, {}, {})
    regions = {"a|b": [[20.0, 0.0], [24.0, 0.0], [24.0, 4.0]]}
    figure = map_figure(roads, regions, steps, spans_of(steps), recording.entries, [HIT])
    assert list(trace(figure, "cautious driving").x) == [*map(float, range(10, 21)), None]
    assert list(trace(figure, "lanes").x) == [0.0, 30.0, 30.0, 0.0, 0.0, None]
    assert list(trace(figure, "conflict region").x) == [20.0, 24.0, 24.0, 20.0, None]
    assert (list(trace(figure, "fault").x), figure.layout.yaxis.scaleanchor) == ([15.0], "x")
    assert (figure.layout.xaxis.title.text, figure.layout.yaxis.title.text) == ("x (m)", "y (m)")


def test_a_view_is_the_crossing_and_not_all_the_cautious_way_to_it(steps):
    whole, crossing = views_of(steps, spans_of(steps))
    assert whole.x == (-25.0, 54.0)
    assert (crossing.label, crossing.x) == ("crossing an intersection, 2.0 s", (-5.0, 50.0))


def test_no_area_makes_no_line():
    assert closed([]) == ([], [])


def test_the_outline_of_a_lane_is_as_wide_as_the_lane():
    lane = Lane(
        id="a_0", edge_id="a", index=0, spine=Polyline(np.array([[0.0, 0.0], [10.0, 0.0]])), length=10.0, width=3.0,
        speed_limit=13.9, allowed=frozenset(),
    )  # fmt: skip
    assert lane.outline.tolist() == [[0.0, 1.5], [10.0, 1.5], [10.0, -1.5], [0.0, -1.5]]


def test_the_roads_are_those_of_the_network_that_the_scenario_names(tmp_path):
    net = ROOT / "networks" / "four_way_priority" / "four_way_priority.net.xml"
    driven = [step(0, lane_id="from_south_0"), step(1, lane_id="to_west_0")]
    recorded = read_run(made_record(tmp_path / "out", driven, scenario=str(FOUR_WAY)))
    roads = roads_of(recorded, read_steps(recorded))
    assert roads.missing == "" and {"from_south_0", "to_west_0", "from_east_0"} <= set(roads.lanes)
    assert read_net(net).end_of("from_south") in roads.junctions


def test_without_the_network_the_page_says_so_and_is_drawn(recording):
    text = run_page(recording)
    assert "Drawn without the roads: a.toml: no such file." in text
    assert 'id="plot-map"' in text and 'id="plot-time"' in text


def test_a_page_escapes_names_and_holds_one_copy_of_the_library(recording):
    text = run_page(recording)
    assert text.count('data-kind="library"') == 1
    assert "veh_&lt;7&gt;" in text and "<7>" not in text.partition("<body>")[2]


@pytest.mark.parametrize("content", [b"", b"PAR1 and no more"])
def test_a_trajectory_that_is_none_is_one_line(tmp_path, content):
    made = made_record(tmp_path / "out", STEPS)
    (made / "trajectory.parquet").write_bytes(content)
    with pytest.raises(ScenarioError, match="not the trajectory of a run") as raised:
        run_page(read_run(made))
    assert "\n" not in str(raised.value)
