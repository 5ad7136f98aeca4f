"""The pilot is activated asynchronously: by each kind of event, and by nothing else (F&L 1991, §2)."""

import math

import pytest
from helpers.cars import CAR
from helpers.situations import PERIOD, before

from sumo_reactive.driver.controller import Controller, Step
from sumo_reactive.driver.nouns.decision import Reason
from sumo_reactive.driver.nouns.event import Event, EventKind
from sumo_reactive.driver.parameters import USUAL, Profile
from sumo_reactive.driver.pilot.events import detect
from sumo_reactive.driver.pilot.pilot import notice
from sumo_reactive.driver.view.ahead import passages_ahead
from sumo_reactive.driver.world.route import ScheduledStop

SOUTH_NORTH, WEST_EAST = ("from_south", "to_north"), ("from_west", "to_east")
ROAD = ("road_before_exit", "road_after_exit")
TO_EXIT = ("road_before_exit", "exit")
NEXT = 100.0 + PERIOD


@pytest.fixture(scope="module")
def alone():
    """The ego on a straight road of three lanes, at the speed of the road."""
    return before("multi_lane_road", ROAD, 380.0, 15.0)


def kinds(steps) -> list[EventKind]:
    """The kinds of all events of a drive, in order."""
    return [event.kind for step in steps for event in step.completed.events]


def events_after(ego, first, users=(), lights=None, time=NEXT, **memory) -> tuple[Event, ...]:
    """The events of the step after a first one, with a changed memory."""
    drive = first.drive
    changed = drive.memory._replace(**memory)
    snapshot = ego.seen(*users, lights=lights)._replace(time=time)
    ahead = passages_ahead(ego.graph, ego.plan, ego.limits, snapshot.passages)
    return detect(snapshot, ego.plan, ahead, drive.completed, notice(snapshot, changed), no_command=False)


# --- between events the pilot does not run ----------------------------------------------------------------------------


@pytest.mark.parametrize("profile", Profile)
def test_alone_on_a_straight_road_the_pilot_runs_once_in_a_hundred_steps(alone, profile):
    assert kinds(alone.driven(100 * PERIOD, profile=profile)) == [EventKind.NEW_PLAN]


def test_somebody_ahead_who_keeps_his_speed_is_no_event(alone):
    ahead = alone.ahead("ahead", 60.0, 17.0)
    assert kinds(alone.driven_among(lambda t: [alone.later(ahead, t)], 5.0)) == [EventKind.NEW_PLAN]


def test_between_events_the_completed_plan_stays_in_force(alone):
    first, *later = alone.driven(2.0)
    assert all(step.completed == first.completed.held() for step in later)


def test_what_the_pilot_asks_of_the_planner_it_asks_once():
    first, second, *_ = before("multi_lane_road", TO_EXIT, 200.0, 15.0, lane=1).driven(0.3)
    assert first.completed.request.change_lane == -1
    assert second.completed.request.change_lane == 0


# --- each kind of event -----------------------------------------------------------------------------------------------


def test_a_new_nominal_plan_is_an_event(alone):
    first = alone.step()
    assert kinds([first]) == [EventKind.NEW_PLAN]
    other = before("multi_lane_road", ROAD, 380.0, 15.0)
    ahead = passages_ahead(alone.graph, other.plan, alone.limits, first.snapshot.passages)
    found = detect(first.snapshot, other.plan, ahead, first.completed, first.drive.memory, no_command=False)
    assert found == (Event(EventKind.NEW_PLAN),)


def test_a_new_obstacle_ahead_is_an_event(alone):
    assert events_after(alone, alone.step(), [alone.ahead("new", 50.0, 15.0)]) == (Event(EventKind.NEW_OBSTACLE, "new"),)


def test_who_drives_beside_is_no_event(alone):
    beside = alone.other("beside", "road_before_exit_1", 60.0, 15.0, ROAD)
    assert events_after(alone, alone.step(), [beside]) == ()


@pytest.mark.parametrize(("speed", "is_one"), [(8.0, False), (8.9, False), (9.1, True), (6.9, True)])
def test_another_who_changes_his_speed_by_more_than_one_metre_a_second_is_an_event(alone, speed, is_one):
    first = alone.step(alone.ahead("x", 55.0, 8.0))
    found = events_after(alone, first, [alone.ahead("x", 55.0, speed)])
    assert found == ((Event(EventKind.OTHER_BEHAVIOUR, "x"),) if is_one else ())


def test_another_who_moves_off_is_an_event_however_slowly(alone):
    first = alone.step(alone.ahead("x", 55.0, 0.0))
    assert Event(EventKind.OTHER_BEHAVIOUR, "x") in events_after(alone, first, [alone.ahead("x", 55.0, 0.3)])


def test_the_vanishing_of_the_cause_of_a_stop_is_an_event():
    ego = before("four_way_priority", SOUTH_NORTH, 1.0, 0.0)
    foe = ego.other("foe", "from_west_0", -26.0, 13.0, WEST_EAST)
    first = ego.step(foe)
    assert first.completed.stop.cause == "foe"
    assert Event(EventKind.CAUSE_VANISHED, "foe") in events_after(ego, first)
    assert Event(EventKind.CAUSE_VANISHED, "foe") not in events_after(ego, first, [foe])


def test_a_change_of_a_light_is_an_event():
    ego = before("signalised_left_turns", SOUTH_NORTH, 40.0, 10.0)
    first = ego.step(lights={"centre": "G" * 12})
    assert events_after(ego, first, lights={"centre": "G" * 12}) == ()
    assert events_after(ego, first, lights={"centre": "y" * 12}) == (Event(EventKind.LIGHT_CHANGE, "centre"),)


def test_an_intersection_is_an_event_when_it_comes_in_sight_and_near_at_its_line_and_at_its_end():
    ego = before("four_way_priority", SOUTH_NORTH, 140.0, 13.0)
    steps = [step for step in ego.driven(25.0) if step.completed.events]
    assert set(kinds(steps[1:])) == {EventKind.INTERSECTION}
    in_sight, near, entering, inside, left = (step.snapshot.front for step in steps[1:])
    line, reach = ego.line, 10.0 + 4.0 * 13.9 + 13.9**2 / (2.0 * USUAL.comfort_deceleration)
    assert in_sight < line - reach - 2.0
    assert -2.0 <= near - (line - reach) <= 2.0
    assert line - 6.0 <= entering <= line - 4.0
    assert line < inside <= line + 2.0
    assert left > ego.plan.passages[0].end


def test_a_region_is_an_event_when_the_ego_reaches_it_and_somebody_else_could():
    ego = before("four_way_priority", WEST_EAST, 20.0, 13.0)
    waiting = ego.other("waiting", "from_south_0", -1.0, 0.0, SOUTH_NORTH)
    alone, watched = ego.driven(4.0), list(ego.driven_among(lambda t: [ego.later(waiting, t)], 4.0))
    passage = ego.plan.passages[0]

    def inside(steps):
        events = [step for step in steps if EventKind.INTERSECTION in kinds([step])]
        return sum(passage.start + 2.0 < step.snapshot.front < passage.end for step in events)

    assert (inside(alone), inside(watched)) == (0, 1)


@pytest.mark.parametrize(
    ("slower", "is_one"), [(USUAL.off_nominal_speed - 0.5, False), (USUAL.off_nominal_speed + 0.5, True)]
)
def test_a_speed_far_from_nominal_is_an_event_once(alone, slower, is_one):
    first = alone.step()
    ego = alone.at_speed(alone.plan.on_schedule(first.snapshot.s, 0.0)[1] - slower)
    assert events_after(ego, first) == ((Event(EventKind.OFF_NOMINAL),) if is_one else ())
    assert events_after(ego, first, premises=first.drive.memory.premises._replace(is_off_nominal=True)) == ()


def test_a_missed_time_constraint_is_an_event(alone):
    first = alone.step()
    due = first.completed.constraints[0].time
    allowed = {"progress_time": due, "delay": 1000.0}
    assert events_after(alone, first, time=due + USUAL.time_tolerance_s - 0.1, **allowed) == ()
    missed = events_after(alone, first, time=due + USUAL.time_tolerance_s + 0.1, **allowed)
    assert missed == (Event(EventKind.CONSTRAINT_MISSED),)


def test_a_delay_is_an_event_each_time_that_it_has_grown_by_the_step(alone):
    first = alone.step()
    assert events_after(alone, first, time=100.0 + USUAL.delay_step_s - 0.2) == ()
    assert events_after(alone, first, time=100.0 + USUAL.delay_step_s + 0.2) == (Event(EventKind.DELAY),)
    assert events_after(alone, first, time=100.0 + USUAL.delay_step_s + 0.2, delay=USUAL.delay_step_s) == ()


def test_the_executors_feedback_that_no_command_was_admissible_is_an_event(alone):
    first = alone.step()
    ahead = passages_ahead(alone.graph, alone.plan, alone.limits, first.snapshot.passages)
    found = detect(first.snapshot, alone.plan, ahead, first.completed, first.drive.memory, no_command=True)
    assert found == (Event(EventKind.NO_COMMAND),)


def test_the_controller_passes_an_emergency_of_the_executor_on_to_the_pilot(alone):
    wall = alone.ahead("wall", 5.0, 0.0)
    first = alone.step(wall)
    assert first.execution.emergency
    assert EventKind.NO_COMMAND in kinds([alone.step(wall, drive=first.drive, time=NEXT)])


@pytest.mark.parametrize(("before_it", "after"), [(0.0, 1.0), (1.0, 0.0)])
def test_coming_to_a_stand_and_moving_off_are_events(alone, before_it, after):
    first = alone.at_speed(before_it).step()
    found = events_after(alone.at_speed(after), first, premises=first.drive.memory.premises._replace(is_off_nominal=True))
    assert found == (Event(EventKind.STANDSTILL),)


def test_the_end_of_a_scheduled_stop_is_an_event():
    stops = (ScheduledStop("from_west_0", 100.0, 4.0, None),)
    ego = before("four_way_priority", WEST_EAST, 120.0, 10.0, stops=stops)
    steps = ego.driven(30.0)
    (reached,) = [step for step in steps if EventKind.TIME_REACHED in kinds([step])]
    began = next(step.drive.memory.serving_until for step in steps if step.drive.memory.serving_until is not None)
    assert began <= reached.snapshot.time < began + 2 * PERIOD


def among(position: float, speed: float, then: float = math.nan) -> list[Step]:
    """Three seconds of a drive towards a crossing to which a foe comes, `position` m before its line, who has another
    speed `then` after half a second."""
    ego = before("four_way_priority", SOUTH_NORTH, 60.0, 10.0)
    foe = ego.other("foe", "from_west_0", -position, speed, WEST_EAST)

    def foes(past: float):
        now = ego.later(foe, past)
        return [now if past < 0.5 or math.isnan(then) else now._replace(speed=then)]

    return ego.driven_among(foes, 3.0)


def test_a_foe_who_goes_on_as_foreseen_is_no_event_until_he_has_cleared_the_region():
    """13 m/s: the ego, which would be there 0.9 s behind him, means to come after him."""
    assert kinds(among(30.0, 13.0)[:25]) == [EventKind.NEW_PLAN]
    assert all(step.snapshot.foes for step in among(30.0, 13.0))


def test_a_gap_that_the_ego_waits_for_activates_the_pilot_when_it_opens():
    steps = among(40.0, 12.0)
    (opened,) = [k for k, step in enumerate(steps) if Event(EventKind.GAP_OPENED, "foe") in step.completed.events]
    assert (steps[opened - 1].completed.stop.cause, steps[opened].completed.stop) == ("foe", None)
    assert kinds(steps[:opened]) == [EventKind.NEW_PLAN]


@pytest.mark.parametrize(
    ("then", "kind"), [(12.5, None), (11.0, EventKind.OTHER_BEHAVIOUR), (20.0, EventKind.GAP_CLOSED)]
)
def test_a_foe_who_does_something_else_activates_the_pilot_if_that_changes_when_or_whether_the_ego_may_go(then, kind):
    steps = among(100.0, 13.0, then)
    assert kinds(steps[:6]) == [EventKind.NEW_PLAN, *([] if kind is None else [kind])]


def test_want_of_progress_is_an_event(alone):
    first = alone.at_speed(0.0).step()
    still = {"progress_s": first.snapshot.s, "progress_time": 100.0, "delay": 1000.0}
    assert events_after(alone.at_speed(0.0), first, time=100.0 + USUAL.no_progress_s, **still) == ()
    found = events_after(alone.at_speed(0.0), first, time=100.1 + USUAL.no_progress_s, **still)
    assert found == (Event(EventKind.NO_PROGRESS), Event(EventKind.LOCKED))


def test_a_lane_change_that_comes_into_reach_makes_the_pilot_look_at_the_other_lane():
    """Somebody keeps abreast of the ego on the lane that its route needs: it must not follow C into him."""
    ego = before("multi_lane_road", TO_EXIT, 380.0, 15.0, lane=1)
    places = [(step.snapshot.front - ego.seen().front, step.snapshot.ego.speed) for step in ego.driven(20.0)]
    first = ego.graph.lanes["road_before_exit_0"].spine.length - 380.0

    def abreast(past: float):
        way, speed = places[round(past / PERIOD)]
        return [ego.other("abreast", "road_before_exit_0", first + way, speed, ROAD)]

    steps = ego.driven_among(abreast, 20.0)
    change = ego.plan.lane_changes[0]
    reasons = {step.completed.stop.reason for step in steps if step.completed.stop and step.snapshot.front < change.start}
    assert reasons == {Reason.NO_GAP}
    assert max(step.snapshot.front for step in steps) < change.start


# --- waiting is calm --------------------------------------------------------------------------------------------------


def test_a_long_wait_at_a_red_light_does_not_make_the_pilot_run_at_every_step():
    """Who waits at red has no want of progress: the light has the right to stop him."""
    ego = before("signalised_left_turns", SOUTH_NORTH, 30.0, 8.0)
    steps = ego.driven(60.0, lights={"centre": "r" * 12})
    assert sum(bool(step.completed.events) for step in steps[300:]) < 60


def test_a_long_wait_in_a_queue_does_not_make_the_pilot_run_at_every_step():
    ego = before("multi_lane_road", ROAD, 300.0, 10.0)
    steps = ego.driven(60.0, ego.ahead("queue", 30.0, 0.0))
    assert sum(bool(step.completed.events) for step in steps[300:]) < 60


def test_a_coarse_step_reports_the_events_of_all_its_parts(alone):
    step = Controller(graph=alone.graph, limits=CAR).step(alone.traffic(), alone.drive(), 0.5)
    assert Event(EventKind.NEW_PLAN) in step.completed.events
