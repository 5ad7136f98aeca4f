"""The speed envelope and the (l, t_l) of P."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from planner_roads import CAR, corner, graph, road, start_on

from sumo_reactive.driver.nouns.constraint import TimeConstraint
from sumo_reactive.driver.path.planner import plan
from sumo_reactive.driver.path.time_constraints import accelerating_from, braking_to, retimed
from sumo_reactive.driver.world.route import Route, ScheduledStop

SPEEDS = arrays(float, st.integers(2, 60), elements=st.floats(0.0, 40.0))


@given(SPEEDS, st.floats(0.5, 5.0))
def test_the_envelope_can_be_braked_along(speeds: np.ndarray, deceleration: float) -> None:
    lowered = braking_to(speeds, 0.5, deceleration)
    assert np.all(lowered <= speeds + 1e-6)
    assert np.all(lowered[:-1] ** 2 - lowered[1:] ** 2 <= 2.0 * deceleration * 0.5 + 1e-6)


@given(SPEEDS, st.floats(0.5, 5.0))
def test_a_driven_profile_accelerates_no_harder_than_the_car(speeds: np.ndarray, acceleration: float) -> None:
    lowered = accelerating_from(speeds, 0.5, acceleration)
    assert np.all(np.diff(lowered**2) <= 2.0 * acceleration * 0.5 + 1e-6)


def test_the_envelope_keeps_lane_limits_and_slows_down_before_a_bend() -> None:
    world = corner(8.0, 10)
    found = plan(world, Route(("a", "b")), CAR, start_on(world.lanes["a_0"], 10.0))
    assert found.speed_limits.max() <= 13.9
    assert 3.5 < found.speed_limits.min() < 5.5
    assert np.all(-np.diff(found.speed_limits**2) <= 2.0 * CAR.comfort_deceleration * 0.5 + 1e-6)


def test_time_constraints_increase_along_the_curve() -> None:
    world = corner(8.0, 10)
    found = plan(world, Route(("a", "b")), CAR, start_on(world.lanes["a_0"], 10.0))
    times = [c.time for c in found.time_constraints]
    places = [c.s for c in found.time_constraints]
    assert len(times) == 3
    assert times == sorted(times) and places == sorted(places)
    assert times[0] > 100.0


def test_a_straight_road_takes_length_over_speed() -> None:
    world = graph([road("a", [(0, 0), (500, 0)], speed=10.0)], [])
    (goal,) = plan(world, Route(("a",)), CAR, start_on(world.lanes["a_0"], 10.0)).time_constraints
    assert goal.time == pytest.approx(100.0 + 49.0, abs=0.3)


@pytest.mark.parametrize(("until", "leaves"), [(None, 30.0), (200.0, 85.0)])
def test_a_scheduled_stop_delays_what_follows(until: float | None, leaves: float) -> None:
    world = graph([road("a", [(0, 0), (500, 0)], speed=10.0)], [])
    route = Route(("a",), stops=(ScheduledStop("a_0", 150.0, 30.0, until),))
    halt, goal = plan(world, route, CAR, start_on(world.lanes["a_0"], 10.0)).time_constraints
    assert halt.time == pytest.approx(116.0, abs=0.5)
    departs = 200.0 if until else halt.time + 30.0
    assert goal.time == pytest.approx(departs + 36.9, abs=0.5)


# --- planned anew: the answer that the paper names for a delay ----------------------------------------------------------


def straight_plan(stops=(), slack: float = 0.0):
    """A plan of 500 m at 10 m/s that begins at time 100 s, every (l, t_l) put off by `slack` s."""
    world = graph([road("a", [(0, 0), (500, 0)], speed=10.0)], [])
    found = plan(world, Route(("a",), stops=stops), CAR, start_on(world.lanes["a_0"], 10.0))
    return replace(found, time_constraints=tuple(TimeConstraint(c.s, c.time + slack) for c in found.time_constraints))


def test_planned_anew_a_constraint_that_can_still_be_met_is_kept() -> None:
    found = straight_plan(slack=5.0)
    assert retimed(found, 100.0, 10.0, 113.0, CAR, found.stops) == found.time_constraints


def test_planned_anew_a_constraint_that_cannot_be_met_becomes_the_earliest_that_limits_allow() -> None:
    found = straight_plan()
    goal = found.time_constraints[-1]
    (later,) = retimed(found, 100.0, 10.0, 130.0, CAR, found.stops)
    assert later.s == goal.s
    assert later.time == pytest.approx(130.0 + (goal.s - CAR.front_overhang - 100.0) / 10.0, abs=0.3)
    assert later.time > goal.time


def test_planned_anew_a_standing_car_is_given_the_time_to_speed_up() -> None:
    found = straight_plan()
    standing, driving = (retimed(found, 100.0, speed, 130.0, CAR, found.stops)[0].time for speed in (0.0, 10.0))
    assert standing - driving == pytest.approx(0.5 * 10.0 / CAR.max_acceleration, abs=0.3)


def test_planned_anew_the_duration_of_a_stop_ahead_is_kept() -> None:
    found = straight_plan(stops=(ScheduledStop("a_0", 150.0, 30.0, None),))
    halt, goal = retimed(found, 50.0, 10.0, 140.0, CAR, found.stops)
    assert goal.time - halt.time >= 30.0 + (goal.s - halt.s) / 10.0 - 0.5


def test_planned_anew_places_behind_the_front_are_gone() -> None:
    found = straight_plan(stops=(ScheduledStop("a_0", 150.0, 30.0, None),))
    behind = found.stops[0].s + 5.0
    assert [c.s for c in retimed(found, behind, 5.0, 160.0, CAR, found.stops)] == [found.time_constraints[-1].s]
