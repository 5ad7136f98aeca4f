"""The trip: what it makes of what the pilot asks the planner for, and how long it is."""

import math
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

from sumo_reactive.controller import Controller
from sumo_reactive.experiment.scenario import load_scenario
from sumo_reactive.experiment.trial import run_trial
from sumo_reactive.messages.completed_plan import Replanning, Request

SCENARIOS = Path(__file__).parents[2] / "scenarios"
FOUR_WAY = SCENARIOS / "four_way_priority.toml"


def test_a_change_that_there_is_no_lane_for_when_it_is_planned_is_not_made(monkeypatch):
    """The ego may have come onto another lane meanwhile; if the route still needs the change, the pilot asks again."""
    step, asked = Controller.step, []

    def asking(controller, traffic, drive, duration):
        found = step(controller, traffic, drive, duration)
        if len(asked) == 5:
            request = Request(Replanning.CURVE, change_lane=-1)
            found = found._replace(completed=replace(found.completed, request=request))
        asked.append(found.completed.request)
        return found

    monkeypatch.setattr(Controller, "step", asking)
    result = run_trial(load_scenario(FOUR_WAY))  # a road of one lane
    assert asked[5].change_lane == -1
    assert result.arrived


def test_the_way_of_a_trip_is_the_one_of_the_front_bumper_as_sumos_positions_are_up_to_the_goal():
    """In turns the rear axle cuts 2 m of it here."""
    scenes = []
    result = run_trial(load_scenario(SCENARIOS / "city_grid.toml"), observer=scenes.append)
    steps = [scene.step for scene in scenes]
    seen = sum(math.dist((one.x, one.y), (other.x, other.y)) for one, other in pairwise(steps))
    first, last = (step.speed * result.step_length_s for step in (steps[0], steps[-1]))
    assert 0.0 <= result.distance_m - seen - first <= last
