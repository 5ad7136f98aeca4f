"""The trip: what it makes of what the pilot asks the planner for."""

import math
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import libsumo
import pytest

from sumo_reactive.driver.controller import Controller
from sumo_reactive.driver.nouns.completed_plan import Replanning, Request
from sumo_reactive.lab.scenario import load_scenario
from sumo_reactive.lab.simulation import run_trial, started
from sumo_reactive.sumo.ego import Ego
from sumo_reactive.sumo.outputs import trip_of
from sumo_reactive.sumo.sensor import Sensor
from sumo_reactive.sumo.session import Session

SCENARIOS = Path(__file__).parents[2] / "scenarios"
FOUR_WAY, LIGHTS = (SCENARIOS / f"{name}.toml" for name in ("four_way_priority", "signalised_left_turns"))


def test_a_change_that_there_is_no_lane_for_when_it_is_planned_is_not_made(monkeypatch):
    """The ego may have come onto another lane meanwhile; if the route still needs the change, the pilot asks again."""
    step, asked = Controller.step, []

    def asking(controller, traffic, drive, duration):
        found = step(controller, traffic, drive, duration)
        if len(asked) == 5:
            request = Request(what=Replanning.CURVE, change_lane=-1)
            found = found._replace(completed=replace(found.completed, request=request))
        asked.append(found.completed.request)
        return found

    monkeypatch.setattr(Controller, "step", asking)
    result = run_trial(load_scenario(FOUR_WAY))  # a road of one lane
    assert asked[5].change_lane == -1
    assert result.arrived


def test_an_ego_that_has_arrived_is_off_the_road_and_counted_as_arrived(tmp_path):
    trips = tmp_path / "trips.xml"
    asked = replace(load_scenario(FOUR_WAY), sumo_options=("--tripinfo-output", str(trips)))
    there: list[bool] = []

    def looking(done):
        def look(*of_whom):
            done(*of_whom)
            there.append("ego" in libsumo.vehicle.getIDList())

        return look

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Session, "step", looking(Session.step))
        patch.setattr(Ego, "arrive", looking(Ego.arrive))
        result = run_trial(asked)
    assert there[-3:] == [True, True, False]  # after the last step of its own, told to leave, after one more step
    trip = trip_of(trips, "ego")
    assert trip is not None and trip.arrival is not None
    assert abs(trip.arrival - result.end_s) < 0.25


@pytest.mark.parametrize("seed", [7, 8])
def test_sumo_runs_with_the_seed_of_the_scenario(seed):
    with started(replace(load_scenario(FOUR_WAY), seed=seed)):
        assert libsumo.simulation.getOption("seed") == str(seed)


def test_another_seed_is_another_drive():
    first, again, other = (run_trial(replace(load_scenario(FOUR_WAY), seed=seed)).figures for seed in (1, 1, 2))
    assert first == again != other


def test_the_line_that_the_ego_crosses_is_noted_with_its_letters():
    """At the lights: by the driver in its record, and from SUMO's lights for the judges."""
    scenes = []
    run_trial(load_scenario(LIGHTS), observer=scenes.append)
    assert [scene.crossed for scene in scenes if scene.crossed] in (["gg"], ["GG"])
    assert [scene.step.light for scene in scenes if scene.step.light] in (["g"], ["G"])


def test_the_judges_are_shown_who_is_beside_the_ego_whether_its_driver_looks_there_or_not(monkeypatch):
    """A driver who sees nobody: those beside it are SUMO's word."""
    monkeypatch.setattr(Sensor, "vehicles", lambda sensor, lanes, ego_id: [])
    scenes = []
    run_trial(replace(load_scenario(LIGHTS), horizon_s=40.0), observer=scenes.append)
    assert not any(scene.users for scene in scenes)
    assert any(scene.beside for scene in scenes)


def test_an_ego_that_the_pilot_sends_over_a_red_light_is_told(monkeypatch):
    """The judge asks SUMO: the pilot sees green where SUMO shows red."""
    monkeypatch.setattr(Sensor, "letters", lambda sensor, light: "G" * 12)
    result = run_trial(replace(load_scenario(LIGHTS), horizon_s=120.0))
    assert result.figures["red_lights_run"] == 1
    assert [one.kind for one in result.violations if one.kind == "red light run"] == ["red light run"]


def test_the_way_of_a_trip_is_the_one_of_the_front_bumper_as_sumos_positions_are_up_to_the_goal():
    """In turns the rear axle cuts 2 m of it here."""
    scenes = []
    result = run_trial(load_scenario(SCENARIOS / "city_grid.toml"), observer=scenes.append)
    steps = [scene.step for scene in scenes]
    seen = sum(math.dist((one.x, one.y), (other.x, other.y)) for one, other in pairwise(steps))
    first, last = (step.speed * result.step_length_s for step in (steps[0], steps[-1]))
    assert 0.0 <= result.distance_m - seen - first <= last
