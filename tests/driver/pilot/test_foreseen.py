"""What the pilot foresees: its own way behind a leader and up to a stop, whom it meets on it, and on a way past somebody."""

import math
from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from helpers.cars import CAR, car_at
from helpers.curves import on_curve, plan_along, seen, straight
from helpers.situations import Situation, before
from helpers.turning_points import turns_at

from sumo_reactive.driver.nouns.assessment import Assessment, PlanOutcome
from sumo_reactive.driver.nouns.constraint import stop_at
from sumo_reactive.driver.nouns.decision import Instruction, Reason
from sumo_reactive.driver.nouns.forecast import Forecast
from sumo_reactive.driver.nouns.plan import Aside
from sumo_reactive.driver.nouns.snapshot import PathObstacle
from sumo_reactive.driver.nouns.traffic import RoadUser
from sumo_reactive.driver.pilot.assessment import assess
from sumo_reactive.driver.pilot.behaviours.overtaking import OvertakingStep, carry_on
from sumo_reactive.driver.pilot.manoeuvre import proof
from sumo_reactive.driver.pilot.passages import View
from sumo_reactive.driver.view.foresee import NOBODY

ROAD = plan_along(straight(), 10.0)
EAST, NORTH = 0.0, 0.5 * math.pi
COUNTRY, ONCOMING = ("eastbound", "eastbound_out"), ("westbound", "westbound_out")
Holds = Callable[[float], bool]


def path(name: str, x: float, y: float, heading: float, speed: float, lateral: float = 0.0, along: float = 0.0) -> Forecast:
    """One straight path, whose user is `along` m on it and `lateral` m to its left."""
    s = np.arange(0.0, 302.0, 2.0)
    points = np.column_stack([x + s * math.cos(heading), y + s * math.sin(heading), np.full(len(s), heading)])
    body = np.array([(along, lateral, speed, 4.0, 2.0, 13.9)])
    return Forecast((name,), points, np.array([0]), np.array([len(s)]), body)


def going_on(forecast=NOBODY, speed=10.0, stop=None, x=None) -> Assessment:
    """The assessment of an ego on a straight road of 10 m/s, its bumper at x = 10 m; `x`: gap and speed of who is ahead."""
    snapshot = seen(on_curve(ROAD.curve, 10.0, speed), ROAD, 10.0 - CAR.front_overhang, time=100.0)
    if x is not None:
        gap, other = x
        obstacle = PathObstacle(car_at("x", 14.7 + gap, 0.0, 0.0, other), 10.0 + gap, 14.7 + gap, other, 0.0)
        snapshot = snapshot._replace(on_path=(obstacle,))
    return assess(View(snapshot, ROAD, CAR, (), ()), forecast, stop, None, ())


def fails(found: Assessment) -> bool:
    return found.outcome is PlanOutcome.FAILURE


@pytest.mark.parametrize(
    ("scene", "meets"),
    [
        ({"forecast": path("x", 50.0, -20.0, NORTH, 5.0)}, (104.0, 50.0, 50.0, 0.0)),
        ({"forecast": path("x", 110.0, 0.0, math.pi, 10.0)}, (105.0, 60.0, 60.0, 0.0)),
        ({"forecast": path("x", 50.0, -20.0, NORTH, 5.0, along=2.0)}, (104.0, 50.0, 50.0, 0.0)),
        ({"forecast": path("x", 50.0, -20.0, NORTH, 5.0), "speed": 5.0}, (104.6, 49.81, 49.81, 0.0)),
        ({"forecast": path("x", 60.0, 1.0, EAST, 0.0)}, (104.6, 56.0, 56.0, 0.0)),
        ({"forecast": path("x", 40.0, -12.0, 0.3 * math.pi, 4.0, lateral=1.0)}, (103.6, 46.0, 46.0, 0.0)),
        ({"forecast": path("x", 60.0, 0.0, math.pi, 3.0), "x": (12.0, 4.0)}, (106.4, 41.23, 41.23, 0.0)),
        ({"forecast": path("x", 39.0, 0.0, EAST, 0.0), "stop": stop_at(36.0, Reason.RED_LIGHT)}, (104.0, 35.27, 35.27, 0.0)),
    ],
)
def test_an_encounter_is_told_with_time_and_place(scene, meets):
    encounter = going_on(**scene).encounter
    assert encounter is not None
    assert (encounter.time, encounter.s, encounter.x, encounter.y) == pytest.approx(meets, abs=0.01)


@pytest.mark.parametrize(
    ("scene", "late"),
    [
        ({}, 0.20),
        ({"speed": 4.0}, 1.09),
        ({"speed": 0.0}, 2.66),
        ({"stop": stop_at(60.0, Reason.RED_LIGHT)}, 3.00),
        ({"stop": stop_at(30.0, Reason.RED_LIGHT)}, 6.00),
        ({"x": (20.0, 5.0)}, 2.91),
        ({"x": (6.0, 5.0)}, 4.17),
        ({"x": (30.0, 0.0)}, 5.21),
        ({"x": (8.0, 0.0), "speed": 6.0}, 7.40),
        ({"speed": 13.0}, 0.14),
    ],
)
def test_how_late_the_ego_will_be_is_foreseen_to_a_hundredth_of_a_second(scene, late):
    already = ROAD.on_schedule(10.0 - CAR.front_overhang, 100.0)[0]
    assert going_on(**scene).lateness - already == pytest.approx(late, abs=0.01)


def crosses(speed: float, x: float = 50.0) -> Holds:
    """Whether somebody who crosses with this speed is met, so far away at first."""
    return lambda away: fails(going_on(path("x", x, -away, NORTH, speed)))


def follows(speed: float, to_left: float = 0.0) -> Holds:
    """Whether somebody on the way is met, his front so far before the ego's."""
    return lambda m: fails(going_on(path("x", 10.0 + m, to_left, EAST, speed)))


def proven(ego: Situation, *users: RoadUser, mirrored: bool = False):
    """The proof that X can be passed; `mirrored`: on the right, as where traffic keeps to the left."""
    situation = ego.considered(*users, sight=600.0)
    if mirrored:
        outlook = situation.outlook
        lanes = tuple(lane._replace(lateral=-lane.lateral) for lane in outlook.beside)
        situation = situation._replace(outlook=outlook._replace(beside=lanes))
    assert situation.ahead_of_ego is not None
    return proof(situation, situation.ahead_of_ego)


@cache
def country() -> Situation:
    return before("two_way_road", COUNTRY, 620.0, 8.5).late_by(3.0)


@cache
def street(speed: float = 6.0) -> Situation:
    return before("blocked_lane", COUNTRY, 300.0, speed)


def turned(user: RoadUser, by: float, aside: float = 0.0) -> RoadUser:
    """The user as one who stands at an angle, and so far to the left."""
    return user._replace(heading=user.heading + by, y=user.y + aside)


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize(
    ("ego", "gap", "speed", "by", "aside", "expected"),
    [
        (country, 10.5, 8.5, 0.0, 0.0, (2.45, 76.997, 131.003, 8.4)),
        (country, 14.0, 5.0, 0.0, 0.3, (2.75, 53.962, 101.288, 7.6)),
        (street, 20.0, 0.0, 0.0, 0.0, (2.45, 29.024, 63.550, 6.0)),
        (street, 20.0, 0.0, 0.2, -0.4, (2.032, 29.024, 60.467, 5.8)),
        (street, 30.0, 0.0, -0.2, -0.4, (2.966, 39.573, 81.332, 7.4)),
    ],
)
def test_a_way_past_somebody_leads_so_far_aside_and_back_at(ego, gap, speed, by, aside, expected, mirrored):
    """`expected`: how far aside, where it leads back and has (m ahead of the bumper), how long it takes (s). On the other
    side it is the same way, for somebody who stands in the mirror."""
    x = turned(ego().ahead("x", gap, speed, halted=speed == 0.0), -by if mirrored else by, -aside if mirrored else aside)
    found, front = proven(ego(), x, mirrored=mirrored), ego().seen().front
    assert found.aside is not None
    side = -1.0 if mirrored else 1.0
    told = (side * found.aside.lateral, found.aside.back - front, found.aside.until - front, found.duration)
    assert told == pytest.approx(expected, abs=0.01)


def on_the_way_past(x_ahead: float, *others: RoadUser, back: float = 100.0) -> OvertakingStep:
    """What an ego 2.5 m beside its lane does that passes X, whose rear is `x_ahead` m before its bumper."""
    ego = passing(back)
    return carry_on(ego.considered(ego.ahead("x", x_ahead, 8.5), *others, sight=600.0), ego.memory.overtaking)


@cache
def passing(back: float = 100.0) -> Situation:
    aside = Aside(2.5, back, back + 40.0)
    return before("two_way_road", COUNTRY, 600.0, 15.0, to_left=2.5, aside=aside).passing("x")


def returns(found: OvertakingStep) -> bool:
    return found.overtaking.instruction is Instruction.RETURN


def falls_back(found: OvertakingStep) -> bool:
    return found.overtaking.instruction is Instruction.FALL_BACK


def comes(away: float, speed: float = 20.0) -> RoadUser:
    return passing().other("comes", "westbound_0", -away, speed, ONCOMING)


def second(ahead: float, speed: float) -> RoadUser:
    return passing().ahead("second", ahead, speed)


ROWS: dict[str, tuple[Holds, float, float, float]] = {
    "m of a crosser who comes too late": (crosses(5.0), 20.0, 40.0, 22.9),
    "m of a crosser who has passed": (crosses(5.0), 8.0, 20.0, 15.099),
    "m of a fast crosser who comes too late": (crosses(12.0, 40.0), 36.0, 90.0, 41.699),
    "m of a fast crosser who has passed": (crosses(12.0, 40.0), 10.0, 36.0, 31.1),
    "m of who drives before the ego's middle": (follows(0.0), -6.0, 5.0, -2.001),
    "m of who drives off before it": (follows(6.0), 20.0, 60.0, 35.2),
    "m beside": (lambda m: fails(going_on(path("x", 60.0, m, math.pi, 5.0))), 0.0, 4.0, 1.899),
    "m beside to the right": (lambda m: fails(going_on(path("x", 60.0, -m, math.pi, 5.0))), 0.0, 4.0, 1.899),
    "m before a stop": (
        lambda m: fails(going_on(path("x", m, 0.0, NORTH, 0.0), stop=stop_at(40.0, Reason.RED_LIGHT))), 20.0, 60.0, 41.0,
    ),
    "m that X is behind before the ego comes back": (lambda m: returns(on_the_way_past(-m)), 5.0, 60.0, 18.501),
    "m that oncoming traffic must be away on the way past": (
        lambda m: falls_back(on_the_way_past(12.0, comes(m))), 200.0, 600.0, 355.837,
    ),
    "m that slow oncoming traffic must be away on the way past": (
        lambda m: falls_back(on_the_way_past(12.0, comes(m, 8.0))), 200.0, 600.0, 355.837,
    ),
    "m at which X is beside and the ego slows down": (
        lambda m: falls_back(on_the_way_past(m, comes(190.0))), -3.0, 20.0, 8.45,
    ),
    "m of way that is short of its margin": (
        lambda m: on_the_way_past(-4.0, comes(m)).top_speed < math.inf, 150.0, 400.0, 241.765,
    ),
    "m ahead of who is in the way back": (lambda m: returns(on_the_way_past(-30.0, second(m, 8.5))), 1.0, 100.0, 50.292),
    "m ahead of who is in the way back and as fast": (
        lambda m: returns(on_the_way_past(-30.0, second(m, 15.0))), 0.0, 60.0, 20.393,
    ),
    "m behind of who is in the way back": (lambda m: returns(on_the_way_past(-60.0, second(-m, 15.0))), 5.0, 40.0, 7.610),
    "m of way that is left to the place of return": (lambda m: on_the_way_past(-30.0, back=m).replans, 1.0, 20.0, 3.969),
}  # fmt: skip


@pytest.mark.parametrize("name", ROWS)
def test_what_is_foreseen_turns_over_at(name):
    holds, low, high, figure = ROWS[name]
    assert turns_at(holds, low, high) == pytest.approx(figure, abs=0.005)


@pytest.mark.parametrize("back", [6.0, 60.0])
def test_the_way_past_leads_on_beside_x_where_it_would_come_back_before_the_ego_is_clear_of_it(back):
    found = on_the_way_past(-4.0, comes(190.0), back=back)
    assert found.overtaking.instruction is Instruction.OVERTAKE
    assert found.replans == (back == 6.0)
    if found.replans:
        assert found.aside is not None and found.aside.back > 40.0


def test_who_comes_from_behind_on_the_egos_lane_need_not_be_looked_at_wherever_on_the_map_that_is():
    """Only its own lane counts: to either side he is met when the ego pulls out or back."""
    ego = before("multi_lane_road", ("road_before_exit", "road_after_exit"), 380.0, 8.5).late_by(3.0)
    situation = ego.considered(ego.ahead("x", 10.5, 8.5), ego.ahead("behind", -16.0, 25.0), sight=600.0)
    assert situation.ahead_of_ego is not None
    forecast = situation.outlook.forecast
    k = forecast.user_ids.index("behind")
    for lateral, is_met in ((0.0, False), (1.3, False), (-1.3, False), (1.5, True)):
        bodies = forecast.bodies.copy()
        bodies[k, 1] = lateral
        moved = situation._replace(outlook=situation.outlook._replace(forecast=forecast._replace(bodies=bodies)))
        found = proof(moved, situation.ahead_of_ego)
        assert (found.obstacle == "behind") is is_met


def test_why_nobody_can_be_passed_is_told_in_words():
    lane_of_its_own = before("multi_lane_road", ("road_before_exit", "road_after_exit"), 380.0, 8.5, 2)
    short, plan = before("two_way_road", COUNTRY, 110.0, 8.5), country().plan
    fast = country().considered(country().ahead("x", 10.5, 16.0), sight=600.0)
    slow = replace(plan, speed_limits=np.minimum(plan.speed_limits, 16.5))
    assert fast.ahead_of_ego is not None
    told = [
        proven(street(), street().ahead("x", 4.0, 0.0, halted=True)),
        proof(fast._replace(plan=slow), fast.ahead_of_ego),
        proven(short, short.ahead("x", 10.5, 8.5)),
        proven(lane_of_its_own, lane_of_its_own.ahead("x", 10.5, 8.5)),
    ]
    assert [(one.aside, one.obstacle) for one in told] == [
        (None, "no room to swing out"),
        (None, "x is too fast to pass"),
        (None, "the road ahead is too short"),
        (None, "no lane to pass on"),
    ]
