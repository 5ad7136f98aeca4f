"""How SUMO is started: without a window, files where they were, harm visible, the user's options last."""

import os
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from dataclasses import replace
from pathlib import Path

import libsumo
import pytest

from sumo_reactive.errors import ScenarioError
from sumo_reactive.sumo.config import LEFT_OUT, read_config
from sumo_reactive.sumo.launch import chosen_step_length, runnable_config, sumo_arguments
from sumo_reactive.sumo.vehicle_type import arrival_of, may_say_arrivals

ROUNDABOUT = Path(__file__).parents[2] / "networks" / "roundabout"


def scenario(folder, inner=""):
    """Write a configuration that uses the roundabout's network and traffic."""
    files = {"net-file": "roundabout.net.xml", "route-files": "roundabout.rou.xml"}
    lines = "".join(f'<{option} value="{ROUNDABOUT / name}"/>' for option, name in files.items())
    path = folder / "a.sumocfg"
    path.write_text(f"<configuration>{lines}<end value='2'/>{inner}</configuration>", encoding="utf-8")
    return read_config(path)


def test_a_configuration_without_a_window_is_used_as_it_is(tmp_path):
    config = scenario(tmp_path)
    assert runnable_config(config) == (config.path, ())


def test_what_needs_a_window_and_missing_drawings_are_left_out_and_named(tmp_path):
    (tmp_path / "stops.add.xml").write_text("<additional/>", encoding="utf-8")
    inner = (
        '<additional-files value="stops.add.xml, osm.poly.xml"/><gui-settings-file value="osm.view.xml"/>'
        '<osg-view value="true"/><tripinfo-output value="out/trips.xml"/><log value="stdout"/>'
    )
    options, left_out = runnable_config(scenario(tmp_path, inner))
    assert options["additional-files"] == str(tmp_path / "stops.add.xml")
    assert options["tripinfo-output"] == str(tmp_path / "out" / "trips.xml")
    assert options["log"] == "stdout"
    assert [name for name, _, _ in left_out] == ["gui-settings-file", "osg-view", "additional-files"]


def test_a_missing_file_that_matters_is_an_error(tmp_path):
    with pytest.raises(ScenarioError, match=r"lights\.add\.xml: no such file"):
        runnable_config(scenario(tmp_path, '<additional-files value="lights.add.xml"/>'))


def test_sumo_runs_without_what_is_left_out_and_writes_beside_the_original(tmp_path):
    inner = (
        '<additional-files value="osm.poly.xml"/><gui-settings-file value="a.view.xml"/><summary-output value="sum.xml"/>'
    )
    config = scenario(tmp_path, inner)
    options, _ = runnable_config(config)
    arguments, _ = sumo_arguments(config, options, seed=17, step_length_s=0.1)
    libsumo.start(["sumo", *arguments])
    try:
        libsumo.simulationStep()
        assert libsumo.simulation.getDeltaT() == pytest.approx(0.1)
        assert (libsumo.simulation.getOption("seed"), libsumo.simulation.getOption("random")) == ("17", "false")
    finally:
        libsumo.close()
    assert (tmp_path / "sum.xml").exists()


def test_overrides_are_named_where_they_change_what_the_scenario_says(tmp_path):
    inner = (
        '<random value="true"/><collision.action v="warn"/><ignore-junction-blocker value="20"/><seed value="7"/>'
        '<collision.check-junctions value="1"/>'
    )
    config = scenario(tmp_path, inner)
    arguments, changed = sumo_arguments(config, config.path, seed=42, step_length_s=0.1)
    assert set(changed) == {
        ("random", "true", "false"),
        ("ignore-junction-blocker", "20", "-1"),
        ("seed", "7", "42"),
        ("step-length", "1", "0.1"),
        ("collision.mingap-factor", "-1", "0"),
    }
    assert arguments[arguments.index("--collision.action") + 1] == "warn"
    assert "--no-warnings" in arguments
    assert arguments[arguments.index("--remote-port") + 1] == "0"


def test_sumo_waits_for_no_client(tmp_path):
    inner = '<remote-port value="8813"/><num-clients value="2"/><start value="true"/><quit-on-end value="true"/>'
    config = scenario(tmp_path, f'<gui-settings-file value="a.view.xml"/><breakpoints value="1"/>{inner}')
    options, left_out = runnable_config(config)
    arguments, changed = sumo_arguments(config, options, seed=42, step_length_s=0.1)
    assert ("remote-port", "8813", "0") in changed
    assert {name for name, _, _ in left_out} == {"gui-settings-file", "breakpoints", "start", "quit-on-end"}
    start = f"import libsumo; libsumo.start(['sumo', *{arguments!r}]); libsumo.simulationStep(); libsumo.close()"
    subprocess.run([sys.executable, "-c", start], check=True, timeout=30)


def test_a_port_asked_for_by_the_user_is_an_error(tmp_path):
    config = scenario(tmp_path)
    with pytest.raises(ScenarioError, match="option 'remote-port'"):
        sumo_arguments(config, config.path, seed=42, step_length_s=0.1, sumo_options=["--remote-port", "8813"])


@pytest.mark.parametrize("option", ["save-configuration", "C", "save-template", "save-schema", "version", "help"])
def test_what_would_end_sumo_before_it_runs_is_left_out(tmp_path, option):
    options, left_out = runnable_config(scenario(tmp_path, f'<{option} value="true"/>'))
    assert not options.keys() & LEFT_OUT
    assert len(left_out) == 1


def test_the_users_options_go_last_and_win(tmp_path):
    config = scenario(tmp_path, '<verbose value="true"/>')
    options = ["--seed=3", "--collision.action", "remove", "--no-step-log", "-W"]
    arguments, changed = sumo_arguments(config, config.path, seed=42, step_length_s=0.1, sumo_options=options)
    assert arguments[-5:] == options
    assert not {"--seed", "--no-warnings"} & set(arguments)
    assert arguments.count("--collision.action") == arguments.count("--no-step-log") == 1
    assert "seed" not in {name for name, _, _ in changed}


@pytest.mark.parametrize("option", ["--help", "-?", "-vV", "--version=true", "-C=x", "--save-template", "--save-config"])
def test_what_would_end_sumo_before_it_runs_is_refused_where_the_user_asks_for_it(tmp_path, option):
    config = scenario(tmp_path)
    with pytest.raises(ScenarioError, match="nothing be simulated"):
        sumo_arguments(config, config.path, seed=42, step_length_s=0.1, sumo_options=[option, "x"])


def test_an_option_in_place_of_the_file_is_given_once(tmp_path):
    config = scenario(tmp_path, '<gui-settings-file value="a.view.xml"/><seed value="7"/><end value="9"/>')
    options, _ = runnable_config(config)
    arguments, _ = sumo_arguments(config, options, seed=42, step_length_s=0.1, sumo_options=["-e", "3"])
    assert "--end=9" not in arguments and "--seed=7" not in arguments and "--configuration-file" not in arguments
    libsumo.start(["sumo", *arguments])
    assert libsumo.simulation.getEndTime() == 3.0
    libsumo.close()


@pytest.mark.parametrize("option", ["route-files", "additional-files", "weight-files"])
def test_sumo_does_not_wait_for_who_writes_into_a_pipe(tmp_path, option):
    os.mkfifo(tmp_path / "pipe.xml")
    with pytest.raises(ScenarioError, match=r"pipe\.xml: a pipe, not a file"):
        runnable_config(scenario(tmp_path, f'<{option} value="pipe.xml"/>'))


def test_sumo_waits_for_no_pipe_that_a_file_includes(tmp_path):
    os.mkfifo(tmp_path / "pipe.xml")
    (tmp_path / "a.add.xml").write_text("<additional><include href='b.add.xml'/></additional>", encoding="utf-8")
    (tmp_path / "b.add.xml").write_text(
        '<additional><include href="a.add.xml"/><include href = "pipe.xml"/></additional>', encoding="utf-8"
    )
    with pytest.raises(ScenarioError, match=r"pipe\.xml: a pipe, not a file"):
        runnable_config(scenario(tmp_path, '<additional-files value="a.add.xml"/>'))


@pytest.mark.parametrize(
    ("own", "asked", "used"), [("1", None, 0.1), ("0.05", None, 0.05), ("0.05", 0.5, 0.5), ("1", 1.0, 1.0)]
)
def test_the_step_is_as_asked_or_the_finer_of_the_scenarios_own_and_a_tenth(tmp_path, own, asked, used):
    assert chosen_step_length(scenario(tmp_path, f'<step-length value="{own}"/>'), asked) == used


@pytest.mark.parametrize("asked", [0.0, -0.1, 1.001, 0.0005, 0.1234, float("nan"), float("inf")])
def test_an_impossible_step_length_is_an_error(tmp_path, asked):
    with pytest.raises(ScenarioError, match="impossible step length"):
        chosen_step_length(scenario(tmp_path), asked)


def test_where_a_trip_ends_is_read_from_the_saved_state(tmp_path):
    route = ElementTree.parse(ROUNDABOUT / "roundabout.rou.xml").getroot()
    edges = next(node.get("edges") for node in route.iter("route"))
    trips = {"a.1": 'arrivalPos="-7.5" arrivalLane="0"', "c": "", "d": 'arrivalPos="max" arrivalLane="current"'}
    vehicles = "".join(
        f'<vehicle id="{name}" depart="{k}" departPos="{20 * k}" {arrival}><route edges="{edges}"/></vehicle>'
        for k, (name, arrival) in enumerate(trips.items())
    )
    (tmp_path / "a.rou.xml").write_text(f"<routes>{vehicles}</routes>", encoding="utf-8")
    libsumo.start(["sumo", "-n", str(ROUNDABOUT / "roundabout.net.xml"), "-r", str(tmp_path / "a.rou.xml"), "--no-step-log"])
    try:
        for _ in range(4):
            libsumo.simulationStep()
        assert arrival_of("a.1") == (-7.5, 0)
        assert arrival_of("c") == arrival_of("d") == (None, None)
    finally:
        libsumo.close()


@pytest.mark.parametrize(
    ("trip", "options", "may_say"),
    [
        ('depart="0"', (), False),
        ('depart="0" arrivalPos="3"', (), True),
        ('depart="0" arrivalLane="1"', (), True),
        ('depart="0"', ("--route-files", "others.rou.xml"), True),
        ('depart="0"', ("-a", "more.add.xml"), True),
        ('depart="0"', ("--load-state=s.xml",), True),
        ('depart="0"', ("--no-warnings",), False),
    ],
)
def test_where_trips_end_is_asked_for_only_where_somebody_may_have_said_it(tmp_path, trip, options, may_say):
    (tmp_path / "a.rou.xml").write_text(f'<routes><trip id="a" from="x" to="y" {trip}/></routes>', encoding="utf-8")
    config = replace(scenario(tmp_path), route_files=(tmp_path / "a.rou.xml",))
    assert may_say_arrivals(config, options) is may_say


def test_a_scenario_that_begins_with_a_saved_state_may_say_where_trips_end(tmp_path):
    assert may_say_arrivals(scenario(tmp_path, '<load-state value="s.xml"/>'), ())


def test_options_name_every_file_where_it_was_and_leave_special_names_and_variables_alone(tmp_path):
    inner = (
        '<gui-settings-file value="a.view.xml"/><output-prefix value="x_"/><summary-output value="localhost:8000"/>'
        '<vehroute-output value="${OUT}/v.xml"/><collision-output value=" c.xml "/><fcd-output value="NUL"/>'
    )
    config = scenario(tmp_path, inner)
    files = [str(ROUNDABOUT / "roundabout.rou.xml"), "more.rou.xml"]
    config = replace(config, options={**config.options, "route-files": ", ".join(files)})
    options, left_out = runnable_config(config)
    assert options["route-files"] == f"{files[0]},{tmp_path / files[1]}"
    assert (options["summary-output"], options["vehroute-output"]) == ("localhost:8000", "${OUT}/v.xml")
    assert (options["collision-output"], options["fcd-output"]) == (str(tmp_path / "c.xml"), "NUL")
    assert (options["output-prefix"], options["end"]) == ("x_", "2")
    assert left_out == (("gui-settings-file", "a.view.xml", "left out"),)


def test_what_is_left_out_is_told_with_its_file(tmp_path):
    options, left_out = runnable_config(scenario(tmp_path, '<additional-files value="osm.poly.xml"/>'))
    assert left_out == (("additional-files", str(tmp_path / "osm.poly.xml"), "left out: missing"),)
    assert "additional-files" not in options
