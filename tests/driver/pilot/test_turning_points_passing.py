"""Where the pilot's word turns over when it wants to pass somebody: each row one scene of which one figure grows."""

from collections.abc import Callable
from functools import cache

import pytest
from helpers.cars import CAR
from helpers.situations import PERIOD, Situation, before
from helpers.turning_points import turns_at

from sumo_reactive.driver.controller import Controller
from sumo_reactive.driver.nouns.decision import Behaviour
from sumo_reactive.driver.nouns.traffic import RoadUser
from sumo_reactive.driver.parameters import USUAL
from sumo_reactive.driver.pilot.behaviours.overtaking import HALTED_AHEAD_S

COUNTRY, ONCOMING = ("eastbound", "eastbound_out"), ("westbound", "westbound_out")
ROAD = ("road_before_exit", "road_after_exit")
SLOW, GAP = 8.5, 10.5
Holds = Callable[[float], bool]

ego_at = cache(before)


def passes(ego: Situation, *users: RoadUser, sight: float = USUAL.overtaking_sight_m) -> bool:
    """Whether the ego pulls out now."""
    step = Controller(graph=ego.graph, limits=CAR).step(ego.traffic(*users, sight=sight), ego.drive(), PERIOD)
    return step.completed.behaviour is Behaviour.OVERTAKING


def late(away: float = 620.0, speed: float = SLOW, by: float = 3.0) -> Situation:
    return ego_at("two_way_road", COUNTRY, away, speed).late_by(by)


def behind_x(
    ego: Situation, *others: RoadUser, gap: float = GAP, speed: float = SLOW, sight=USUAL.overtaking_sight_m
) -> bool:
    return passes(ego, ego.ahead("x", gap, speed), *others, sight=sight)


def oncoming(speed: float) -> Holds:
    return lambda away: behind_x(late(), late().other("comes", "westbound_0", -away, speed, ONCOMING))


def halted(ego: Situation, gap: float = 20.0, *others: RoadUser) -> bool:
    return passes(ego, ego.ahead("x", gap, 0.0, halted=True), *others)


def street(away: float = 300.0, speed: float = 6.0) -> Situation:
    return ego_at("blocked_lane", COUNTRY, away, speed)


def comes_along_the_street(speed: float) -> Holds:
    return lambda away: halted(street(), 20.0, street().other("comes", "westbound_0", -away, speed, ONCOMING))


def beside(speed: float, side: float) -> Holds:
    """Whether it pulls out with somebody on the lane beside, so many metres behind its front or (`side` 1) before it."""
    ego = ego_at("multi_lane_road", ROAD, 380.0, SLOW).late_by(3.0)

    def holds(away: float) -> bool:
        at = ego.ahead("y", side * away - 4.7, speed).lane_position
        return behind_x(ego, ego.other("y", f"{ROAD[0]}_1", at, speed, ROAD))

    return holds


def seeks_behind(speed: float) -> bool:
    """Whether an ego with 17 m/s wants to pass somebody 30 m ahead with this speed."""
    ego = late(speed=17.0)
    return ego.step(ego.ahead("x", 30.5, speed)).completed.sight > 0.0


ROWS: dict[str, tuple[Holds, float, float, float]] = {
    "m that slow oncoming traffic must be away": (oncoming(5.0), 200.0, 700.0, 438.540),
    "m that oncoming traffic at the limit's speed must be away": (oncoming(20.0), 200.0, 700.0, 438.540),
    "m that faster oncoming traffic must be away": (oncoming(30.0), 200.0, 700.0, 520.285),
    "m that somebody who stands on the oncoming lane must be away": (oncoming(0.0), 150.0, 300.0, 205.231),
    "m that the ego must have looked": (lambda m: behind_x(late(), sight=m), 500.0, 700.0, USUAL.overtaking_sight_m),
    "m of gap that is too long": (lambda m: behind_x(late(), gap=m), GAP, 60.0, 15.1),
    "m of gap that is too short": (lambda m: behind_x(late(), gap=m), 2.0, GAP, 6.3),
    "m/s of X that is too fast": (lambda v: behind_x(late(), speed=v), SLOW, 20.0, 9.76),
    "m/s of X that is too slow to have settled behind it": (lambda v: behind_x(late(), speed=v), 2.0, SLOW, 7.158),
    "m/s of X that is worth a look": (seeks_behind, SLOW, 22.0, 16.665),
    "s of delay": (lambda s: behind_x(late(by=s)), 0.0, 3.0, 1.584),
    "m before the junction": (lambda m: behind_x(late(m)), 50.0, 400.0, 117.471),
    "m of gap behind somebody who has halted": (
        lambda m: halted(street(), m), 20.0, 60.0, USUAL.following_m + 6.0 * HALTED_AHEAD_S,
    ),
    "m of room to swing out": (lambda m: halted(street(), m), 2.0, 20.0, 11.462),
    "m before the junction that a halted car is passed": (lambda m: halted(street(m)), 25.0, 150.0, 42.489),
    "m along the street of slow traffic": (comes_along_the_street(5.0), 100.0, 400.0, 199.064),
    "m along the street of traffic": (comes_along_the_street(12.0), 100.0, 400.0, 199.064),
    "m behind on the lane beside": (beside(15.0, -1.0), 5.0, 120.0, 15.940),
    "m behind on the lane beside at the ego's speed": (beside(SLOW, -1.0), 5.0, 120.0, 10.721),
    "m before on the lane beside": (beside(5.0, 1.0), 5.0, 120.0, 82.140),
    "m before on the lane beside at the ego's speed": (beside(SLOW, 1.0), 5.0, 120.0, 57.991),
}  # fmt: skip


@pytest.mark.parametrize("name", ROWS)
def test_behind_somebody_slow_the_pilots_word_turns_over_at(name):
    holds, low, high, figure = ROWS[name]
    assert turns_at(holds, low, high) == pytest.approx(figure, abs=0.005)
