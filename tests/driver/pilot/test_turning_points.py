"""Where the pilot's word turns over before a junction: each row one scene of which one figure grows."""

from collections.abc import Callable
from functools import cache

import pytest
from helpers.cars import CAR
from helpers.curves import on_curve
from helpers.situations import Situation, before
from helpers.turning_points import turns_at

from sumo_reactive.driver.nouns.traffic import RoadUser
from sumo_reactive.driver.parameters import USUAL
from sumo_reactive.driver.pilot.rules.trust import OFF_THE_LINE_M

NORTH_SOUTH, SOUTH_NORTH, SOUTH_WEST = ("from_north", "to_south"), ("from_south", "to_north"), ("from_south", "to_west")
WEST_EAST, EAST_WEST = ("from_west", "to_east"), ("from_east", "to_west")
PRIORITY, ALL_WAY, RIGHT_FIRST = "four_way_priority", "all_way_stop", "right_before_left"
GREEN = {"centre": "GGgrrrGGgrrr"}
Holds = Callable[[float], bool]

ego_at = cache(before)


def on(ego: Situation, route: tuple[str, str], away: float, speed: float, waiting: float = 0.0) -> RoadUser:
    """A car `away` m before its line."""
    return ego.other(route[0], f"{route[0]}_0", -away, speed, route, waiting)


def minor(away: float, speed: float, route=SOUTH_NORTH) -> Situation:
    return ego_at(PRIORITY, route, away, speed)


def stops_for(ego: Situation, route: tuple[str, str], speed: float, lights: dict[str, str] | None = None) -> Holds:
    """Whether the ego stops for a car with this speed, so many metres before its line."""
    return lambda away: ego.stop(on(ego, route, away, speed), lights=lights) is not None


def stops_at_speed(ego: Situation, route: tuple[str, str], away: float) -> Holds:
    return lambda speed: ego.stop(on(ego, route, away, speed)) is not None


def queue_ends_at(*speeds: float) -> Holds:
    """Whether the ego stays out of a junction behind which cars of these speeds stand or crawl, the last at this place."""
    ego = minor(15.0, 6.0)

    def stays(place: float) -> bool:
        queue = (ego.other(f"q{k}", "to_north_0", place + 7.0 * k, v, ("to_north",)) for k, v in enumerate(speeds))
        return ego.stop(*queue) is not None

    return stays


def stood(seconds: float) -> Situation:
    return ego_at(ALL_WAY, WEST_EAST, 1.0, 0.0).having_stood(seconds)


def stands_there_for(ego: Situation, route: tuple[str, str]) -> Holds:
    """Whether the ego stops for a car at its line that has waited for so long."""
    return lambda waiting: ego.stop(on(ego, route, 1.0, 0.0, waiting)) is not None


def inside(into: float, route: tuple[str, str]) -> Holds:
    """Whether an ego with 3 m/s, its bumper so far behind its line, stops for a car so many metres before its own."""
    ego = minor(10.0, 3.0)
    front = ego.line + into
    drive = ego.drive()._replace(ego=on_curve(ego.plan.curve, front, 3.0), s=front - CAR.front_overhang)
    return lambda away: ego.step(on(ego, route, away, 13.0), drive=drive).completed.stop is not None


def behind(ego: Situation) -> Holds:
    """Whether the ego stops for a car so far inside the junction that drives through it."""
    part = ego.graph.connections["from_west_0->to_east_0"].parts[0]
    return lambda at: ego.stop(ego.other("x", part, at, 13.0, ("to_east",))) is not None


LEFT = ego_at("signalised_left_turns", SOUTH_WEST, 8.0, 6.0, 1)
FROM_A_STAND, ROLLING = minor(1.0, 0.0, SOUTH_WEST), minor(8.0, 6.0)
NEAR_RIGHT = ego_at(RIGHT_FIRST, SOUTH_NORTH, 12.0, 6.0)
CANNOT_STOP_M = 13.0**2 / (2.0 * USUAL.foe_can_stop_deceleration)

ROWS: dict[str, tuple[Holds, float, float, float]] = {
    "m that a fast car from the left must be away": (stops_for(FROM_A_STAND, WEST_EAST, 13.0), 26.0, 150.0, 67.57),
    "m that a slow car from the left must be away": (stops_for(FROM_A_STAND, WEST_EAST, 8.0), 26.0, 150.0, 56.271),
    "m that a car from the right must be away": (stops_for(FROM_A_STAND, EAST_WEST, 13.0), 26.0, 150.0, 75.498),
    "m/s at which a near car counts": (stops_at_speed(FROM_A_STAND, WEST_EAST, 20.0), 0.2, 13.0, 0.784),
    "m that a car must be away of an ego that rolls": (stops_for(ROLLING, WEST_EAST, 13.0), 20.0, 150.0, 36.997),
    "m at which the ego goes behind": (stops_for(minor(20.0, 8.0), WEST_EAST, 13.0), 0.5, 30.0, 9.631),
    "m of oncoming walkers' pace": (stops_for(LEFT, NORTH_SOUTH, 3.0, GREEN), 20.0, 150.0, 27.664),
    "m of oncoming town traffic": (stops_for(LEFT, NORTH_SOUTH, 10.0, GREEN), 20.0, 150.0, 59.001),
    "m of oncoming fast traffic": (stops_for(LEFT, NORTH_SOUTH, 13.0, GREEN), 20.0, 150.0, 63.78),
    "m of who comes from the left to an ego inside": (inside(1.0, WEST_EAST), 0.5, 60.0, CANNOT_STOP_M),
    "m of who comes from the right to an ego inside": (inside(1.0, EAST_WEST), 10.0, 60.0, CANNOT_STOP_M),
    "m of who is too near on the right of an ego inside": (inside(1.0, EAST_WEST), 0.5, 10.0, 5.392),
    "m of who comes from the right to an ego farther inside": (inside(5.0, EAST_WEST), 0.5, 60.0, CANNOT_STOP_M),
    "m at which who comes from the left is sure to go": (stops_for(minor(1.0, 0.0), WEST_EAST, 13.0), 0.1, 20.0, 2.863),
    "m at which who comes from the right is sure to go": (stops_for(minor(1.0, 0.0), EAST_WEST, 13.0), 0.1, 20.0, 6.063),
    "m of who is through before an ego that rolls": (behind(minor(1.0, 2.0)), 0.1, 13.0, 0.956),
    "m of who is through before a faster ego": (behind(minor(3.0, 4.0)), 0.1, 13.0, 3.016),
    "m of who comes after a faster ego": (stops_for(minor(3.0, 4.0), WEST_EAST, 13.0), 20.0, 40.0, 36.143),
    "m where a queue behind ends": (queue_ends_at(0.0), 3.5, 20.0, 10.7),
    "m where a crawling car behind is": (queue_ends_at(2.0), 3.5, 20.0, 7.9),
    "m where a crawling car behind another is": (queue_ends_at(2.0, 0.0), 3.5, 20.0, 10.7),
    "m where a faster car behind one that stands is": (queue_ends_at(4.0, 0.0), 3.5, 20.0, 10.7),
    "s that who stands at an all-way stop has waited longer": (stands_there_for(stood(1.0), NORTH_SOUTH), 0.1, 5.0, 1.0),
    "s after which who does not start counts no more": (
        stands_there_for(stood(USUAL.foe_patience_s + 0.5), NORTH_SOUTH), 4.0, 9.0, 2.0 * USUAL.foe_patience_s,
    ),
    "m/s at which who approaches an all-way stop can no longer stop": (
        stops_at_speed(stood(1.0), NORTH_SOUTH, 8.0), 1.0, 13.0, (2.0 * USUAL.sign_stop_deceleration * 8.0) ** 0.5,
    ),
    "m before its line where who rolls has left its stop": (
        stops_for(stood(1.0), NORTH_SOUTH, 0.5), 0.5, 5.0, OFF_THE_LINE_M,
    ),
    "s of waiting that shorten the patience with who has priority": (
        stands_there_for(minor(1.0, 0.0).having_stood(1.5), WEST_EAST), 2.0, 8.0, 2.0 * USUAL.foe_patience_s - 1.5,
    ),
    "m that a car from the right without signs must be away": (stops_for(NEAR_RIGHT, EAST_WEST, 7.0), 12.0, 100.0, 30.590),
    "m/s at which a car from the left can no longer stop": (
        stops_at_speed(NEAR_RIGHT, WEST_EAST, 15.0), 6.0, 14.0, (2.0 * USUAL.foe_can_stop_deceleration * 15.0) ** 0.5,
    ),
    "m at which a car from the left can no longer stop": (
        stops_for(NEAR_RIGHT, WEST_EAST, 6.0), 1.0, 15.0, 36.0 / (2.0 * USUAL.foe_can_stop_deceleration),
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", ROWS)
def test_before_a_junction_the_pilots_word_turns_over_at(name):
    holds, low, high, figure = ROWS[name]
    assert turns_at(holds, low, high) == pytest.approx(figure, abs=0.005)


@pytest.mark.parametrize(("standing", "turns"), [(1.5, 4.5), (2.0, 4.0), (2.5, 3.5)])
def test_the_longer_the_ego_stands_the_less_who_stands_with_priority_must_have_waited(standing, turns):
    holds = stands_there_for(minor(1.0, 0.0).having_stood(standing), WEST_EAST)
    assert turns_at(holds, 2.0, 8.0) == pytest.approx(turns, abs=0.005)
