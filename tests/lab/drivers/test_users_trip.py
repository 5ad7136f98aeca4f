"""Trips with drivers of the user's: what they are told, what becomes of their answers, and of their failures."""

import math
from dataclasses import replace
from pathlib import Path

import pytest

from sumo_reactive.errors import ScenarioError
from sumo_reactive.lab.drivers.choice import DriverChoice, chosen_driver
from sumo_reactive.lab.drivers.loading import digest_of_driver, maker_of
from sumo_reactive.lab.drivers.protocol import Driver
from sumo_reactive.lab.ego_rule import EgoRule
from sumo_reactive.lab.fleet import run_fleet
from sumo_reactive.lab.recorder import Recorder
from sumo_reactive.lab.scenario import load_scenario
from sumo_reactive.lab.simulation import run_trial, taking_over

ROOT = Path(__file__).resolve().parents[3]
HERE = Path(__file__).parent
EXAMPLES = ROOT / "examples" / "drivers"
FOUR_WAY = load_scenario(ROOT / "scenarios" / "four_way_priority.toml")


def driven_by(name, folder=HERE, scenario=FOUR_WAY, **options):
    """Return the scenario with a driver of a module in a folder."""
    return replace(scenario, driver=chosen_driver(name, options, folder))


def steps_of(scenario):
    """Return the result of a trial, and its scenes' records."""
    steps = []
    return run_trial(scenario, observer=lambda scene: steps.append(scene.step)), steps


def test_a_driver_on_lanes_arrives_where_sumo_takes_it_and_its_reason_is_kept():
    result, steps = steps_of(driven_by("wayward:Obedient"))
    assert (result.exit_code, result.profile, result.ended) == (0, "wayward:Obedient", "arrived")
    assert {step.reason for step in steps[:-1]} == {"drives"}
    assert result.recounts == ()


def test_the_same_driver_drives_the_same_trip_again():
    ones = [steps_of(driven_by("wayward:Obedient"))[1] for _ in range(2)]
    assert [step._replace(control_us=0.0) for step in ones[0]] == [step._replace(control_us=0.0) for step in ones[1]]


def test_a_driver_that_raises_has_failed_with_its_step_and_the_traceback_of_its_code_alone():
    result, steps = steps_of(driven_by("wayward:CrashesAt20"))
    assert not result.arrived
    assert result.ended == "driver 'wayward:CrashesAt20' failed at 20.1 s: ZeroDivisionError: division by zero"
    assert "wayward.py" in result.failure
    assert "users_trip.py" not in result.failure
    assert math.isclose(steps[-1].time, 20.1)
    assert result.exit_code == 1


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("Quits", "SystemExit: 3"), ("Leaps", "failed at 12.2 s: answered a place 496.3 m away"),
        ("Babbles", "answered a str, which is none"), ("Silent", "answered nothing, and there is no plan"),
        ("Infinite", "answered inf where a finite number is due"),
    ],
)  # fmt: skip
def test_an_answer_that_no_car_can_carry_out_is_the_drivers_failure(name, told):
    result, _ = steps_of(driven_by(f"wayward:{name}"))
    assert told in result.ended


def test_the_lanes_around_are_told_inside_a_junction_too():
    """Where its lane 0 leads on to lane 1, because a lane begins beside it."""
    merge = replace(load_scenario(ROOT / "scenarios" / "on_ramp_merge.toml"), ego="through_right.0")
    _, steps = steps_of(driven_by("wayward:LooksAround", scenario=merge))
    assert {step.reason for step in steps[:-1]} == {"edge: 0", "edge: 1", "junction: 0"}


def test_the_lanes_around_are_not_told_of_another_moment():
    result, _ = steps_of(driven_by("wayward:LooksBack"))
    assert result.ended.endswith("failed at 12.3 s: asked at 12.2 s for the surroundings at 12.1 s, which are past")


def test_a_plan_is_followed_until_it_is_over():
    result, steps = steps_of(replace(driven_by("wayward:Straight"), until_s=17.0))
    assert result.ended == "until 17 s"
    assert all(math.isclose(step.speed, 5.0) for step in steps[1:])
    driven = math.dist((steps[0].x, steps[0].y), (steps[-1].x, steps[-1].y))
    assert math.isclose(driven, 0.5 * (len(steps) - 1), rel_tol=1e-3)


def test_a_driver_is_told_its_mission_and_the_end(monkeypatch):
    made = []
    make = maker_of(driven_by("wayward:Obedient").driver)
    monkeypatch.setattr("sumo_reactive.lab.simulation.maker_of", lambda _: lambda: made.append(make()) or made[-1])
    run_trial(driven_by("wayward:Obedient"))
    (driver,) = made
    (mission,) = driver.missions
    assert (mission.ego, mission.step_length, mission.seed) == ("ego", 0.1, 42)
    assert mission.way.shape[1] == 2
    length = sum(math.dist(a, b) for a, b in zip(mission.way[:-1], mission.way[1:], strict=True))
    assert 300.0 < length < 330.0
    assert [(end.arrived, end.reason) for end in driver.ends] == [(True, "arrived")]


def test_each_ego_of_several_gets_a_driver_of_its_own():
    scenario = replace(driven_by("wayward:Obedient"), until_s=30.0)
    fleet = run_fleet(scenario, EgoRule(ids=("ego", "west_east.1")))
    assert {one.ego for one in fleet.results} == {"ego", "west_east.1"}
    assert {one.profile for one in fleet.results} == {"wayward:Obedient"}


def test_what_is_recorded_can_be_driven_again_place_by_place(tmp_path):
    recorder, first = Recorder(tmp_path / "run"), []
    result = run_trial(FOUR_WAY, observer=lambda scene: (recorder.see(scene), first.append(scene.step)))
    recorder.write(result)
    file = str(tmp_path / "run" / "trajectory.parquet")
    again, steps = steps_of(driven_by("sumo_reactive_examples.recorded:Recorded", EXAMPLES, file=file))
    assert again.arrived
    assert abs(again.duration_s - result.duration_s) <= 0.2
    assert max(math.dist((a.x, a.y), (b.x, b.y)) for a, b in zip(first, steps, strict=False)) < 0.02


@pytest.mark.parametrize("name", ["idm_mobil:IdmMobil", "pure_pursuit:PurePursuit", "nine_commands:NineCommands"])
@pytest.mark.parametrize("scenario", ["on_ramp_merge", "right_before_left"])
def test_the_examples_arrive(name, scenario):
    asked = load_scenario(ROOT / "scenarios" / f"{scenario}.toml")
    result, steps = steps_of(driven_by(f"sumo_reactive_examples.{name}", EXAMPLES, asked))
    assert result.arrived, result.failure or result.ended
    assert any(step.reason for step in steps)


def test_the_examples_are_drivers():
    choice = DriverChoice("sumo_reactive_examples.idm_mobil:IdmMobil", folder=EXAMPLES)
    assert isinstance(maker_of(choice)(), Driver)


@pytest.mark.parametrize(
    ("name", "options", "told"),
    [
        ("nowhere:Driver", {}, "cannot be loaded: ModuleNotFoundError"),
        ("wayward:Nobody", {}, "cannot be loaded: AttributeError"),
        ("wayward:NoDriver", {}, "is no driver: it has no step"),
        ("wayward:Obedient", {"speed": 1.0}, "unexpected keyword argument 'speed'"),
        ("exec:./no_such_program", {}, "no such program"),
        ("exec:'", {}, "No closing quotation"),
        ("sumo_reactive_examples.own_parts:HURRIED", {"speed": 1.0}, "parts take no options"),
    ],
)
def test_what_is_no_driver_is_refused_before_sumo_starts(name, options, told):
    with pytest.raises(ScenarioError, match=told):
        taking_over(driven_by(name, EXAMPLES if "examples" in name else HERE, **options))


def test_the_drivers_that_are_built_in_take_no_options():
    with pytest.raises(ScenarioError, match="takes no options"):
        chosen_driver("sumo", {"a": 1}, HERE)


def test_the_digest_of_a_driver_is_that_of_its_source(tmp_path):
    source = (HERE / "wayward.py").read_text(encoding="utf-8")
    digests = []
    for k, text in enumerate((source, source, f"{source}\n")):
        (tmp_path / f"way{k}.py").write_text(text, encoding="utf-8")
        digests.append(digest_of_driver(DriverChoice(f"way{k}:Obedient", folder=tmp_path)))
    assert digests[0] == digests[1] != digests[2]
    assert digest_of_driver(DriverChoice("reactive")) == ""
