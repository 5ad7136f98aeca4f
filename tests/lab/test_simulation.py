"""A trial against SUMO's own outputs, and at the scenario's end."""

import math
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from xml.etree import ElementTree

import pytest

from sumo_reactive.driver.parameters import Parameters
from sumo_reactive.errors import ScenarioError
from sumo_reactive.lab import simulation
from sumo_reactive.lab.columns import digest_of
from sumo_reactive.lab.comparison.network_effects import Outputs, effects_of
from sumo_reactive.lab.ego_rule import EgoRule
from sumo_reactive.lab.fleet import run_fleet
from sumo_reactive.lab.recorder import fleet_summary
from sumo_reactive.lab.result import rows_of as shown
from sumo_reactive.lab.result import summary_of
from sumo_reactive.lab.scenario import Scenario, load_scenario
from sumo_reactive.lab.simulation import run_sumo_driver, run_trial
from sumo_reactive.sumo.config import read_config

ROOT = Path(__file__).parents[2]
FOUR_WAY = ROOT / "networks" / "four_way_priority" / "four_way_priority"
STOP_S = 20.0


def scenario(name, *options, **changes):
    return replace(load_scenario(ROOT / "scenarios" / f"{name}.toml"), sumo_options=tuple(map(str, options)), **changes)


def rows_of(path):
    """Every vehicle's row of a `tripinfo-output`."""
    return {row.get("id"): row.attrib for row in ElementTree.parse(path).getroot().iter("tripinfo")}


def way_in(fcd, vehicle):
    """How far a vehicle gets by its positions, and for how long it is there, s."""
    steps = [
        (float(step.get("time")), float(one.get("x")), float(one.get("y")))
        for step in ElementTree.parse(fcd).getroot() for one in step if one.get("id") == vehicle
    ]  # fmt: skip
    way = sum(math.dist(one[1:], other[1:]) for one, other in pairwise(steps))
    return way, steps[-1][0] - steps[0][0]


@pytest.mark.parametrize("name", ["multi_lane_road", "figure4", "signalised_left_turns", "roundabout", "blocked_lane"])
def test_sumos_outputs_and_the_summary_tell_the_same_of_the_ego(tmp_path, name):
    """With every change of lanes SUMO counts a lane more."""
    trips, fcd, means = tmp_path / "t.xml", tmp_path / "f.xml", tmp_path / "s.xml"
    asked = scenario(name, "--tripinfo-output", trips, "--fcd-output", fcd, "--statistic-output", means)
    result = run_trial(asked)
    rows = rows_of(trips)
    row, (way, time) = rows[result.ego], way_in(fcd, result.ego)
    told = [float(row[key]) for key in ("depart", "arrival", "duration", "routeLength", "timeLoss")]
    ours = [result.departure_s, result.end_s, result.duration_s, result.distance_m, result.time_loss_s]
    assert ours == pytest.approx(told, abs=0.01)
    assert result.distance_m == pytest.approx(way, rel=0.01, abs=1.0)
    assert result.duration_s == pytest.approx(time, abs=0.1 + 1e-6)
    mean = ElementTree.parse(means).getroot().find("vehicleTripStatistics").attrib
    assert int(mean["count"]) == len(rows)
    for key in ("routeLength", "timeLoss"):
        assert float(mean[key]) == pytest.approx(sum(float(one[key]) for one in rows.values()) / len(rows), abs=0.02)
    speeds = [float(one["routeLength"]) / float(one["duration"]) for one in rows.values()]
    assert float(mean["speed"]) == pytest.approx(sum(speeds) / len(speeds), abs=0.02)


def test_what_sumo_counts_amiss_is_put_right_and_named(tmp_path):
    trips = tmp_path / "t.xml"
    result = run_trial(scenario("multi_lane_road", "--tripinfo-output", trips))
    (recount,) = result.recounts
    assert (recount.file, recount.vehicle, recount.attribute) == ("t.xml", "ego", "routeLength")
    assert float(recount.sumo) > 1.5 * result.distance_m  # else nothing were put right
    assert recount.used == rows_of(trips)["ego"]["routeLength"] == f"{result.distance_m:.2f}"
    assert ("t.xml ego routeLength", f"{recount.sumo} → {recount.used}") in shown(result)
    assert summary_of(result)["recounts"] == [recount._asdict()]


def test_the_sums_over_the_others_and_the_egos_own_way_are_sumos_sums_over_all(tmp_path):
    """As a comparison reads them."""
    asked, outputs = scenario("multi_lane_road", until_s=100.0, until_end=True), Outputs(tmp_path)
    options = outputs.options(read_config(asked.config))
    words = [word for name, value in options.items() for word in (f"--{name}", value)]
    result = run_trial(replace(asked, sumo_options=tuple(words)))
    others = effects_of(outputs, "ego", 0).figures
    mean = ElementTree.parse(outputs.totals).getroot().find("vehicleTripStatistics").attrib
    count = int(mean["count"])
    assert others["others_vehicles"] == count - 1
    for key, of_others, of_ego in (
        ("routeLength", 1000.0 * others["others_distance_km"], result.distance_m),
        ("timeLoss", others["others_time_loss_s"], result.time_loss_s),
    ):
        assert of_others + of_ego == pytest.approx(count * float(mean[key]), abs=0.01 * count)


def test_who_asks_for_no_output_of_sumo_hears_of_none():
    assert run_trial(scenario("multi_lane_road")).recounts == ()


def test_an_unfinished_trip_is_put_right_too(tmp_path):
    trips = tmp_path / "t.xml"
    options = "--tripinfo-output", trips, "--tripinfo-output.write-unfinished", "true"
    result = run_trial(scenario("multi_lane_road", *options, until_s=50.0))
    row = rows_of(trips)["ego"]
    assert not result.arrived and float(row["duration"]) == pytest.approx(result.duration_s, abs=0.01)
    assert float(row["routeLength"]) == pytest.approx(result.distance_m, abs=0.01)


def test_every_ego_of_a_fleet_is_put_right(tmp_path):
    trips = tmp_path / "t.xml"
    asked = scenario("multi_lane_road", "--tripinfo-output", trips)
    fleet = run_fleet(asked, EgoRule(ids=("ego", "left.1")))
    rows = rows_of(trips)
    assert {one.vehicle for one in fleet.recounts} == {"ego", "left.1"}
    for result in fleet.results:
        row = rows[result.ego]
        told = [float(row[key]) for key in ("duration", "routeLength", "timeLoss")]
        assert [result.duration_s, result.distance_m, result.time_loss_s] == pytest.approx(told, abs=0.01)
        assert [one.vehicle for one in result.recounts] == [result.ego]
    assert fleet_summary(fleet, str)["recounts"] == [one._asdict() for one in fleet.recounts]


def own(folder, vehicle='<vehicle id="ego" depart="0"><route edges="from_west to_east"/></vehicle>', end=""):
    """An ego alone at a crossing, or with other vehicles; a scenario's `end` as given."""
    (folder / "own.rou.xml").write_text(f"<routes>{vehicle}</routes>", encoding="utf-8")
    files = f'<net-file value="{FOUR_WAY}.net.xml"/><route-files value="own.rou.xml"/>'
    config = folder / "own.sumocfg"
    config.write_text(f"<configuration>{files}{end}</configuration>", encoding="utf-8")
    return Scenario(config=config, ego="ego", source=config)


def test_time_at_a_stop_of_the_route_is_not_lost_as_with_sumos_own_driver(tmp_path):
    stop = f'<stop lane="from_west_0" endPos="80" duration="{STOP_S:g}"/>'
    route = f'<vehicle id="ego" depart="0"><route edges="from_west to_east"/>{stop}</vehicle>'
    trips = tmp_path / "t.xml"
    asked = replace(own(tmp_path, route), sumo_options=("--tripinfo-output", str(trips)))
    result, row = run_trial(asked), rows_of(trips)["ego"]
    run_sumo_driver(asked)
    theirs = rows_of(trips)["ego"]
    counted = {one.attribute: float(one.sumo) for one in result.recounts}
    assert float(row["stopTime"]) == pytest.approx(float(theirs["stopTime"]), abs=0.2) == result.stopped_s
    assert float(row["waitingTime"]) < 2.0 < counted["waitingTime"]
    assert float(row["timeLoss"]) == pytest.approx(result.time_loss_s, abs=0.01)
    assert counted["timeLoss"] - result.time_loss_s == pytest.approx(STOP_S, abs=0.2)


ALONE_ARRIVES_S = 20.0
"""Before this nobody has crossed the network."""

END = f'<end value="{ALONE_ARRIVES_S / 2.0:g}"/>'


def test_an_ego_under_way_drives_on_past_the_scenarios_end_which_is_named(tmp_path):
    result = run_trial(own(tmp_path, end=END))
    assert result.arrived and result.end_s > ALONE_ARRIVES_S
    assert [one for one in result.overrides if one[0] == "end"] == [("end", "10", f"{result.end_s:g}")]


def test_a_fleet_drives_on_past_the_scenarios_end_as_an_ego_alone_does(tmp_path):
    asked = own(tmp_path, end=END)
    alone, fleet = run_trial(asked), run_fleet(asked, EgoRule(ids=("ego",)))
    (member,) = fleet.results
    assert (member.arrived, member.end_s, member.overrides) == (alone.arrived, alone.end_s, alone.overrides)
    assert {"option": "end", "scenario": "10", "used": f"{fleet.until:g}"} in fleet_summary(fleet, str)["overrides"]
    assert not fleet.on_their_way


def test_sumos_own_driver_goes_on_past_the_end_by_the_same_rule(tmp_path):
    result = run_sumo_driver(own(tmp_path, end=END))
    assert result.arrived and [one[:2] for one in result.overrides if one[0] == "end"] == [("end", "10")]


def test_nobody_becomes_an_ego_after_the_scenarios_end(tmp_path):
    flow = '<flow id="f" begin="0" end="60" period="4" departSpeed="max"><route edges="from_west to_east"/></flow>'
    fleet = run_fleet(replace(own(tmp_path, flow, END), ego=None), EgoRule(share=1.0))
    assert [result.departure_s for result in fleet.results] == [0.0, 4.0, 8.0]
    assert all(result.arrived for result in fleet.results) and not fleet.on_their_way


def test_a_fleet_of_which_nobody_can_be_driven_is_an_error_that_says_why(tmp_path, monkeypatch):
    def refuse(session, ego, *_):
        raise ScenarioError(f"ego '{ego}' has nowhere to go")

    monkeypatch.setattr(simulation, "Trip", refuse)
    flow = '<flow id="f" begin="0" end="9" period="4" departSpeed="max"><route edges="from_west to_east"/></flow>'
    with pytest.raises(ScenarioError, match=r"none of 3 vehicles chosen can be taken over; 'f\.0': ego 'f\.0' has"):
        run_fleet(replace(own(tmp_path, flow, END), ego=None), EgoRule(share=1.0))


def test_an_end_before_which_the_ego_has_arrived_overrides_nothing(tmp_path):
    assert "end" not in [one[0] for one in run_trial(own(tmp_path, end='<end value="100"/>')).overrides]


@pytest.mark.parametrize("changes", [{"until_s": 15.0}, {"sumo_options": ("--end", "15")}], ids=["until", "option"])
def test_an_end_that_the_user_names_is_the_end_for_one_ego_and_for_a_fleet(tmp_path, changes):
    asked = replace(own(tmp_path, end=END), **changes)
    alone, fleet = run_trial(asked), run_fleet(asked, EgoRule(ids=("ego",)))
    assert not alone.arrived and alone.ended == "until 15 s"
    assert fleet.on_their_way == {"ego"} and fleet.until == alone.end_s == 15.0
    is_overridden = "until_s" in changes  # past the scenario's end; an option is the user's own
    assert ("end" in [one[0] for one in alone.overrides]) == is_overridden


def test_an_end_that_is_no_time_is_an_input_error(tmp_path):
    for run in (run_trial, lambda asked: run_fleet(asked, EgoRule(ids=("ego",)))):
        with pytest.raises(ScenarioError):
            run(replace(own(tmp_path), sumo_options=("--end", "soon")))


def driven(**parameters):
    """The trajectory of an ego with other parameters, in this process."""
    steps = []
    asked = scenario("four_way_priority", parameters=Parameters(**parameters))
    run_trial(asked, observer=lambda scene: steps.append(scene.step))
    return digest_of(steps)


def test_runs_of_one_process_have_their_own_parameters():
    """Of the pilot, the executor, the compiled field and the car itself: each makes a difference, and none stays behind."""
    usual = driven()
    asked = ({"gap_before_s": 9.0}, {"comfort_jerk": 4.0}, {"valley_attraction": 0.2}, {"comfort_deceleration": 1.5})
    varied = [driven(**one) for one in asked]
    assert len({usual, *varied}) == 1 + len(varied)
    assert [driven(**asked[0]), driven()] == [varied[0], usual]


def test_an_ego_that_arrives_is_still_there_for_all_who_look_in_that_step(monkeypatch):
    told = []

    def noted(name):
        method = getattr(simulation.Trip, name)
        return lambda trip: (told.append(name), method(trip))[1]

    for name in ("command", "scene", "arrive"):
        monkeypatch.setattr(simulation.Trip, name, noted(name))
    run_fleet(scenario("multi_lane_road"), EgoRule(ids=("ego", "left.1")))
    assert told.count("scene") > 100
    assert ("arrive", "scene") not in pairwise(told)
