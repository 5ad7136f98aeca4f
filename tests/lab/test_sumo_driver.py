"""The baseline: SUMO's own driver keeps the ego, and the numbers are those of plain `sumo`."""

from __future__ import annotations

import subprocess
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import pytest
import sumo
from helpers.rude import RUNS_RED, TAKES_IT, in_a_hurry

from sumo_reactive.driver.nouns.assessment import NOT_ASSESSED
from sumo_reactive.lab.comparison.network_effects import Outputs
from sumo_reactive.lab.scenario import Scenario, load_scenario
from sumo_reactive.lab.simulation import run_sumo_driver
from sumo_reactive.sumo.config import read_config
from sumo_reactive.sumo.launch import chosen_step_length, sumo_arguments

ROOT = Path(__file__).resolve().parents[2]
FOUR_WAY = ROOT / "scenarios" / "four_way_priority.toml"
LIGHTS = ROOT / "scenarios" / "signalised_left_turns.toml"
ROUNDABOUT = ROOT / "scenarios" / "roundabout.toml"
CITY = ROOT / "scenarios" / "city_grid.toml"
SUMO = Path(sumo.SUMO_HOME) / "bin" / "sumo"
TIMES = ("depart", "arrival", "duration", "routeLength", "timeLoss")


def plain_trips(scenario: Scenario, folder: Path, *options: str) -> dict[str, dict[str, str]]:
    """Every vehicle's `tripinfo` of plain `sumo`, started with the options that this package uses, and others."""
    config = read_config(scenario.config)
    length = chosen_step_length(config, scenario.step_length_s)
    arguments, _ = sumo_arguments(
        config, config.path, seed=scenario.seed, step_length_s=length, sumo_options=scenario.sumo_options
    )
    trips = folder / "plain.xml"
    subprocess.run([str(SUMO), *arguments, "--tripinfo-output", str(trips), *options], check=True, timeout=120)
    return {one.get("id", ""): dict(one.attrib) for one in ElementTree.parse(trips).getroot().iter("tripinfo")}


def seeded(path: Path, seed: int) -> Scenario:
    """A scenario with another seed."""
    return replace(load_scenario(path), seed=seed)


@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.parametrize("path", [FOUR_WAY, LIGHTS, ROUNDABOUT], ids=lambda path: path.stem)
def test_departure_arrival_duration_distance_and_time_loss_are_those_of_plain_sumo(tmp_path, path, seed):
    scenario = seeded(path, seed)
    result = run_sumo_driver(scenario)
    trip = plain_trips(scenario, tmp_path)[result.ego]
    found = (result.departure_s, result.end_s, result.duration_s, result.distance_m, result.time_loss_s)
    assert found == pytest.approx([float(trip[name]) for name in TIMES], abs=1e-9)
    assert result.arrived and result.ended == "arrived"


def test_the_observer_sees_every_step_of_the_trip():
    scenes = []
    result = run_sumo_driver(load_scenario(FOUR_WAY), observer=scenes.append)
    times = [scene.step.time for scene in scenes]
    assert times == pytest.approx([times[0] + 0.1 * k for k in range(len(times))])
    assert 0.1 * len(times) == pytest.approx(result.duration_s, abs=0.15)
    assert any(scene.users for scene in scenes)


def test_the_record_of_a_step_holds_place_and_motion_and_nothing_that_sumos_own_driver_does_not_have():
    scenes = []
    run_sumo_driver(replace(load_scenario(FOUR_WAY), horizon_s=2.0), observer=scenes.append)
    step = scenes[-1].step
    assert (step.x, step.y, step.lane_id) != (0.0, 0.0, "") and step.speed > 0.0
    assert {name for name in step._fields[6:] if getattr(step, name) not in (None, (), "", NOT_ASSESSED)} == set()


def test_it_is_judged_but_not_on_what_only_this_projects_driver_has():
    metrics = run_sumo_driver(load_scenario(FOUR_WAY)).metrics
    assert {metrics[name] for name in ("collisions", "teleports", "red_lights_run", "right_of_way_violations")} == {0}
    assert metrics["max_braking_m_s2"] and metrics["standstill_s"]
    assert {metrics[name] for name in ("off_road_s", "emergencies", "pilot_activations", "events_delay")} == {None}


@pytest.mark.parametrize(("rudeness", "runs"), [({}, 0), (RUNS_RED, 1)])
def test_a_red_light_that_sumos_own_driver_runs_is_told(tmp_path, rudeness, runs):
    scenario = in_a_hurry(tmp_path, "signalised_left_turns", **rudeness)
    result = run_sumo_driver(scenario)
    assert result.metrics["red_lights_run"] == runs
    assert [violation.kind for violation in result.violations] == ["red light run"] * runs


@pytest.mark.parametrize("takes_it", [False, True])
def test_a_right_of_way_that_sumos_own_driver_takes_is_told(tmp_path, takes_it):
    scenario = in_a_hurry(tmp_path, "four_way_priority", **(TAKES_IT if takes_it else {}))
    result = run_sumo_driver(scenario)
    assert (result.metrics["right_of_way_violations"] > 0) is takes_it
    assert any(violation.kind == "right of way taken" for violation in result.violations) is takes_it


def test_the_same_trial_again_gives_the_same_result():
    assert run_sumo_driver(load_scenario(FOUR_WAY)) == run_sumo_driver(load_scenario(FOUR_WAY))


def test_a_run_that_ends_before_has_driven_until_then():
    departure = run_sumo_driver(load_scenario(FOUR_WAY)).departure_s
    result = run_sumo_driver(replace(load_scenario(FOUR_WAY), horizon_s=5.0))
    assert not result.arrived and result.ended.startswith("until ")
    assert result.duration_s == pytest.approx(5.0) and result.departure_s == departure
    assert 0.0 < result.distance_m < 100.0


def test_a_trip_output_that_is_asked_for_is_written_and_tells_the_same(tmp_path):
    scenario, trips = load_scenario(FOUR_WAY), tmp_path / "mine.xml"
    asked = replace(scenario, sumo_options=(f"--tripinfo-output={trips}",), until_end=True)
    assert run_sumo_driver(asked).distance_m == run_sumo_driver(scenario).distance_m
    assert 'id="ego"' in trips.read_text(encoding="utf-8")


def test_the_outputs_of_a_comparison_change_nobodys_trip_nor_who_has_which_device(tmp_path):
    given = ("--device.rerouting.probability", "0.5", "--end", "60", "--tripinfo-output.write-unfinished", "true")
    scenario = replace(load_scenario(CITY), sumo_options=given)
    before = plain_trips(scenario, tmp_path)
    options = Outputs(tmp_path).options(read_config(scenario.config))
    ours = {name: value for name, value in options.items() if not name.startswith("tripinfo-output")}
    added = [word for name, value in ours.items() for word in (f"--{name}", value)]
    after = plain_trips(scenario, tmp_path, *added)
    assert sum("routing_" in trip["devices"] for trip in before.values()) > 10
    for name, trip in before.items():
        devices = after[name].pop("devices").split()
        assert [one for one in devices if not one.startswith("emissions_")] == trip.pop("devices").split()
        assert after[name] == trip
