"""The shadows that are recorded: of whom U₂ counts, where his foreseen motion covers the ego's way (F&L 1991, §3.3.2)."""

import math

import pytest
from helpers.cars import CAR
from helpers.curves import asked, on_curve, plan_along, seen, straight

from sumo_reactive.driver.field.cast_shadows import cast_shadows
from sumo_reactive.driver.nouns.completed_plan import Weights
from sumo_reactive.driver.nouns.traffic import Body, RoadUser

FRONT = 200.0
LENGTH, WIDTH = 4.0, 2.0
PLAN = plan_along(straight())
COMPLETED = asked(PLAN)


def other(name: str, rear: float, left: float, speed: float, heading: float = 0.0) -> RoadUser:
    """Somebody whose end nearer to the ego is `rear` m ahead of it, `left` m beside C."""
    x = FRONT + rear + (LENGTH if heading == 0.0 else 0.0)
    return RoadUser(name, x, left, heading, speed, "a_0", 0.0, Body(LENGTH, WIDTH, 9.0, 50.0), ())


def cast(speed: float, *users: RoadUser, completed=COMPLETED):
    """Return the shadows on an ego of this speed."""
    snapshot = seen(on_curve(PLAN.curve, FRONT, speed), PLAN, FRONT - CAR.front_overhang, users)
    return cast_shadows(snapshot, completed, CAR, users)


def test_the_shadow_of_who_is_slower_reaches_from_his_rear_to_where_the_ego_meets_him():
    (shadow,) = cast(10.0, other("slow", 8.0, 0.0, 6.0))
    assert shadow.user_id == "slow" and shadow.weight > 0.0
    along, across = shadow.outline[:, 0] - FRONT, shadow.outline[:, 1]
    meets = 8.0 / (10.0 - 6.0)
    assert (along.min(), along.max()) == pytest.approx((8.0, 8.0 + 6.0 * meets + LENGTH))
    assert (across.min(), across.max()) == pytest.approx((-0.5 * WIDTH, 0.5 * WIDTH))


def test_the_shadow_of_who_comes_towards_the_ego_reaches_back_to_where_they_meet():
    (shadow,) = cast(10.0, other("oncoming", 20.0, 1.5, 10.0, math.pi))
    along = shadow.outline[:, 0] - FRONT
    assert (along.min(), along.max()) == pytest.approx((10.0, 24.0))


def test_who_moves_aside_casts_his_shadow_aside():
    (shadow,) = cast(10.0, other("slow", 12.0, -0.5, 6.0)._replace(heading=0.05))
    left_side = shadow.outline[: len(shadow.outline) // 2, 1]
    assert left_side[-1] > left_side[0] + 0.2


@pytest.mark.parametrize("user", [other("faster", 8.0, 0.0, 12.0), other("beside", 8.0, 4.0, 0.0)])
def test_who_is_not_met_casts_none(user):
    assert cast(10.0, user) == ()


def test_where_u2_has_no_weight_nobody_casts_one():
    assert cast(10.0, other("slow", 8.0, 0.0, 6.0), completed=asked(PLAN, weights=Weights(10.0, 0.0, 1.0))) == ()
