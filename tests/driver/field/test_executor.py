"""One command from the potential field: within the limits, along C, before the stop, behind the leader (F&L 1991, §3.2)."""

import math
from dataclasses import replace

import numpy as np
import pytest
from helpers.cars import CAR, car_at
from helpers.curves import asked, driven, on_curve, plan_along, seen, straight, turning
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from sumo_reactive.driver.field.executor import execute
from sumo_reactive.driver.geometry.curve import Curve
from sumo_reactive.driver.nouns.constraint import TimeConstraint, stay_behind, stop_at
from sumo_reactive.driver.nouns.decision import Instruction, Reason
from sumo_reactive.driver.nouns.record import BEND, STOP_PLACE
from sumo_reactive.driver.nouns.state import Pose, VehicleState
from sumo_reactive.driver.parameters import USUAL
from sumo_reactive.driver.pilot.instructions import TUNINGS
from sumo_reactive.driver.vehicle.safe_speed import HARD_STOP_MARGIN_M

ROAD = plan_along(straight())
TIGHT = 4.4
"""m; the tightest turn of the project's own trial."""


def tight_turn() -> Curve:
    """A left turn by 90° of 4.4 m radius whose ends are rounded over 1.6 m, the planner's smoothing length."""
    ramp = [(i + 0.5) / 8 / TIGHT for i in range(8)]
    arc = 0.5 * math.pi * TIGHT - 1.6
    return turning([20.0, *[0.2] * 8, arc, *[0.2] * 8, 40.0], [0.0, *ramp, 1.0 / TIGHT, *ramp[::-1], 0.0])


def deviation(speed: float, speed_limit: float = 13.9, **options) -> float:
    """Root mean square distance (m) of the front axle to C through the tight turn."""
    plan = plan_along(tight_turn(), speed_limit)
    seconds = 8.0 if speed_limit > speed else 40.0 / speed
    trace = list(driven(plan, on_curve(plan.curve, 5.0, speed), lambda _: asked(plan), seconds, **options))
    assert trace[-1][0].s > 27.0
    return math.sqrt(np.mean([snapshot.d**2 for snapshot, _ in trace if 15.0 < snapshot.s < 40.0]))


cars = st.builds(car_at, st.just("x"), st.floats(0, 40), st.floats(-8, 8), st.floats(-math.pi, math.pi), st.floats(0, 20))


@given(
    st.floats(0.0, 20.0), st.floats(-0.65, 0.65), st.floats(-0.5, 0.5), st.floats(-1.5, 1.5), st.floats(0.02, 0.1),
    st.lists(cars, max_size=4), st.one_of(st.none(), st.floats(5.0, 60.0)), st.booleans(),
)  # fmt: skip
def test_no_command_breaks_a_limit_whatever_the_situation(speed, angle, heading, offset, period, users, stop, nine):
    pose = Pose(10.0, offset, heading)
    before = VehicleState(pose, speed, angle, 0.0)
    completed = asked(ROAD, None if stop is None else stop_at(10.0 + stop, Reason.RED_LIGHT))
    execution = execute(seen(before, ROAD, 12.0, users), completed, CAR, period, nine_commands=nine)
    after, command = execution.state, execution.command
    assert -CAR.emergency_deceleration <= command.acceleration <= CAR.max_acceleration
    assert abs(command.steering_rate) <= CAR.max_steering_rate + 1e-9
    assert after.speed >= 0.0
    assert abs(after.steering_angle) <= CAR.max_steering_angle + 1e-6
    present, lateral = (abs(q.speed**2 * math.sin(q.steering_angle)) / CAR.wheelbase for q in (before, after))
    assert lateral <= max(CAR.max_lateral_acceleration, present) + 1e-9


@pytest.mark.parametrize("speed", [3.0, 10.0])
def test_the_lattice_keeps_within_three_centimetres_in_a_turn_of_4_4_m(speed):
    assert deviation(speed) < 0.03


@pytest.mark.parametrize("speed", [3.0, 10.0])
def test_the_lattice_keeps_within_one_centimetre_in_a_turn_of_4_4_m(speed):
    assert deviation(speed) < 0.01


@pytest.mark.parametrize("speed", [2.0, 3.0, 4.0])
def test_nine_commands_keep_within_five_centimetres_in_a_turn_of_4_4_m(speed):
    """At speeds whose lateral acceleration the turn allows; without bitmaps, at the default control period."""
    assert deviation(speed, speed_limit=speed, nine_commands=True) < 0.05


def test_a_car_beside_the_curve_comes_back_to_it_and_stays():
    start = VehicleState(Pose(0.0, 1.0, 0.0), 10.0, 0.0)
    offsets = [snapshot.d for snapshot, _ in driven(ROAD, start, lambda _: asked(ROAD), 8.0)]
    assert abs(offsets[-1]) < 0.02
    assert min(offsets) > -0.25


def test_a_free_car_reaches_the_speed_of_the_road_and_keeps_it():
    speeds = [
        execution.state.speed for _, execution in driven(ROAD, on_curve(ROAD.curve, 5.0, 0.0), lambda _: asked(ROAD), 20.0)
    ]
    assert max(speeds) <= 13.9 + 1e-6
    assert speeds[-1] == pytest.approx(13.9, abs=0.05)


@settings(max_examples=40)
@given(st.floats(0.0, 25.0), st.floats(0.2, 120.0), st.floats(0.05, 0.1))
def test_it_stops_before_a_stop_from_any_speed_at_which_it_can(speed, distance, period):
    assume(speed * period + speed**2 / (2.0 * CAR.emergency_deceleration) < distance - 0.2)
    plan = plan_along(straight(), 25.0)
    stop = stop_at(10.0 + distance, Reason.RED_LIGHT)
    end = [
        (snapshot.front, execution.state.speed)
        for snapshot, execution in driven(plan, on_curve(plan.curve, 10.0, speed), lambda _: asked(plan, stop), 40.0, period)
    ]
    assert max(front for front, _ in end) < stop.s
    assert end[-1][1] < 0.05
    assert stop.s - end[-1][0] < max(2.5, distance * (distance < 2.5) + 0.1)


@pytest.mark.parametrize("distance", [50.0, 70.0, 100.0])
def test_it_stops_comfortably_when_it_has_room_to(distance):
    stop = stop_at(10.0 + distance, Reason.RED_LIGHT)
    end = driven(ROAD, on_curve(ROAD.curve, 10.0, 13.0), lambda _: asked(ROAD, stop), 30.0)
    assert min(execution.state.acceleration for _, execution in end) >= -CAR.comfort_deceleration - 0.6


@settings(max_examples=30)
@given(st.floats(1.0, 40.0), st.floats(0.0, 20.0), st.floats(0.0, 6.0))
def test_it_never_runs_into_a_leader_that_brakes_as_hard_as_it_can(gap, speed, brakes_at):
    """The leader keeps its speed, then brakes with 9 m/s²; both begin at the same speed."""
    assume(gap > 0.6 + speed * 0.1)

    def leader(time: float) -> TimeConstraint:
        braking = min(max(0.0, time - brakes_at), speed / 9.0)
        way = speed * min(time, brakes_at + braking) - 4.5 * braking**2
        return stay_behind("x", 10.0 + gap + way, max(0.0, speed - 9.0 * braking), 9.0)

    plan = plan_along(straight(), 20.0)
    trace = driven(plan, on_curve(plan.curve, 10.0, speed), lambda _: asked(plan), 14.0, leaders=lambda t: (leader(t),))
    for k, (snapshot, _) in enumerate(trace):
        assert leader(0.1 * k).s - snapshot.front > 0.0


def test_it_settles_behind_a_slower_leader_at_a_safe_gap():
    trace = list(
        driven(
            ROAD,
            on_curve(ROAD.curve, 10.0, 13.0),
            lambda _: asked(ROAD),
            30.0,
            leaders=lambda t: (stay_behind("x", 50.0 + 8.0 * t, 8.0, 9.0),),
        )
    )
    snapshot, execution = trace[-1]
    gap = 50.0 + 8.0 * snapshot.time - snapshot.front
    assert execution.state.speed == pytest.approx(8.0, abs=0.1)
    assert gap == pytest.approx(CAR.standstill_gap + CAR.time_headway * 8.0, abs=1.0)
    assert not any(e.emergency for _, e in trace)


def test_a_wall_that_appears_too_near_is_an_emergency_and_brakes_as_hard_as_it_can():
    wall = car_at("wall", 10.0 + 8.0, 0.0, 0.5 * math.pi, 0.0)
    execution = execute(seen(on_curve(ROAD.curve, 10.0, 15.0), ROAD, 9.0, [wall]), asked(ROAD), CAR, 0.1)
    assert execution.emergency
    assert execution.command.acceleration == -CAR.emergency_deceleration


def test_a_leader_too_near_to_stop_behind_is_an_emergency():
    leader = stay_behind("x", 15.0, 0.0, 9.0)
    execution = execute(seen(on_curve(ROAD.curve, 10.0, 15.0), ROAD, 9.0, leaders=(leader,)), asked(ROAD), CAR, 0.1)
    assert execution.emergency
    assert execution.command.acceleration == -CAR.emergency_deceleration


def test_a_free_road_is_no_emergency():
    execution = execute(seen(on_curve(ROAD.curve, 10.0, 13.0), ROAD, 9.0), asked(ROAD), CAR, 0.1)
    assert not execution.emergency
    assert execution.potentials.shadow == 0.0


def test_the_potential_is_the_weighted_sum_of_its_three_terms():
    ahead = car_at("x", 40.0, 0.0, 0.0, 2.0)
    execution = execute(seen(on_curve(ROAD.curve, 10.0, 10.0), ROAD, 9.0, [ahead]), asked(ROAD), CAR, 0.1)
    u, w = execution.potentials, asked(ROAD).tuning.weights
    assert u.shadow > 0.0
    assert u.total == pytest.approx(w.valley * u.valley + w.shadow * u.shadow + w.velocity * u.velocity)


def braked(
    speed: float, stop: float | None = None, leader: TimeConstraint | None = None, plan=ROAD, acceleration: float = 0.0
):
    """Return the execution of a car with its front bumper at 10 m."""
    state = on_curve(plan.curve, 10.0, speed)._replace(acceleration=acceleration)
    leaders = () if leader is None else (leader,)
    completed = asked(plan, None if stop is None else stop_at(stop, Reason.RED_LIGHT))
    return execute(seen(state, plan, 9.0, leaders=leaders), completed, CAR, 0.1)


@pytest.mark.parametrize("speed", [2.0, 8.0, 13.0])
def test_a_stop_that_planned_braking_reaches_is_no_emergency_however_late_it_appears(speed):
    way = speed**2 / (2.0 * USUAL.planned_deceleration) + HARD_STOP_MARGIN_M + 0.01
    execution = braked(speed, stop=10.0 + way)
    assert not execution.emergency
    assert execution.state.acceleration == pytest.approx(-USUAL.planned_deceleration)


@pytest.mark.parametrize("share", [0.95, 0.7, 0.4])
def test_a_stop_nearer_than_that_is_an_emergency_that_is_named(share):
    execution = braked(13.0, stop=10.0 + share * 13.0**2 / (2.0 * USUAL.planned_deceleration))
    assert execution.emergency
    assert execution.hazard == STOP_PLACE
    assert execution.state.acceleration < -USUAL.planned_deceleration


@settings(max_examples=40)
@given(st.floats(0.5, 20.0), st.floats(1.0, 2.0), st.floats(0.05, 0.1))
def test_planned_braking_for_a_late_stop_never_becomes_an_emergency(speed, room, period):
    """Neither the period nor the onset of braking uses up the way that was enough."""
    plan = plan_along(straight(), 25.0)
    stop = stop_at(10.0 + room * speed**2 / (2.0 * USUAL.planned_deceleration) + HARD_STOP_MARGIN_M + 0.05, Reason.RED_LIGHT)
    trace = list(driven(plan, on_curve(plan.curve, 10.0, speed), lambda _: asked(plan, stop), 12.0, period))
    assert not any(execution.emergency for _, execution in trace)
    assert min(execution.state.acceleration for _, execution in trace) > -USUAL.planned_deceleration - 0.01
    assert max(snapshot.front for snapshot, _ in trace) < stop.s


def test_a_leader_that_stands_too_near_is_named():
    execution = braked(10.0, leader=stay_behind("x", 22.0, 0.0, 9.0))
    assert (execution.emergency, execution.hazard) == (True, "x")


def test_a_body_that_appears_before_a_creeping_car_is_stopped_for_without_an_emergency():
    execution = braked(1.0, leader=stay_behind("x", 10.6, 0.0, 9.0))
    assert not execution.emergency
    assert -USUAL.planned_deceleration - 0.01 < execution.state.acceleration < -2.0


def test_an_emergency_ends_at_once():
    assert braked(10.0, acceleration=-9.0).state.acceleration > -USUAL.planned_deceleration


@pytest.mark.parametrize(("speed", "is_emergency"), [(8.0, False), (11.0, True)])
def test_too_fast_for_a_bend_is_an_emergency_only_if_planned_braking_does_not_hold_it(speed, is_emergency):
    """A bend of 12 m radius begins 4.9 m before the axle; 3.6 m/s² sideways allow 6.6 m/s, planned braking from 8.5 m/s."""
    plan = plan_along(turning([14.0, 18.0, 60.0], [0.0, 1.0 / 12.0, 0.0]))
    execution = braked(speed, plan=plan)
    assert (execution.emergency, execution.hazard) == ((True, BEND) if is_emergency else (False, ""))


def test_a_lower_speed_limit_is_never_an_emergency():
    execution = braked(20.0, plan=plan_along(straight(), 8.0))
    assert not execution.emergency
    assert execution.state.acceleration >= -USUAL.planned_deceleration - 1e-9


def test_a_car_too_fast_for_the_bend_that_it_stands_in_brakes_hard_and_stays_near_its_lane():
    """A bend by 0.2 rad within 5 m at 23 m/s, which 4 m/s² sideways do not hold."""
    plan = plan_along(turning([10.0, 5.0, 200.0], [0.0, 0.04, 0.0]), 25.0)
    trace = list(driven(plan, on_curve(plan.curve, 10.0, 23.0), lambda _: asked(plan), 4.0))
    assert trace[0][1].hazard == BEND
    assert max(abs(snapshot.d) for snapshot, _ in trace) < 2.0
    assert not any(execution.emergency for _, execution in trace[12:])


def test_a_bend_that_carries_the_car_less_than_its_free_room_out_is_no_emergency():
    plan = plan_along(turning([10.0, 5.0, 200.0], [0.0, 0.012, 0.0]), 25.0)
    trace = list(driven(plan, on_curve(plan.curve, 10.0, 20.0), lambda _: asked(plan), 4.0))
    assert not any(execution.emergency for _, execution in trace)


@pytest.mark.parametrize(("at", "goes"), [(-1.0, True), (-1.0 + 1.1 * CAR.length, False)])
def test_an_ego_that_is_touched_from_the_side_may_squeeze_on_and_not_into_whom_it_touches_ahead(at, goes):
    """The other's rear or front corner is 0.1 m inside its body."""
    beside = car_at("x", 10.0 + at, CAR.width - 0.1, 0.0, 0.0)
    squeezing = replace(asked(ROAD), instruction=Instruction.WIDEN, tuning=TUNINGS[Instruction.WIDEN])
    here = seen(on_curve(ROAD.curve, 10.0, 0.0), ROAD, 9.0, [beside])
    assert execute(here, asked(ROAD), CAR, 0.1).state.speed == 0.0
    assert (execute(here, squeezing, CAR, 0.1).state.speed > 0.0) is goes
