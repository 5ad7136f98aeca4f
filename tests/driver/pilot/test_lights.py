"""What each letter of a traffic light makes the ego do, on the signalised crossing without any other traffic."""

import pytest
from helpers.situations import before

from sumo_reactive.driver.nouns.constraint import TimeConstraint
from sumo_reactive.driver.nouns.decision import Reason
from sumo_reactive.driver.parameters import USUAL
from sumo_reactive.driver.pilot.rules.lights import has_passed, holds_back
from sumo_reactive.driver.vehicle.safe_speed import HARD_STOP_MARGIN_M

CROSSING = "signalised_left_turns"
STRAIGHT = ("from_south", "to_north")
LINKS = 12


def letters(letter: str, link: int) -> dict[str, str]:
    """The crossing's lights: one letter for the ego's link, green for the rest, so that a wrong index is noticed."""
    return {"centre": "G" * link + letter + "G" * (LINKS - link - 1)}


def stop_for(letter: str, away: float, speed: float) -> TimeConstraint | None:
    ego = before(CROSSING, STRAIGHT, away, speed)
    return ego.stop(lights=letters(letter, ego.connection.light.index))


@pytest.mark.parametrize("letter", "GgoO")
@pytest.mark.parametrize(("away", "speed"), [(50.0, 13.0), (5.0, 8.0), (1.0, 0.0)])
def test_green_or_off_leaves_it_to_the_right_of_way(letter, away, speed):
    assert stop_for(letter, away, speed) is None


@pytest.mark.parametrize("letter", "ru")
@pytest.mark.parametrize(("away", "speed"), [(50.0, 13.0), (12.0, 8.0), (1.0, 0.0)])
def test_red_and_red_with_yellow_stop_at_the_line(letter, away, speed):
    ego = before(CROSSING, STRAIGHT, away, speed)
    stop = ego.stop(lights=letters(letter, ego.connection.light.index))
    assert (stop.reason, stop.s, stop.cause) == (Reason.RED_LIGHT, ego.line, "centre")


@pytest.mark.parametrize("letter", "ruy")
def test_a_car_that_stands_with_its_front_on_the_line_has_its_light_before_it(letter):
    assert stop_for(letter, 0.0, 0.0) is not None


@pytest.mark.parametrize(("front", "passed"), [(-1.0, False), (0.0, False), (1e-5, False), (0.1, True), (5.0, True)])
def test_a_line_is_passed_by_more_than_places_on_it_are_exact(front, passed):
    assert has_passed(20.0, 20.0 + front) is passed


@pytest.mark.parametrize("letter", "yY")
@pytest.mark.parametrize(("away", "speed"), [(50.0, 13.0), (30.0, 10.0), (2.0, 0.0)])
def test_yellow_stops_a_car_that_can_stop_comfortably(letter, away, speed):
    assert stop_for(letter, away, speed).reason is Reason.YELLOW_LIGHT


@pytest.mark.parametrize("letter", "yY")
@pytest.mark.parametrize(("away", "speed"), [(15.0, 13.0), (5.0, 8.0)])
def test_yellow_lets_a_car_pass_that_is_too_close_to_stop(letter, away, speed):
    assert stop_for(letter, away, speed) is None


def test_red_holds_a_car_that_has_crept_up_to_the_line():
    assert stop_for("r", 0.2, 0.5).reason is Reason.RED_LIGHT


def test_a_light_behind_the_front_bumper_no_longer_speaks():
    ego = before(CROSSING, STRAIGHT, 20.0, 8.0)
    past = ego.driven(5.0, lights=letters("G", ego.connection.light.index))
    step = next(step for step in past if step.snapshot.front > ego.line + 1.0)
    assert ego.step(lights=letters("r", ego.connection.light.index), drive=step.drive).completed.stop is None


def test_the_letter_s_asks_for_a_full_stop_and_then_lets_go():
    far = before(CROSSING, ("from_south", "to_east"), 15.0, 5.0)
    lights = letters("s", far.connection.light.index)
    assert far.stop(lights=lights).reason is Reason.STOP_SIGN
    speeds = [(step.snapshot.front, step.snapshot.ego.speed) for step in far.driven(16.0, lights=lights)]
    assert min(speed for front, speed in speeds if front < far.line) < 0.1
    assert max(front for front, _ in speeds) > far.line + 5.0


def test_the_ego_drives_off_when_red_turns_green():
    ego = before(CROSSING, STRAIGHT, 30.0, 10.0)
    link = ego.connection.light.index
    held = ego.driven(10.0, lights=letters("r", link))
    assert held[-1].drive.ego.speed < 0.05
    assert 0.1 < ego.line - held[-1].snapshot.front < 2.0
    going = ego.step(lights=letters("G", link), drive=held[-1].drive, time=110.0)
    assert going.completed.stop is None
    assert going.drive.ego.speed > 0.0


def test_a_junction_without_a_light_has_no_letter():
    assert before("four_way_priority", ("from_west", "to_east"), 30.0, 10.0).stop() is None


@pytest.mark.parametrize("speed", [6.0, 10.0, 14.0])
def test_a_yellow_is_stopped_at_only_where_planned_braking_ends_before_the_line(speed):
    way = speed**2 / (2.0 * USUAL.yellow_deceleration) + HARD_STOP_MARGIN_M
    assert stop_for("y", way + 0.2, speed).reason is Reason.YELLOW_LIGHT
    assert stop_for("y", way - 0.1, speed) is None


@pytest.mark.parametrize(("to", "stops"), [("to_north", False), ("to_east", True)])
def test_who_brakes_for_a_turn_does_not_come_to_the_line_when_it_has_become_red(to, stops):
    """It could pass at yellow if it went straight on; braking for the turn takes it nearly 3 s to the line."""
    ego = before(CROSSING, ("from_south", to), 28.5, 13.2)
    stop = ego.stop(lights=letters("y", ego.connection.light.index))
    assert (stop is not None and stop.reason is Reason.YELLOW_LIGHT) is stops


@pytest.mark.parametrize(("since", "stops"), [(97.8, True), (99.5, False)])
def test_who_has_braked_for_a_yellow_does_not_think_better_of_it_when_it_is_nearly_red(since, stops):
    """So near it would be too near for a yellow that has just begun, slow as it is."""
    ego = before(CROSSING, ("from_south", "to_north"), 8.0, 7.2)
    stop = ego.remembering(yellows=((ego.connection.id, since),)).stop(lights=letters("y", ego.connection.light.index))
    assert (stop is not None and stop.reason is Reason.YELLOW_LIGHT) is stops


@pytest.mark.parametrize("letter", "rRuyY")
@pytest.mark.parametrize(
    ("to_line", "speed", "shut_for", "held"),
    [
        (30.0, 13.0, 0.0, True),
        (20.0, 13.0, 0.0, False),
        (20.0, 13.0, 1.0, True),  # it came on when he was 33 m before the line
        (10.0, 13.0, 9.0, True),
        (9.0, 13.0, 9.0, False),  # whatever he has seen, nothing stops him any more
        (-0.1, 5.0, 9.0, False),  # he is over the line
    ],
)
def test_who_could_stop_when_his_light_came_on_and_still_can_is_held_back(letter, to_line, speed, shut_for, held):
    assert holds_back(letter, to_line, speed, shut_for, hardest=9.0, bearable=3.0) is held


@pytest.mark.parametrize("letter", ["G", "g", "o", "O", "s", ""])
def test_no_other_letter_holds_anybody_back(letter):
    assert not holds_back(letter, 50.0, 5.0, 9.0, hardest=9.0, bearable=3.0)
