"""How long a queue is expected to take, and which one it pays to leave."""

from __future__ import annotations

import pytest

from sumo_reactive.driver.nouns.forecast import Queue, Queued
from sumo_reactive.driver.nouns.traffic import Body, RoadUser
from sumo_reactive.driver.parameters import QUEUE_HEADWAY_S, TURNER_WAIT_S, TURNERS_FEARED
from sumo_reactive.driver.pilot.held_up import expected_wait

BODY = Body(4.7, 1.8, 9.0, 50.0)


def queued(ahead: float, speed: float = 0.0, waiting: float = 60.0, yields: bool = False) -> Queued:
    name = f"x{ahead:g}"
    user = RoadUser(name, 0.0, 0.0, 0.0, speed, "a_0", 0.0, BODY, waiting_time=waiting if speed == 0.0 else 0.0)
    return Queued(user, ahead, yields)


def queue(*users: Queued) -> Queue:
    return Queue("a_0", tuple(sorted(users, key=lambda one: -one.ahead)))


def test_at_a_red_light_only_who_is_ahead_counts_and_not_how_long_he_stands():
    assert expected_wait(queue(queued(8), queued(15)), 0.0) == 2 * QUEUE_HEADWAY_S
    assert expected_wait(queue(), 0.0) == 0.0


def test_cars_that_drive_are_in_no_queue():
    assert expected_wait(queue(queued(8, 9.0), queued(30, 9.0)), 30.0) == 0.0


def test_a_head_that_stands_though_it_may_go_will_stand_for_as_long_again():
    assert expected_wait(queue(queued(30)), 12.0) == QUEUE_HEADWAY_S + 12.0
    assert expected_wait(queue(queued(30, waiting=7.0)), 12.0) == QUEUE_HEADWAY_S + 7.0


def test_a_queue_that_drives_off_from_its_head_is_not_held_up():
    discharging = queue(queued(40, 4.0), queued(31), queued(23))
    assert expected_wait(discharging, 12.0) == 2 * QUEUE_HEADWAY_S


def test_somebody_who_has_just_stopped_is_not_held_up():
    assert expected_wait(queue(queued(30, waiting=1.0)), 12.0) == QUEUE_HEADWAY_S


@pytest.mark.parametrize("turners", [1, 2, 5])
def test_turners_who_have_to_let_others_go_first_add_to_the_wait(turners):
    users = [queued(10.0 + 8.0 * k, yields=True) for k in range(turners)]
    expected = turners * QUEUE_HEADWAY_S + min(turners, TURNERS_FEARED) * TURNER_WAIT_S
    assert expected_wait(queue(*users), 0.0) == expected
