"""Step 1 of the pilot: does going on end in a collision, a missed (l, t_l) or an excessive delay? (F&L 1991, §2)"""

import math

import numpy as np
import pytest
from helpers.cars import CAR
from helpers.curves import on_curve, plan_along, seen, straight
from helpers.situations import before

from sumo_reactive.driver.nouns.assessment import Assessment, PlanOutcome
from sumo_reactive.driver.nouns.constraint import TimeConstraint, stop_at
from sumo_reactive.driver.nouns.decision import Reason
from sumo_reactive.driver.nouns.forecast import Forecast
from sumo_reactive.driver.parameters import USUAL
from sumo_reactive.driver.pilot.assessment import (
    ASSESSMENT_STEP_S,
    assess,
    passing,
    simulate,
    time_of,
    way_of,
)
from sumo_reactive.driver.pilot.passages import View
from sumo_reactive.driver.vehicle.travel_time import travel_time
from sumo_reactive.driver.view.foresee import NOBODY

ROAD = plan_along(straight(), 10.0)
FRONT = 10.0
LENGTH, WIDTH = 4.0, 2.0
EAST, NORTH = 0.0, 0.5 * math.pi


def forecast_of(*ways: tuple[str, float, float, float, float]) -> Forecast:
    """One straight path each: name, front's x, y, heading, speed."""
    s = np.arange(0.0, 302.0, 2.0)
    points = [np.column_stack([x + s * math.cos(h), y + s * math.sin(h), np.full(len(s), h)]) for _, x, y, h, _ in ways]
    first = np.arange(len(ways)) * len(s)
    bodies = np.array([(0.0, 0.0, speed, LENGTH, WIDTH, 13.9) for *_, speed in ways])
    return Forecast(tuple(way[0] for way in ways), np.vstack(points), first, np.full(len(ways), len(s)), bodies)


def going_on(forecast=NOBODY, stop=None, trusted=(), target=None) -> Assessment:
    """The assessment of an ego at 10 m/s on a straight road, its bumper at x = 10 m."""
    snapshot = seen(on_curve(ROAD.curve, FRONT, 10.0), ROAD, FRONT - CAR.front_overhang, time=100.0)
    return assess(View(snapshot, ROAD, CAR, (), ()), forecast, stop, target, trusted)


def crosser(meeting_x: float, away: float, speed: float, name: str = "x") -> Forecast:
    """Somebody from the right on x = `meeting_x`, his front `away` m before the ego's axis."""
    return forecast_of((name, meeting_x, -away, NORTH, speed))


# --- failure ----------------------------------------------------------------------------------------------------------


def test_a_collision_is_foreseen_with_its_user_its_time_and_its_place():
    """His front reaches the ego's side at y = −0.9 m after 3.82 s; the ego's front his side at x = 49 m after 3.9 s."""
    found = going_on(crosser(50.0, 20.0, 5.0))
    assert found.outcome is PlanOutcome.FAILURE
    assert found.encounter.user_id == "x"
    assert found.encounter.time == pytest.approx(104.0, abs=0.1)
    assert (found.encounter.s, found.encounter.x, found.encounter.y) == pytest.approx((50.0, 50.0, 0.0), abs=0.6)


@pytest.mark.parametrize(("away", "speed"), [(27.0, 5.0), (8.0, 5.0)], ids=["behind the ego", "before the ego"])
def test_who_crosses_at_another_time_is_no_failure(away, speed):
    assert going_on(crosser(50.0, away, speed)).outcome is not PlanOutcome.FAILURE


def test_who_is_met_only_after_the_assessed_time_is_no_failure():
    """The ego is at x = 150 m after 14 s."""
    assert going_on(crosser(150.0, 70.0, 5.0)).outcome is not PlanOutcome.FAILURE


def test_the_first_encounter_counts():
    ways = ("late", 70.0, -30.0, NORTH, 5.0), ("early", 50.0, -20.0, NORTH, 5.0)
    assert going_on(forecast_of(*ways)).encounter.user_id == "early"


def test_somebody_who_comes_towards_the_ego_is_a_failure():
    found = going_on(forecast_of(("x", 110.0, 0.0, math.pi, 10.0)))
    assert found.encounter.time == pytest.approx(105.0, abs=0.21)
    assert found.encounter.s == pytest.approx(60.0, abs=2.1)


def test_somebody_who_comes_on_the_other_lane_is_no_failure():
    assert going_on(forecast_of(("x", 110.0, 3.2, math.pi, 10.0))).outcome is not PlanOutcome.FAILURE


def test_a_stop_that_nothing_can_put_off_is_taken_into_account():
    stop = stop_at(40.0, Reason.RED_LIGHT)
    assert going_on(crosser(50.0, 20.0, 5.0), stop=stop).outcome is not PlanOutcome.FAILURE


def test_who_is_trusted_to_yield_is_not_counted():
    assert going_on(crosser(50.0, 20.0, 5.0), trusted={"x"}).outcome is not PlanOutcome.FAILURE
    both = forecast_of(("x", 50.0, -20.0, NORTH, 5.0), ("y", 50.0, 20.0, -NORTH, 5.0))
    assert going_on(both, trusted={"x"}).encounter.user_id == "y"


def test_who_follows_behind_has_to_look_out_himself():
    assert going_on(forecast_of(("x", 1.0, 0.0, EAST, 20.0))).outcome is not PlanOutcome.FAILURE


def test_both_branches_of_an_unknown_route_are_looked_at():
    """An oncoming car that may turn left across the ego's way."""
    ego = before("four_way_priority", ("from_west", "to_east"), 20.0, 10.0)

    def outcome(*route: str) -> PlanOutcome:
        return ego.considered(ego.other("x", "from_east_0", -11.0, 8.0, route)).assessment.outcome

    assert outcome("from_east", "to_west") is not PlanOutcome.FAILURE
    assert outcome("from_east", "to_south") is PlanOutcome.FAILURE
    assert outcome() is PlanOutcome.FAILURE


# --- degraded ---------------------------------------------------------------------------------------------------------

LIMIT = 22.22


@pytest.fixture(scope="module")
def country():
    return before("two_way_road", ("eastbound", "eastbound_out"), 620.0, 8.5)


def lateness_behind(speed: float) -> float:
    """How much longer than on schedule, from `speed` with the car's acceleration, the way takes that X allows."""
    way = speed * USUAL.assessed_s
    top = math.sqrt(speed**2 + 2.0 * CAR.max_acceleration * way)
    assert top < LIMIT
    return USUAL.assessed_s - (top - speed) / CAR.max_acceleration


def test_alone_on_schedule_the_plan_is_fine(country):
    found = country.considered().assessment
    assert found.outcome is PlanOutcome.FINE
    assert found.encounter is None
    assert found.lateness < 1.5


def test_a_slow_leader_makes_the_ego_later_by_what_it_loses_behind_him(country):
    settled = CAR.standstill_gap + CAR.time_headway * 8.5
    found = country.considered(country.ahead("x", settled, 8.5)).assessment
    assert found.lateness == pytest.approx(lateness_behind(8.5), abs=0.3)
    assert found.outcome is PlanOutcome.FINE


def test_a_delay_that_becomes_excessive_behind_a_slow_leader_degrades_the_plan(country):
    assert 3.0 + lateness_behind(8.5) > USUAL.excessive_delay_s
    found = country.late_by(3.0).considered(country.ahead("x", 10.5, 8.5)).assessment
    assert found.outcome is PlanOutcome.DEGRADED
    assert found.lateness == pytest.approx(3.0 + lateness_behind(8.5), abs=0.3)
    assert found.lateness > USUAL.excessive_delay_s


def test_a_collision_weighs_more_than_a_delay():
    ego = before("four_way_priority", ("from_west", "to_east"), 20.0, 10.0).late_by(20.0)
    found = ego.considered(ego.other("x", "from_east_0", -11.0, 8.0, ("from_east", "to_south"))).assessment
    assert found.outcome is PlanOutcome.FAILURE
    assert found.lateness > USUAL.excessive_delay_s


def test_the_assessment_names_the_place_of_the_next_time_constraint():
    assert going_on(target=TimeConstraint(77.0, 0.0)).constraint == 77.0


# --- when the ego is in a region --------------------------------------------------------------------------------------


def moving(*speeds: float):
    """A motion that has each of the `speeds` (m/s) for one second."""
    held = np.repeat(speeds, round(1.0 / ASSESSMENT_STEP_S))
    s = 50.0 + ASSESSMENT_STEP_S * np.concatenate(([0.0], np.cumsum(held)))
    return np.column_stack((s, 0.0 * s, 0.0 * s, np.append(held, speeds[-1]), s))


def test_the_times_at_a_region_are_read_off_the_motion():
    """10 m in the first second, 4 m in the next two: at 6 m, with its rear there at 11 m, and gone at 13 m."""
    motion = moving(10.0, 4.0, 4.0)
    assert time_of(motion, 6.0, ASSESSMENT_STEP_S) == pytest.approx(0.6)
    assert passing(motion, 0.5, 6.0, 13.0, 5.0) == pytest.approx((0.5, 1.75, 1.25, 4.0))


def test_a_place_behind_is_reached_already():
    assert time_of(moving(10.0), 0.0, ASSESSMENT_STEP_S) == time_of(moving(10.0), -3.0, ASSESSMENT_STEP_S) == 0.0


@pytest.mark.parametrize(("last", "time"), [(5.0, 2.0 + 15.0 / 5.0), (0.0, 2.0 + 20.0 / 0.1)])
def test_beyond_the_end_of_a_motion_its_last_speed_counts(last, time):
    assert time_of(moving(10.0, last), 30.0, ASSESSMENT_STEP_S) == pytest.approx(time)


def simulated(speed: float, stop: float | None = None, duration: float = 8.0):
    """The motion of an ego with its bumper at x = 10 m on a straight road where 10 m/s are allowed."""
    snapshot = seen(on_curve(ROAD.curve, FRONT, speed), ROAD, FRONT - CAR.front_overhang)
    way = way_of(ROAD) if stop is None else way_of(ROAD, stop)
    return simulate(snapshot, way, np.empty((0, 3)), CAR, duration)


def test_who_starts_is_foreseen_to_speed_up_as_the_executor_does():
    """A quarter of a second to its acceleration; to the road's speed asymptotically."""
    motion = simulated(0.0)
    assert motion[1, 3] == pytest.approx(USUAL.comfort_jerk * ASSESSMENT_STEP_S**2)
    free = travel_time(50.0, 0.0, CAR.acceleration_in_plan, 10.0)
    assert time_of(motion, 50.0, ASSESSMENT_STEP_S) == pytest.approx(free, abs=ASSESSMENT_STEP_S)
    assert np.diff(motion[:, 3]).max() <= CAR.acceleration_in_plan * ASSESSMENT_STEP_S + 1e-9
    assert 9.0 < motion[-1, 3] < 10.0


@pytest.mark.parametrize("speed", [10.0, 4.0, 0.0])
def test_who_means_to_stop_just_behind_a_region_leaves_it_later(speed):
    stops, on = simulated(speed, 40.0), simulated(speed)
    for way in (28.0, 29.5):
        assert time_of(stops, way, ASSESSMENT_STEP_S) > time_of(on, way, ASSESSMENT_STEP_S) + 0.5
    assert time_of(stops, 5.0, ASSESSMENT_STEP_S) == pytest.approx(time_of(on, 5.0, ASSESSMENT_STEP_S), abs=0.05)


def test_who_stops_far_behind_a_region_leaves_it_as_fast_as_others():
    assert time_of(simulated(10.0, 90.0), 20.0, ASSESSMENT_STEP_S) == time_of(simulated(10.0), 20.0, ASSESSMENT_STEP_S)
