"""Who comes over the ground that a turn in several moves needs, and who stays where it ends."""

from dataclasses import replace

import numpy as np
import pytest
from helpers.cars import CAR
from helpers.situations import before

from sumo_reactive.driver.nouns.plan import Move, Turnaround
from sumo_reactive.driver.nouns.traffic import FOLLOWER_STANDSTILL_GAP_M, QUEUED_SPEED
from sumo_reactive.driver.vehicle.safe_speed import SAFE_GAP_M
from sumo_reactive.driver.view.outlook import ground_of, swept_ground

STREET = ("eastbound", "eastbound_out")
LOCK = 0.6


@pytest.fixture
def ego():
    """The ego, which stands where it is to turn round to the left in three moves."""
    standing = before("blocked_lane", STREET, 300.0, 0.0)
    heading, bend = standing.ego.pose.heading, np.sin(LOCK) / CAR.wheelbase
    arcs = ((1, LOCK, 0.9), (-1, -LOCK, 1.6), (1, LOCK, 3.1))
    moves = tuple(
        Move(gear=gear, steering_angle=angle, bend=bend * gear, until=heading + until) for gear, angle, until in arcs
    )
    front = standing.seen().front
    turn = Turnaround(
        start=front + 0.5, line=front + 1.0, end=front + 6.0, from_lane="eastbound_0", from_index=0, to_lane="westbound_0",
        route_index=1, moves=moves, duration=15.0, into=5.0,
    )  # fmt: skip
    return replace(standing, plan=replace(standing.plan, turnarounds=(turn,)))


def comes_over(ego, user):
    return ground_of((user,), ego.seen(user), ego.plan, ego.graph, CAR).comes_over


def oncoming(ego, gap, speed):
    """Somebody on the other lane, `gap` m along it from beside the ego."""
    lane = ego.graph.lanes["westbound_0"]
    at = lane.spine.project(ego.ego.pose.x, ego.ego.pose.y)[0] + gap
    (x, y), heading = lane.spine.at(at), lane.spine.heading_at(at)
    return ego.ahead("x", 20.0, speed)._replace(x=x, y=y, heading=heading, lane_id=lane.id, lane_position=at, route=())


def test_the_ground_holds_every_pose_of_the_moves(ego):
    ground = swept_ground(ego.plan.turnarounds[0], ego.ego, CAR)
    pose = ego.ego.pose
    left = -np.sin(pose.heading) * (ground[:, 0] - pose.x) + np.cos(pose.heading) * (ground[:, 1] - pose.y)
    assert left.min() > -2.0
    assert 4.0 < left.max() < 12.0  # it has come to head back, two radii to the left
    assert len(ground) > 100


@pytest.mark.parametrize(("gap", "speed", "comes"), [(-40.0, 8.0, True), (-40.0, 1.0, False), (-40.0, 0.0, False)])
def test_who_drives_over_the_ground_in_time_is_told(ego, gap, speed, comes):
    assert comes_over(ego, oncoming(ego, gap, speed)) == ("x" if comes else "")


def test_who_is_on_the_lane_from_which_the_ego_turns_waits_himself(ego):
    user = ego.ahead("x", -15.0, 8.0)._replace(lane_id="eastbound_0")
    assert comes_over(ego, user) == ""


def test_who_will_come_from_behind_waits_himself(ego):
    user = oncoming(ego, -40.0, 8.0)
    assert comes_over(ego, user) == "x"
    assert comes_over(ego, user._replace(route=("westbound", "eastbound"))) == ""


def test_an_ego_that_still_drives_does_not_ask(ego):
    moving = ego.at_speed(5.0)
    assert comes_over(replace(moving, plan=ego.plan), ego.ahead("x", 20.0, 8.0)) == ""


def there(ego, name, rear, speed):
    """Somebody on the lane turned into with his rear `rear` m from its start."""
    user = oncoming(ego, 0.0, speed)
    return user._replace(id=name, lane_position=rear + user.body.length)


NEEDED = 5.0 + SAFE_GAP_M


@pytest.mark.parametrize(
    ("rear", "speed", "stays"),
    [
        (NEEDED + 0.1, 0.0, False),
        (NEEDED - 0.1, 0.0, True),
        (NEEDED - 1.0, QUEUED_SPEED - 0.1, False),
        (NEEDED - 1.0, 0.5, True),  # he may stop at once
        (0.0, QUEUED_SPEED + 0.1, False),
        (0.0, QUEUED_SPEED - 0.1, True),
    ],
)
def test_who_leaves_no_room_where_the_turn_ends_is_told(ego, rear, speed, stays):
    user = there(ego, "x", rear, speed)
    assert ground_of((user,), ego.seen(user), ego.plan, ego.graph, CAR).stays == ("x" if stays else "")


@pytest.mark.parametrize(("room", "stays"), [(0.1, False), (-0.1, True)])
def test_who_drives_up_to_somebody_who_stands_may_leave_no_room_behind_himself(ego, room, stays):
    driver = there(ego, "driver", 1.0, 8.0)
    stander = there(ego, "stander", NEEDED + driver.body.length + FOLLOWER_STANDSTILL_GAP_M + room, 0.0)
    users = driver, stander
    assert ground_of(users, ego.seen(*users), ego.plan, ego.graph, CAR).stays == ("driver" if stays else "")
