"""U₂ from the foreseen motion: the three zero cases of the paper, and how near the ego passes (F&L 1991, §3.3.2)."""

import math
from dataclasses import replace

import numpy as np
import pytest
import shapely
from helpers.cars import CAR, car_at
from helpers.curves import asked, driven, on_curve, plan_along, seen, straight, turning
from hypothesis import given
from hypothesis import strategies as st

from sumo_reactive.driver.field.executor import execute
from sumo_reactive.driver.field.foreseen_shadow import BESIDE_M, foreseen_potential, foreseen_shadows
from sumo_reactive.driver.geometry.curve import Curve
from sumo_reactive.driver.geometry.footprint import Footprint
from sumo_reactive.driver.nouns.traffic import RoadUser
from sumo_reactive.driver.parameters import USUAL

ROAD, AT = straight(), 200.0
HALF, AHEAD, BEHIND = 0.5 * CAR.width, CAR.front_overhang, CAR.length - CAR.front_overhang
FRONT, REAR = AT + AHEAD, AT - BEHIND
LENGTH, WIDTH = 4.0, 2.0
ROOM = (0.4, 0.4)
speeds = st.floats(0.5, 30.0)
gaps = st.floats(0.1, 30.0)


def body(s: float, left: float, speed: float, turned: float = 0.0, curve: Curve = ROAD) -> tuple[float, ...]:
    """A car whose middle is at `s` of a curve, `left` m beside it, headed `turned` (rad) against it."""
    x, y, heading = curve.at(s)
    x, y, h = x - left * math.sin(heading), y + left * math.cos(heading), heading + turned
    return x + 0.5 * LENGTH * math.cos(h), y + 0.5 * LENGTH * math.sin(h), h, speed, LENGTH, WIDTH, 0.0, math.inf


def potential(speed: float, *boxes: tuple[float, ...], d: float = 0.0, curve: Curve = ROAD, room=None) -> float:
    """U₂ of an ego with its front axle at AT, which may lean as far as it likes."""
    room = np.full(2, np.inf) if room is None else room
    along = curve.x, curve.y, curve.heading, curve.step, AT
    scale, clearance = USUAL.shadow_scale, USUAL.clearance_m
    shadows = foreseen_shadows(np.array(boxes), speed, HALF, AHEAD, BEHIND, *along, room, scale, clearance)
    return foreseen_potential(shadows, d, room, clearance)


@given(speeds, st.floats(0.0, 1.0), gaps, st.floats(-2.5, 2.5))
def test_it_is_zero_for_a_follower_that_is_no_faster(speed, share, gap, left):
    assert potential(speed, body(REAR - 0.5 * LENGTH - gap, left, share * speed)) == 0.0


@given(speeds, st.floats(0.0, 1.0), gaps, st.floats(-2.5, 2.5))
def test_it_is_zero_for_one_ahead_that_is_no_slower(speed, share, gap, left):
    assert potential(share * speed, body(FRONT + 0.5 * LENGTH + gap, left, speed)) == 0.0


@given(
    speeds, speeds, st.floats(-40.0, 40.0), st.floats(0.0, 5.0), st.sampled_from([-1, 1]), st.sampled_from([0.0, math.pi])
)
def test_it_is_zero_on_parallel_lanes_that_are_far_enough(speed, other_speed, along, gap, side, heading):
    left = side * (HALF + 0.5 * WIDTH + USUAL.clearance_m + gap + 1e-6)
    assert potential(speed, body(AT + along, left, other_speed, heading)) == 0.0


@pytest.mark.parametrize("heading", [0.0, math.pi], ids=["the same way", "oncoming"])
@pytest.mark.parametrize("bend", [1.0 / 15.0, -1.0 / 15.0, 1.0 / 60.0])
def test_who_keeps_to_the_lane_beside_casts_nothing_in_a_bend(bend, heading):
    """His tangent leads across C: the straight relative velocity would see him collide."""
    curve = turning([400.0], [bend])
    for side in (-3.4, 3.4):
        for along in (2.0, 6.0, 12.0, 25.0):
            assert potential(9.0, body(AT + along, side, 6.0, heading, curve), curve=curve) == 0.0


def test_it_grows_with_the_speed_of_approach_and_towards_the_body_and_falls_with_the_clearance():
    left = HALF + 0.5 * WIDTH + 0.5
    slow, fast = (potential(10.0, body(AT + 20.0, left, speed)) for speed in (5.0, 0.0))
    near, wide = potential(10.0, body(AT + 12.0, left, 5.0)), potential(10.0, body(AT + 20.0, left + 0.3, 5.0))
    assert 0.0 < wide < slow < min(fast, near)


def test_leaning_away_lowers_it_and_leaning_towards_raises_it_but_not_beyond_the_room():
    beside, room = body(AT + 8.0, HALF + 0.5 * WIDTH + 0.5, 0.0), np.array([0.4, 0.3])
    towards, on, away, farther = (potential(10.0, beside, d=d, room=room.copy()) for d in (0.3, 0.0, -0.3, -0.6))
    assert towards > on > away == farther


def test_who_is_in_the_way_casts_the_same_wherever_in_its_lane_the_ego_drives():
    ahead = body(AT + 20.0, 0.5, 0.0)
    assert potential(10.0, ahead, d=-0.4) == potential(10.0, ahead) == potential(10.0, ahead, d=0.4) > 0.0


def test_who_drives_across_or_away_from_the_way_casts_nothing():
    left = HALF + 0.5 * WIDTH + 0.8
    assert potential(10.0, body(AT + 20.0, 3.0, 5.0, -0.5 * math.pi)) == 0.0
    assert potential(10.0, body(AT + 20.0, left, 5.0)) > potential(10.0, body(AT + 20.0, left, 5.0, 0.2)) == 0.0


def test_somebody_on_the_other_side_leaves_less_room():
    room = np.array([0.4, 0.4])
    potential(10.0, body(AT, -HALF - 0.5 * WIDTH - BESIDE_M - 0.1, 10.0), room=room)
    assert room == pytest.approx((0.4, 0.1))


def passing(others: list[RoadUser], room: tuple[float, float] = ROOM, speed: float = 13.9):
    """What an ego on a straight road does beside others who keep their speed: how far it is off C, its nearest clearance,
    its greatest lateral acceleration."""
    plan = plan_along(straight())

    def at(time: float) -> list[RoadUser]:
        return [replace_x(user, user.x + user.speed * math.cos(user.heading) * time) for user in others]

    offsets, nearest, lateral = [], math.inf, 0.0
    steps = driven(plan, on_curve(plan.curve, 5.0, speed), lambda _: asked(plan), 12.0, users=at, room=room)
    for snapshot, execution in steps:
        p, state = snapshot.ego.pose, execution.state
        middle = CAR.front_to_rear_axle
        x, y = p.x + middle * math.cos(p.heading), p.y + middle * math.sin(p.heading)
        own = Footprint(x, y, p.heading, CAR.length, CAR.width)
        bodies = [Footprint(u.x, u.y, u.heading, u.body.length, u.body.width) for u in at(snapshot.time)]
        beside = [shapely.polygons(body.corners()) for body in bodies]
        nearest = min(nearest, *shapely.distance(shapely.polygons(own.corners()), beside))
        lateral = max(lateral, abs(state.speed**2 * math.sin(state.steering_angle) / CAR.wheelbase))
        offsets.append(snapshot.d)
    return offsets, nearest, lateral


def replace_x(user: RoadUser, x: float) -> RoadUser:
    return user._replace(x=x)


def bicycle(clearance: float, side: int = -1, x: float = 90.0, speed: float = 5.0) -> RoadUser:
    """A bicycle beside C, so far from the body of an ego on C."""
    user = car_at("bike", x, side * (HALF + 0.3 + clearance), 0.0, speed)
    return user._replace(body=replace_body(user))


def replace_body(user: RoadUser):
    return user.body._replace(length=1.6, width=0.6)


@pytest.mark.parametrize("side", [-1, 1])
def test_the_ego_leans_away_from_a_bicycle_gently_and_comes_back_to_c(side):
    offsets, nearest, lateral = passing([bicycle(0.6, side)])
    assert nearest > 0.6 + 0.2
    assert 0.2 < max(-side * d for d in offsets) <= 0.4 + 0.02
    assert abs(offsets[-1]) < 0.02
    assert lateral < 2.0


def test_the_ego_stays_on_c_where_it_has_no_room_and_beside_who_is_far_enough():
    assert max(map(abs, passing([bicycle(0.6)], room=(0.0, 0.0))[0])) < 0.01
    assert max(map(abs, passing([bicycle(USUAL.clearance_m)])[0])) < 0.01
    assert max(map(abs, passing([car_at("x", 150.0, 3.2, math.pi, 13.9)])[0])) < 0.01


def test_between_two_bicycles_the_ego_stays_in_the_middle():
    offsets, nearest, _ = passing([bicycle(0.6), bicycle(0.6, 1)])
    assert max(map(abs, offsets)) < 0.05
    assert nearest > 0.55


def test_without_weight_nobody_is_leaned_away_from():
    plan = plan_along(straight())
    completed = asked(plan)
    light = replace(completed, tuning=replace(completed.tuning, weights=replace(completed.tuning.weights, shadow=0.0)))
    snapshot = seen(on_curve(plan.curve, 80.0, 13.9), plan, 79.0, [bicycle(0.6)], room=ROOM)
    with_it, without = (execute(snapshot, one, CAR, 0.1) for one in (completed, light))
    assert with_it.command.steering_rate > 0.0 == without.potentials.shadow
    assert abs(without.command.steering_rate) < 1e-3
