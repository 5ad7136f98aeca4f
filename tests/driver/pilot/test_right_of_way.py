"""Who goes first, on the project's own junctions: every case a hand-placed picture (F&L 1991, §2, rules)."""

from dataclasses import replace

import pytest
from helpers.cars import CAR
from helpers.situations import PERIOD, before

from sumo_reactive.driver.nouns.completed_plan import Intent
from sumo_reactive.driver.nouns.decision import Behaviour, Reason
from sumo_reactive.driver.world.regions import ConflictKind

WEST_EAST, EAST_WEST = ("from_west", "to_east"), ("from_east", "to_west")
NORTH_SOUTH, SOUTH_NORTH, SOUTH_WEST = ("from_north", "to_south"), ("from_south", "to_north"), ("from_south", "to_west")


def on(ego, route, position, speed, waiting=0.0, lane=0):
    """A car named after the road that it comes from."""
    return ego.other(route[0], f"{route[0]}_{lane}", position, speed, route, waiting)


def having_stopped_for(seconds):
    """The ego at the line of the all-way stop, where its full stop was `seconds` ago."""
    return before("all_way_stop", WEST_EAST, 1.0, 0.0).having_stood(seconds)


# --- priority road --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("route", [WEST_EAST, EAST_WEST])
def test_the_minor_road_yields_to_a_near_car_on_the_major_road(route):
    ego = before("four_way_priority", SOUTH_WEST, 1.0, 0.0)
    completed = ego.step(on(ego, route, -26.0, 13.0)).completed
    assert (completed.stop.reason, completed.stop.cause, completed.stop.s) == (Reason.YIELD_TO, route[0], ego.line)
    assert completed.intent is Intent.YIELD


@pytest.mark.parametrize("route", [WEST_EAST, EAST_WEST])
def test_the_minor_road_yields_to_a_car_that_could_stop_but_need_not(route):
    """At 13 m/s a car is 3.5 s away; the ego needs longer to clear the road from a standing start."""
    ego = before("four_way_priority", SOUTH_WEST, 1.0, 0.0)
    assert ego.stop(on(ego, route, -45.0, 13.0)) is not None


def test_the_minor_road_goes_when_the_gap_is_large():
    ego = before("four_way_priority", SOUTH_WEST, 1.0, 0.0)
    assert ego.stop(on(ego, WEST_EAST, -140.0, 13.0), on(ego, EAST_WEST, -140.0, 13.0)) is None


def test_a_car_in_a_queue_does_not_come_before_the_head_of_the_queue_does():
    """The head has been standing for long, so that it counts no more; who rolls up behind it cannot pass it."""
    ego = before("four_way_priority", SOUTH_NORTH, 1.0, 0.0).having_stood(4.0)
    head, behind = on(ego, WEST_EAST, -1.0, 0.0, 20.0), on(ego, WEST_EAST, -9.0, 3.0)
    assert ego.stop(behind) is not None
    assert ego.stop(head, behind) is None


def test_the_longer_a_car_with_priority_has_stood_the_shorter_the_ego_waits_for_it():
    ego = before("four_way_priority", SOUTH_NORTH, 1.0, 0.0)
    assert ego.having_stood(1.5).stop(on(ego, WEST_EAST, -1.0, 0.0, 3.5)) is not None
    assert ego.having_stood(1.5).stop(on(ego, WEST_EAST, -1.0, 0.0, 5.0)) is None


def test_the_minor_road_goes_behind_a_car_that_has_passed():
    ego = before("four_way_priority", SOUTH_NORTH, 1.0, 0.0)
    assert ego.stop(ego.other("passed", "to_east_0", 8.0, 13.0, ("to_east",))) is None


def test_the_ego_on_the_major_road_does_not_wait_for_a_car_that_must_yield():
    ego = before("four_way_priority", WEST_EAST, 30.0, 13.0)
    assert ego.stop(on(ego, SOUTH_NORTH, -1.0, 0.0, 5.0), on(ego, NORTH_SOUTH, -15.0, 6.0)) is None


def test_the_ego_brakes_for_a_car_that_should_yield_but_can_no_longer_stop():
    ego = before("four_way_priority", WEST_EAST, 24.0, 13.0)
    stop = ego.stop(on(ego, SOUTH_NORTH, -13.0, 13.0))
    assert (stop.reason, stop.cause) == (Reason.FOE_CANNOT_STOP, "from_south")


# --- permissive left turn -------------------------------------------------------------------------------------------

GREEN = {"centre": "GGgrrrGGgrrr"}
ONLY_EGO_GREEN = {"centre": "rrrrrrGGgrrr"}


def test_a_left_turn_on_the_yielding_green_waits_for_oncoming_traffic():
    ego = before("signalised_left_turns", SOUTH_WEST, 8.0, 6.0, lane=1)
    stop = ego.stop(on(ego, NORTH_SOUTH, -25.0, 13.0), lights=GREEN)
    assert (stop.reason, stop.cause) == (Reason.YIELD_TO, "from_north")
    assert stop.s >= ego.line


def test_a_left_turn_does_not_wait_for_oncoming_traffic_that_has_red():
    ego = before("signalised_left_turns", SOUTH_WEST, 8.0, 6.0, lane=1)
    assert ego.stop(on(ego, NORTH_SOUTH, -45.0, 10.0), on(ego, NORTH_SOUTH, -1.0, 0.0, 9.0), lights=ONLY_EGO_GREEN) is None


def test_a_left_turn_waits_for_an_oncoming_car_that_runs_the_fresh_red():
    ego = before("signalised_left_turns", SOUTH_WEST, 8.0, 6.0, lane=1)
    assert ego.stop(on(ego, NORTH_SOUTH, -22.0, 13.0), lights=ONLY_EGO_GREEN) is not None


@pytest.mark.parametrize(
    ("away", "speed", "red_for", "waits"),
    [
        (22.0, 13.0, 0.0, True),
        (22.0, 13.0, 0.4, True),  # the red came on when he had 27.2 m: not enough at 3 m/s²
        (22.0, 13.0, 0.6, False),  # 29.8 m: he has seen it in time, and will brake as hard as he now has to
        (60.0, 28.0, 30.0, False),
    ],
)
def test_a_left_turn_goes_before_an_oncoming_car_whose_red_came_on_in_time_for_it_to_stop(away, speed, red_for, waits):
    ego = before("signalised_left_turns", SOUTH_WEST, 8.0, 6.0, lane=1)
    ego = replace(ego, memory=ego.memory.with_lights(GREEN, 0.0).with_lights(ONLY_EGO_GREEN, ego.time - red_for))
    stop = ego.stop(on(ego, NORTH_SOUTH, -away, speed), lights=ONLY_EGO_GREEN)
    assert (stop is not None) is waits


def test_a_link_of_a_light_is_shut_from_its_yellow_until_it_is_green_again():
    ego = before("signalised_left_turns", SOUTH_WEST, 8.0, 6.0, lane=1)
    link, memory, times = ego.connection.light.index, ego.memory, []
    for time, letter in enumerate("gyrruGgr"):
        memory = memory.with_lights({"centre": "r" * link + letter + "r" * (11 - link)}, float(time))
        times.append(memory.shut_for(ego.connection, float(time)))
    assert times == [0.0, 0.0, 1.0, 2.0, 3.0, 0.0, 0.0, 0.0]


def test_a_left_turn_goes_when_oncoming_traffic_is_far():
    ego = before("signalised_left_turns", SOUTH_WEST, 2.0, 4.0, lane=1)
    assert ego.stop(on(ego, NORTH_SOUTH, -150.0, 13.0), lights=GREEN) is None


def test_oncoming_left_turners_pass_each_other():
    ego = before("signalised_left_turns", SOUTH_WEST, 8.0, 6.0, lane=1)
    other = ego.other("turner", "from_north_1", -8.0, 6.0, ("from_north", "to_east"))
    assert ego.stop(other, lights=GREEN) is None


@pytest.mark.parametrize(("speed", "waits"), [(11.0, False), (14.0, True)])
def test_the_ego_trusts_an_oncoming_left_turner_that_can_stop_at_its_place_inside(speed, waits):
    ego = before("signalised_left_turns", SOUTH_NORTH, 8.0, 8.0)
    turner = ego.other("turner", "from_north_1", -14.0, speed, ("from_north", "to_east"))
    assert (ego.stop(turner, lights=GREEN) is not None) == waits


# --- right before left ----------------------------------------------------------------------------------------------


def test_without_signs_the_car_from_the_right_goes_first():
    ego = before("right_before_left", SOUTH_NORTH, 12.0, 6.0)
    stop = ego.stop(on(ego, EAST_WEST, -12.0, 7.0))
    assert (stop.reason, stop.cause) == (Reason.YIELD_TO, "from_east")


def test_without_signs_the_car_from_the_left_waits():
    ego = before("right_before_left", SOUTH_NORTH, 12.0, 6.0)
    assert ego.stop(on(ego, WEST_EAST, -15.0, 6.0)) is None


# --- all-way stop ---------------------------------------------------------------------------------------------------


def test_at_an_all_way_stop_the_ego_stops_fully_although_nobody_is_there():
    ego = before("all_way_stop", WEST_EAST, 30.0, 9.0)
    assert ego.stop().reason is Reason.STOP_SIGN
    trace = [(step.snapshot.front, step.snapshot.ego.speed) for step in ego.driven(14.0)]
    assert min(speed for front, speed in trace if front < ego.line) < 0.1
    assert trace[-1][0] > ego.line + 5.0


@pytest.mark.parametrize("route", [NORTH_SOUTH, SOUTH_NORTH])
def test_at_an_all_way_stop_who_stopped_before_goes_first(route):
    ego = having_stopped_for(1.0)
    completed = ego.step(on(ego, route, -1.0, 0.0, waiting=2.5)).completed
    assert (completed.stop.reason, completed.stop.cause) == (Reason.WAIT_FOR_TURN, route[0])
    assert completed.intent is Intent.YIELD  # or the two would wait for each other


def test_at_an_all_way_stop_the_ego_means_to_go_next_once_the_one_before_has_started():
    completed = having_stopped_for(1.0).step(on(having_stopped_for(1.0), NORTH_SOUTH, -0.9, 0.4)).completed
    assert completed.stop.reason is Reason.WAIT_FOR_TURN
    assert completed.intent is Intent.GO_NEXT


def test_at_an_all_way_stop_the_ego_means_to_go_next_before_it_goes_because_the_other_does_not_start():
    ego = having_stopped_for(2.5)
    completed = ego.step(on(ego, NORTH_SOUTH, -1.0, 0.0, waiting=5.5)).completed
    assert completed.stop.reason is Reason.WAIT_FOR_TURN
    assert completed.intent is Intent.GO_NEXT


@pytest.mark.parametrize("route", [NORTH_SOUTH, SOUTH_NORTH])
def test_at_an_all_way_stop_the_ego_goes_before_who_stopped_later(route):
    ego = having_stopped_for(2.5)
    assert ego.stop(on(ego, route, -1.0, 0.0, waiting=1.0)) is None


def test_at_an_all_way_stop_the_ego_goes_before_who_still_approaches():
    ego = having_stopped_for(1.0)
    assert ego.stop(on(ego, NORTH_SOUTH, -20.0, 8.0)) is None


def test_at_an_all_way_stop_the_ego_goes_before_who_brakes_for_its_line():
    """Cars brake for it with just what is theirs, 4.5 m/s²."""
    ego = having_stopped_for(1.0)
    for away in (4.0, 8.0, 16.0):
        assert ego.stop(on(ego, NORTH_SOUTH, -away, (2.0 * 4.5 * away) ** 0.5)) is None


def test_at_an_all_way_stop_the_ego_does_not_go_before_who_can_no_longer_stop():
    ego = having_stopped_for(1.0)
    assert ego.stop(on(ego, NORTH_SOUTH, -8.0, 10.5)) is not None


# --- regions --------------------------------------------------------------------------------------------------------


def inside(ego, connection, at, speed, to):
    return ego.other("inside", ego.graph.connections[connection].parts[0], at, speed, (to,))


THROUGH = "from_south_0->to_north_0"


def test_the_ego_starts_behind_a_car_that_has_nowhere_left_to_wait():
    """It could still stop before the region, but only in others' way."""
    ego = having_stopped_for(1.0)
    assert ego.stop(inside(ego, THROUGH, 1.0, 6.0, "to_north")) is None


def test_the_ego_starts_sooner_behind_a_car_that_gains_speed():
    def waits_behind(gain):
        ego = having_stopped_for(1.0)
        way = lambda t: 1.0 + 3.0 * t + 0.5 * gain * t * t  # noqa: E731
        steps = ego.driven_among(lambda t: [inside(ego, THROUGH, way(t), 3.0 + gain * t, "to_north")], 1.6)
        return sum(step.completed.stop is not None for step in steps) * PERIOD

    assert waits_behind(2.0) < waits_behind(0.0) - 0.5


@pytest.mark.parametrize("route", [WEST_EAST, SOUTH_NORTH], ids=["with priority", "without"])
def test_a_region_that_somebody_stands_in_is_not_entered(route):
    crossing = SOUTH_NORTH if route == WEST_EAST else WEST_EAST
    ego = before("four_way_priority", route, 12.0, 5.0)
    stop = ego.stop(inside(ego, f"{crossing[0]}_0->{crossing[1]}_0", 9.0, 0.0, crossing[1]))
    assert (stop.reason, stop.cause) == (Reason.REGION_OCCUPIED, "inside")
    assert stop.s <= ego.line + 1e-9


@pytest.mark.parametrize("route", [SOUTH_NORTH, WEST_EAST], ids=["minor road", "major road"])
def test_the_ego_waits_at_the_line_while_there_is_no_room_behind_the_junction(route):
    ego = before("four_way_priority", route, 15.0, 6.0)
    completed = ego.step(ego.other("queue", f"{route[1]}_0", 3.5, 0.0, (route[1],), 20.0)).completed
    assert (completed.stop.cause, completed.stop.s) == ("queue", ego.line)
    assert any((d.reason, d.cause) == (Reason.EXIT_BLOCKED, "queue") for d in completed.decisions)


@pytest.mark.parametrize("route", [SOUTH_NORTH, WEST_EAST, SOUTH_WEST], ids=["minor", "major", "left turn"])
@pytest.mark.parametrize("position", [3.5, 5.5, 6.0, 7.5, 9.0, 12.0], ids="{} m".format)
def test_the_ego_never_comes_to_a_stop_in_a_region_that_others_cross(route, position):
    """It ends up either before the line or with its rear out of the last region, wherever the queue behind ends."""
    ego = before("four_way_priority", route, 25.0, 8.0)
    end = ego.driven(14.0, ego.other("queue", f"{route[1]}_0", position, 0.0, (route[1],), 20.0))[-1]
    crossed = [r.own.end for r in ego.graph.regions_on(ego.connection) if r.kind is ConflictKind.CROSSING]
    passage = ego.plan.passages[0]
    scale = (passage.end - passage.start) / ego.connection.path.length
    assert end.drive.ego.speed < 0.05
    assert end.snapshot.front < ego.line or end.snapshot.front - CAR.length > ego.line + max(crossed) * scale


def test_the_ego_enters_when_the_queue_leaves_room_for_it():
    ego = before("four_way_priority", SOUTH_NORTH, 15.0, 6.0)
    assert ego.stop(ego.other("queue", "to_north_0", 20.0, 0.0, ("to_north",), 20.0)) is None


def test_the_ego_follows_a_car_that_drives_on_behind_the_junction():
    ego = before("four_way_priority", SOUTH_NORTH, 15.0, 6.0)
    assert ego.stop(ego.other("ahead", "to_north_0", 8.0, 10.0, ("to_north",))) is None


def test_a_blocked_exit_is_waited_for_until_it_is_free():
    ego = before("four_way_priority", SOUTH_NORTH, 25.0, 8.0)
    queue = ego.other("queue", "to_north_0", 3.5, 0.0, ("to_north",), 20.0)
    steps = ego.driven(10.0, queue)
    assert steps[-1].drive.ego.speed < 0.05
    assert max(step.snapshot.front for step in steps) < ego.line
    assert ego.step(drive=steps[-1].drive, time=110.0).drive.ego.speed > 0.0


# --- what the pilot says it does ------------------------------------------------------------------------------------


@pytest.mark.parametrize(("away", "behaviour"), [(140.0, Behaviour.NORMAL), (20.0, Behaviour.CAUTIOUS)], ids=["far", "near"])
def test_the_approach_is_driven_cautiously(away, behaviour):
    assert before("four_way_priority", SOUTH_NORTH, away, 8.0).step().completed.behaviour is behaviour


def test_inside_the_junction_the_ego_crosses():
    ego = before("four_way_priority", SOUTH_NORTH, 10.0, 8.0)
    step = next(step for step in ego.driven(6.0) if step.snapshot.front > ego.line + 2.0)
    assert step.completed.behaviour is Behaviour.CROSSING


def test_every_stop_carries_its_decision_with_the_times_that_it_rests_on():
    ego = before("four_way_priority", SOUTH_WEST, 1.0, 0.0)
    completed = ego.step(on(ego, WEST_EAST, -15.0, 13.0)).completed
    decision = next(d for d in completed.decisions if d.reason is Reason.YIELD_TO)
    figures = dict(decision.figures)
    assert decision.cause == "from_west"
    assert decision.region == completed.stop.region
    assert figures["foe_arrival_s"] < figures["clearance_s"] + 1.0
