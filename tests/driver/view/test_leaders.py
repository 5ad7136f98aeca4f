"""Whom the ego must stay behind: who drives ahead, stands, comes towards it or crosses."""

import pytest
from helpers.cars import BODY, CAR, car_at

from sumo_reactive.driver.nouns.constraint import TimeConstraint, stay_behind
from sumo_reactive.driver.nouns.snapshot import PathObstacle
from sumo_reactive.driver.view.leaders import leaders

FRONT, SPEED = 10.0, 10.0


def behind(start: float, along: float, across: float = 0.0, speed: float = SPEED) -> list[TimeConstraint]:
    body = PathObstacle(car_at("x", 0.0, 0.0, 0.0, 5.0), start, start + 5.0, along, across)
    return list(leaders([body], FRONT, speed, CAR))


def test_who_drives_ahead_leads_at_his_speed_and_brakes_as_his_body_can():
    assert behind(50.0, 8.0) == [stay_behind("x", 50.0, 8.0, BODY.emergency_deceleration)]


def test_who_stands_in_the_way_is_a_leader_at_rest():
    (leader,) = behind(50.0, 0.0)
    assert (leader.s, leader.speed) == (50.0, 0.0)


@pytest.mark.parametrize(("comes_at", "meets"), [(10.0, 30.0), (30.0, 20.0)])
def test_who_comes_towards_the_ego_stands_where_they_would_meet(comes_at, meets):
    (leader,) = behind(50.0, -comes_at)
    assert (leader.s, leader.speed) == (pytest.approx(meets), 0.0)


def test_who_will_have_crossed_before_the_ego_comes_is_no_leader():
    """He needs (4.7 + 1.8) m / 5 m/s = 1.3 s to leave the corridor; the margin is 0.5 s."""
    assert behind(FRONT + SPEED * 1.9, 0.0, across=5.0) == []


def test_who_will_not_have_crossed_in_time_stands_in_the_way():
    (leader,) = behind(FRONT + SPEED * 1.7, 0.0, across=-5.0)
    assert (leader.s, leader.speed) == (FRONT + SPEED * 1.7, 0.0)


def test_who_drives_ahead_and_changes_lanes_still_leads():
    (leader,) = behind(50.0, 8.0, across=1.0)
    assert leader.speed == 8.0


def test_each_body_in_the_corridor_has_its_own_leader():
    bodies = [PathObstacle(car_at(name, 0.0, 0.0, 0.0, 5.0), s, s + 5.0, 5.0, 0.0) for name, s in (("a", 30.0), ("b", 60.0))]
    assert [leader.behind for leader in leaders(bodies, FRONT, SPEED, CAR)] == ["a", "b"]
