"""A session with SUMO in this process; what it says when SUMO does not start: one line, in SUMO's own words."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import libsumo
import pytest
from net_recipes import converted
from simulations import vehicle

from sumo_reactive.errors import ScenarioError, SimulationError
from sumo_reactive.sumo.session import Session, is_road_car, sumo_version, type_of

START = """
import sys
from sumo_reactive.errors import ScenarioError
from sumo_reactive.sumo.session import Session
try:
    with Session(["-c", sys.argv[1]]):
        pass
except ScenarioError as error:
    print(error)
"""
"""A process for each: libsumo may crash when it is started again after a start that failed."""

NET = Path(__file__).parents[2] / "networks" / "roundabout" / "roundabout.net.xml"


@pytest.mark.parametrize(
    ("configuration", "said"),
    [
        ("<no-such-option value='1'/>", "No option with the name 'no-such-option' exists."),
        (f"<net-file value='{NET}'/><route-files value='a.rou.xml'/>", "a.rou.xml' At line"),
    ],
)
def test_what_sumo_cannot_read_is_named_in_one_line(tmp_path, configuration, said):
    (tmp_path / "a.sumocfg").write_text(f"<configuration>{configuration}</configuration>", encoding="utf-8")
    (tmp_path / "a.rou.xml").write_text("<routes><vehicle", encoding="utf-8")
    command = [sys.executable, "-c", START, str(tmp_path / "a.sumocfg")]
    found = subprocess.run(command, check=True, capture_output=True, text=True, timeout=60)
    assert found.stderr == ""
    assert found.stdout.count("\n") == 1
    assert said in found.stdout


CARS = vehicle("early", "in out", depart=1) + vehicle("late", "in out", depart=4)
PERSON = '<person id="walker" depart="0"><walk edges="in" arrivalPos="5"/></person>'


@pytest.fixture
def road(tmp_path):
    """A road from the west to the east."""
    nodes = '<nodes><node id="a" x="0" y="0"/><node id="b" x="100" y="0"/><node id="c" x="200" y="0"/></nodes>'
    edges = '<edges><edge id="in" from="a" to="b"/><edge id="out" from="b" to="c"/></edges>'
    return converted(tmp_path, nodes, edges)


def session(folder, net, content, *options):
    """A session with a step of a second."""
    routes = folder / "r.rou.xml"
    routes.write_text(f"<routes>{content}</routes>", encoding="utf-8")
    return Session(["-n", str(net), "-r", str(routes), "--no-step-log", "--no-warnings", *options])


def test_a_session_knows_the_time_and_its_step_and_ends(tmp_path, road):
    with session(tmp_path, road, CARS, "--begin", "1", "--step-length", "0.5") as running:
        assert (running.time, running.step_length) == (1.0, 0.5)
        running.step()
        assert running.time == 1.5
    assert not libsumo.isLoaded()


def test_it_waits_for_who_is_wanted_and_tells_how_far_it_is(tmp_path, road):
    told = []
    with session(tmp_path, road, CARS) as running:
        found = running.wait_for(lambda name: name == "late", None, lambda *what: told.append(what), "late")
        assert (found, running.time) == ("late", 5.0)
        assert running.departed == ("late",)
    assert told == [(float(k), "waiting for the ego to depart") for k in range(1, 5)]


def test_the_first_who_departs_is_found_if_anybody_will_do(tmp_path, road):
    with session(tmp_path, road, CARS) as running:
        assert running.wait_for(lambda name: True, None, None) == "early"


@pytest.mark.parametrize(
    ("name", "why"),
    [
        ("late", "ego 'late' never departs before 3.0 s, where the run ends"),
        ("nobody", "unknown ego 'nobody': no such vehicle until 3.0 s, where the run ends"),
    ],
)
def test_who_does_not_depart_until_the_run_ends_is_told_with_the_reason(tmp_path, road, name, why):
    with session(tmp_path, road, CARS) as running:
        assert running.wait_for(lambda one: one == name, 3.0, None, name) == ""
        assert running.why_not(name) == why


def test_a_pedestrian_is_no_ego(tmp_path, road):
    told = pytest.raises(ScenarioError, match=r"^ego 'walker' is not a road car: it is a pedestrian$")
    with session(tmp_path, road, PERSON + CARS) as running, told:
        running.wait_for(lambda one: one == "walker", None, None, "walker")


@pytest.mark.parametrize(("end", "until"), [("7", None), ("50", 7.0)])
def test_a_run_is_played_out_to_its_end_or_the_scenarios(tmp_path, road, end, until):
    told = []
    with session(tmp_path, road, CARS, "--end", end) as running:
        running.play_out(until, lambda *what: told.append(what))
        assert running.time == 7.0
        assert running.is_over() is (until is None)
    assert told == [(float(k), "playing out") for k in range(1, 8)]


def test_a_scenario_is_over_when_nobody_is_left_or_to_come(tmp_path, road):
    with session(tmp_path, road, CARS) as running:
        assert not running.is_over()
        running.play_out(None, None)
        assert running.is_over() and 15.0 < running.time < 60.0


def test_stand_ins_do_not_count_as_departed(tmp_path, road):
    with session(tmp_path, road, vehicle("reactive.ghost.a.1", "in out") + vehicle("a", "in out", departPos=50)) as running:
        running.step()
        assert running.departed == ("a",)


def test_a_vehicle_tells_its_type_and_whether_it_is_a_road_car(tmp_path, road):
    kinds = '<vType id="bike" vClass="bicycle"/><vType id="van" vClass="delivery"/>'
    cars = vehicle("a", "in out", type="bike", departPos=20) + vehicle("b", "in out", type="van", departPos=50)
    with session(tmp_path, road, kinds + cars) as running:
        running.step()
        assert [(type_of(name), is_road_car(name)) for name in "ab"] == [("bike", False), ("van", True)]
        assert sumo_version().startswith("SUMO 1.")


def test_what_stops_sumo_under_way_is_told_with_the_time(tmp_path, road, monkeypatch):
    def fail():
        raise libsumo.TraCIException("  \n the third thing\nmore")

    failure = pytest.raises(SimulationError, match=r"^SUMO failed at 1\.0 s: the third thing$")
    with failure, session(tmp_path, road, CARS) as running:
        running.step()
        monkeypatch.setattr(libsumo, "simulationStep", fail)
        running.step()
