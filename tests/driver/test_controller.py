"""One control step: coarse and fine steps agree, equal input gives equal output, the paper's command is held."""

import math
from dataclasses import replace

import numpy as np
import pytest
from helpers.cars import CAR, car_at
from helpers.situations import before

from sumo_reactive.driver.controller import Controller, Drive, Step, moved, replanned
from sumo_reactive.driver.nouns.state import VehicleState
from sumo_reactive.driver.nouns.traffic import Traffic
from sumo_reactive.driver.parameters import Profile
from sumo_reactive.driver.pilot import pilot

ROUTE = ("from_south", "to_west")


@pytest.fixture(scope="module")
def ego():
    return before("four_way_priority", ROUTE, 60.0, 9.0)


def steps_of(ego, duration: float, seconds: float, profile=Profile.DEFAULT, users=()) -> list[Step]:
    """Steps of one length past others that stand still."""
    controller, drive, steps = Controller(graph=ego.graph, limits=CAR, profile=profile), ego.drive(), []
    for k in range(round(seconds / duration)):
        steps.append(controller.step(Traffic(time=ego.time + k * duration, users=users, lights={}), drive, duration))
        drive = steps[-1].drive
    return steps


@pytest.mark.parametrize("duration", [0.5, 1.0])
def test_a_coarse_step_ends_where_ten_fine_ones_do(ego, duration):
    coarse, fine = steps_of(ego, duration, 10.0)[-1].drive.ego, steps_of(ego, 0.1, 10.0)[-1].drive.ego
    assert math.hypot(coarse.pose.x - fine.pose.x, coarse.pose.y - fine.pose.y) < 0.05
    assert (coarse.speed, coarse.pose.heading) == pytest.approx((fine.speed, fine.pose.heading), abs=0.01)


@pytest.mark.parametrize("duration", [0.05, 0.1, 0.25, 0.5, 1.0])
def test_the_turn_is_driven_on_the_curve_at_every_step_length(ego, duration):
    steps = steps_of(ego, duration, 14.0)
    assert max(abs(step.snapshot.d) for step in steps) < 0.15
    assert steps[-1].snapshot.front > ego.plan.passages[0].end


def braking_before(ego, duration: float) -> list[bool]:
    """Whether each second of coming too late upon somebody who stands holds an emergency."""
    van = ego.other("van", "from_south_0", -48.0, 0.0, ("from_south", "to_west"))
    flags = [step.execution.emergency for step in steps_of(ego, duration, 4.0, users=(van,))]
    parts = round(1.0 / duration)
    return [any(flags[k : k + parts]) for k in range(0, len(flags), parts)]


def test_an_emergency_that_is_over_within_a_coarse_step_is_told(ego):
    assert braking_before(ego, 1.0) == braking_before(ego, 0.1)
    assert True in braking_before(ego, 1.0)


@pytest.mark.parametrize("duration", [0.1, 0.5])
def test_every_run_of_the_highway_code_is_one_of_the_pilot(ego, duration, monkeypatch):
    runs = []
    asks = pilot.ask
    monkeypatch.setattr(pilot, "ask", lambda *given: (runs.append(1), asks(*given))[1])
    controller, drive, steps = Controller(graph=ego.graph, limits=CAR), ego.drive(), []
    west = ego.other("west", "from_west_0", -60.0, 8.0, ("from_west", "to_east"))
    traffic = Traffic(time=ego.time, users=(west,), lights={})
    for _ in range(round(6.0 / duration)):
        steps.append(controller.step(traffic, drive, duration))
        drive, traffic = steps[-1].drive, moved(traffic, duration)
    assert sum(step.runs for step in steps) == len(runs) > 1
    assert all(step.completed.events for step in steps if step.runs)


@pytest.mark.parametrize(("gains", "speed", "way"), [(0.0, 6.0, 3.0), (-4.0, 4.0, 2.5), (2.0, 7.0, 3.25), (-20.0, 0.0, 1.5)])
def test_within_a_coarse_step_the_others_go_on_gaining_or_losing_speed(ego, gains, speed, way):
    """Who brakes to wait at 0.5 s would else be taken for one who does not, in every second control step."""
    x = ego.other("x", "from_west_0", -60.0, 6.0, ("from_west", "to_east"))._replace(acceleration=gains)
    (later,) = moved(Traffic(time=ego.time, users=(x,), lights={}), 0.5).users
    assert (later.speed, later.lane_position - x.lane_position) == pytest.approx((speed, way))
    assert (later.x - x.x, later.y - x.y) == pytest.approx((way, 0.0), abs=1e-6)


def test_equal_input_gives_equal_output(ego):
    west = ego.other("west", "from_west_0", -40.0, 10.0, ("from_west", "to_east"))
    traffic = Traffic(time=ego.time, users=(west, car_at("stray", 150.0, 130.0, 0.3, 1.0)), lights={})
    first, second = (Controller(graph=ego.graph, limits=CAR).step(traffic, ego.drive(), 0.1) for _ in range(2))
    assert first.execution == second.execution
    assert first.drive.ego == second.drive.ego
    assert first.completed == second.completed


def test_a_step_changes_nothing_that_it_was_given(ego):
    drive = ego.drive()
    limits = drive.plan.speed_limits.copy()
    Controller(graph=ego.graph, limits=CAR).step(Traffic(time=ego.time, users=(), lights={}), drive, 1.0)
    assert drive == Drive(ego.ego, ego.plan, 0.0)
    assert np.array_equal(drive.plan.speed_limits, limits)


def test_the_paper_holds_each_of_its_commands_for_half_a_second(ego):
    commands = [step.execution.command for step in steps_of(ego, 0.1, 6.0, Profile.PAPER)]
    for first in range(0, len(commands), 5):
        assert len(set(commands[first : first + 5])) == 1
    assert len(set(commands)) > 1


def test_the_paper_passes_the_turn_within_its_lane(ego):
    steps = steps_of(ego, 0.1, 20.0, Profile.PAPER)
    assert max(abs(step.snapshot.d) for step in steps) < 0.7
    assert steps[-1].snapshot.front > ego.plan.passages[0].end


@pytest.mark.parametrize(("aside", "turned"), [(0.0, 0.2), (0.0, -0.2)])
def test_the_paper_starts_from_a_standstill_a_little_beside_its_curve(ego, aside, turned):
    pose = ego.ego.pose._replace(x=ego.ego.pose.x + aside, heading=ego.ego.pose.heading + turned)
    beside = replace(ego, ego=VehicleState(pose, 0.0, 0.0))
    assert steps_of(beside, 0.1, 5.0, Profile.PAPER)[-1].drive.ego.speed > 1.0


def test_within_a_coarse_step_the_others_are_foreseen_to_drive_on():
    before_it = Traffic(time=7.0, users=(car_at("x", 10.0, 20.0, 0.5 * math.pi, 8.0),), lights={"light": "r"})
    after = moved(before_it, 0.5)
    (user,) = after.users
    assert (after.time, user.x, user.y, user.lane_position) == pytest.approx((7.5, 10.0, 24.0, 4.0))
    assert after.lights == before_it.lights


def test_a_new_plan_begins_at_the_ego_and_keeps_what_the_pilot_remembers(ego):
    drive = steps_of(ego, 0.1, 2.0)[-1].drive
    other = before("four_way_priority", ROUTE, 40.0, 9.0).plan
    again = replanned(drive, other, ego.time + 2.0)
    assert (again.plan.curve, again.s, again.memory, again.ego) == (other.curve, 0.0, drive.memory, drive.ego)


def test_a_new_plan_inherits_the_delay_of_the_old_one(ego):
    drive = ego.drive()._replace(s=20.0)
    scheduled = float(np.interp(20.0, ego.plan.curve.step * np.arange(len(ego.plan.times)), ego.plan.times))
    now = scheduled + 7.0
    other = replace(ego.plan, times=ego.plan.times - ego.plan.times[0] + now)
    assert replanned(drive, other, now).plan.on_schedule(0.0, now)[0] == pytest.approx(7.0)
