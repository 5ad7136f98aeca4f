"""What becomes of the time constraints after a delay: shifted as in the paper, or planned anew (F&L 1991, §2)."""

import pytest
from helpers.situations import before

from sumo_reactive.driver.nouns.completed_plan import Replanning
from sumo_reactive.driver.nouns.event import Event, EventKind
from sumo_reactive.driver.parameters import Delays
from sumo_reactive.driver.pilot.schedule import adjusted

LATE = (Event(EventKind.DELAY),)


@pytest.fixture(scope="module")
def ego():
    """The ego at the beginning of its plan, six seconds late."""
    return before("four_way_priority", ("from_west", "to_east"), 120.0, 10.0).late_by(6.0)


@pytest.fixture(scope="module")
def planned(ego):
    """The pilot's memory of a plan that it has accepted when it was on time."""
    on_time = before("four_way_priority", ("from_west", "to_east"), 120.0, 10.0)
    memory = on_time.step().drive.memory
    premises = memory.premises._replace(view=memory.premises.view._replace(plan=ego.plan))
    return memory._replace(premises=premises, schedule=ego.plan.time_constraints)


def later_by(ego, found) -> list[float]:
    return [c.time - p.time for c, p in zip(found, ego.plan.time_constraints, strict=True)]


@pytest.mark.parametrize("kind", [EventKind.DELAY, EventKind.CONSTRAINT_MISSED])
def test_shift_adds_the_delay_to_every_later_constraint(ego, planned, kind):
    found, asks, memory = adjusted(ego.seen(), ego.plan, planned, (Event(kind),), Delays.SHIFT)
    assert later_by(ego, found) == pytest.approx([6.0] * len(found), abs=0.1)
    assert [c.s for c in found] == [c.s for c in ego.plan.time_constraints]
    assert (asks, memory.delay) == (Replanning.NOTHING, pytest.approx(6.0, abs=0.1))


def test_a_second_shift_does_not_add_the_first_delay_again(ego, planned):
    _, _, memory = adjusted(ego.seen(), ego.plan, planned, LATE, Delays.SHIFT)
    found, _, _ = adjusted(ego.seen()._replace(time=103.0), ego.plan, memory, LATE, Delays.SHIFT)
    assert later_by(ego, found) == pytest.approx([9.0] * len(found), abs=0.1)


def test_replan_asks_the_planner_for_times_and_leaves_the_old_ones_until_then(ego, planned):
    found, asks, memory = adjusted(ego.seen(), ego.plan, planned, LATE, Delays.REPLAN)
    assert asks is Replanning.TIMES
    assert found == ego.plan.time_constraints
    assert memory.delay == pytest.approx(6.0, abs=0.1)


@pytest.mark.parametrize("delays", Delays)
def test_without_delay_the_constraints_stay_as_they_are(ego, planned, delays):
    found, asks, memory = adjusted(ego.seen(), ego.plan, planned, (Event(EventKind.NEW_OBSTACLE),), delays)
    assert (found, asks, memory.delay) == (ego.plan.time_constraints, Replanning.NOTHING, 0.0)


def test_constraints_behind_the_front_bumper_are_dropped(ego, planned):
    first, *rest = ego.plan.time_constraints
    past = ego.seen()._replace(front=first.s + 0.1)
    assert adjusted(past, ego.plan, planned, (), Delays.REPLAN)[0] == tuple(rest)


def test_a_new_plan_brings_its_own_constraints(ego, planned):
    other = before("four_way_priority", ("from_west", "to_east"), 100.0, 10.0)
    found, _, memory = adjusted(other.seen(), other.plan, planned, (), Delays.SHIFT)
    assert found == memory.schedule == other.plan.time_constraints


@pytest.mark.parametrize("delays", Delays)
def test_after_a_wait_the_controller_aims_at_times_that_can_be_met(delays):
    """A car stands ahead for ten seconds and is gone."""
    ego = before("multi_lane_road", ("road_before_exit", "road_after_exit"), 300.0, 10.0)
    queue = ego.ahead("queue", 20.0, 0.0)
    steps = ego.driven_among(lambda t: [queue] if t < 14.0 else [], 16.0, delays=delays)
    held = steps[-1].drive.completed.constraints
    assert held[0].time >= ego.plan.time_constraints[0].time + 5.0
    assert [c.s for c in held] == [c.s for c in ego.plan.time_constraints]
