"""Where the ego waits inside a junction, until when it can, and where it trusts others to wait."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import pytest
from helpers.cars import CAR
from helpers.curves import on_curve
from helpers.situations import Situation, before
from helpers.turning_points import turns_at

from sumo_reactive.driver.nouns.constraint import TimeConstraint
from sumo_reactive.driver.nouns.state import CREEPING_SPEED
from sumo_reactive.driver.parameters import USUAL
from sumo_reactive.driver.pilot.passages import REGION_MARGIN_M, View, crossings
from sumo_reactive.driver.pilot.rules.region import judgements
from sumo_reactive.driver.pilot.rules.trust import LEAVES_AT, LEAVES_WITHIN_M
from sumo_reactive.driver.view.ahead import passages_ahead

SOUTH_NORTH, SOUTH_WEST = ("from_south", "to_north"), ("from_south", "to_west")
GREEN = {"centre": "GGgrrrGGgrrr"}
Holds = Callable[[float], bool]

ego_at = cache(before)


def turning_left(away: float = 8.0, speed: float = 6.0) -> Situation:
    return ego_at("signalised_left_turns", SOUTH_WEST, away, speed, 1)


def stop(ego: Situation, inside: float | None = None) -> TimeConstraint | None:
    """Where a left turn waits for somebody oncoming; `inside`: its bumper is already so far behind the line."""
    oncoming = ego.other("x", "from_north_0", -25.0, 13.0, ("from_north", "to_south"))
    drive = ego.drive()
    if inside is not None:
        front = ego.line + inside
        drive = drive._replace(ego=on_curve(ego.plan.curve, front, ego.ego.speed), s=front - CAR.front_overhang)
    return ego.step(oncoming, lights=GREEN, drive=drive).completed.stop


@cache
def waiting_place() -> float:
    """How far behind its line a left turn waits, m."""
    found = stop(turning_left())
    assert found is not None
    return found.s - turning_left().line


def test_a_left_turn_waits_where_the_map_says_or_farther_back_before_the_regions_of_those_who_go_first():
    drawn, start = to_its_place(), waiting_place() + REGION_MARGIN_M
    assert waiting_place() == pytest.approx(10.027, abs=0.002)
    assert waiting_place() < drawn < start


def waits_inside(inside: float, speed: float) -> bool:
    found = stop(turning_left(8.0, speed), inside)
    return found is not None and found.s - turning_left().line == pytest.approx(waiting_place(), abs=0.01)


def braking(speed: float) -> float:
    return speed * speed / (2.0 * CAR.service_deceleration)


def left_turner(inside: bool) -> Holds:
    """Whether the ego goes straight on before an oncoming left turner of this speed, 5 m before its line or behind it."""
    ego = ego_at("signalised_left_turns", SOUTH_NORTH, 8.0, 8.0)
    part = ego.graph.connections["from_north_1->to_east_1"].parts[0]
    lane, position = (part, 5.0) if inside else ("from_north_1", -5.0)
    return lambda v: ego.stop(ego.other("x", lane, position, v, ("from_north", "to_east")[inside:]), lights=GREEN) is None


def to_its_place() -> float:
    """How far behind its line an oncoming left turner waits, m."""
    wait = turning_left().graph.connections["from_south_1->to_west_1"].wait_at
    assert wait is not None
    return wait


ROWS: dict[str, tuple[Holds, float, float, float]] = {
    "m inside that leave room to brake": (lambda m: waits_inside(m, 5.0), 1.0, 13.0, waiting_place() - braking(5.0)),
    "m inside of who rolls": (lambda m: waits_inside(m, 1.2), 1.0, 13.0, waiting_place() - braking(1.2)),
    "m/s of who has come a little too far": (lambda v: waits_inside(waiting_place() + 0.5, v), 0.0, 3.0, CREEPING_SPEED),
    "m/s at which a left turner no longer stops at its place": (
        left_turner(False), 5.0, 20.0, (2.0 * USUAL.foe_can_stop_deceleration * (5.0 + to_its_place())) ** 0.5,
    ),
    "m/s at which a left turner inside no longer stops at its place": (
        left_turner(True), 2.0, 12.0, (2.0 * USUAL.foe_can_stop_deceleration * (to_its_place() - 5.0)) ** 0.5,
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", ROWS)
def test_inside_a_junction_the_pilots_word_turns_over_at(name):
    holds, low, high, figure = ROWS[name]
    assert turns_at(holds, low, high) == pytest.approx(figure, abs=0.02)


@pytest.mark.parametrize(
    ("must_yield", "is_yielded_to", "moves_back"), [(True, False, True), (False, False, True), (False, True, False)]
)
def test_a_left_turn_waits_before_those_who_go_first_or_whom_no_rule_makes_wait(must_yield, is_yielded_to, moves_back):
    ego = turning_left()
    snapshot = ego.seen()
    (number, connection, conflicts), *_ = passages_ahead(ego.graph, ego.plan, ego.limits, snapshot.passages)
    drawn = to_its_place()
    met = next(c for c in conflicts if c.must_yield and drawn < c.region.own.start < drawn + REGION_MARGIN_M)
    ahead = ((number, connection, (met._replace(must_yield=must_yield, is_yielded_to=is_yielded_to),)),)
    (way,) = crossings(snapshot, ego.plan, ahead)
    place = met.region.own.start - REGION_MARGIN_M if moves_back else drawn
    assert way.wait_at == pytest.approx(place)


@pytest.mark.parametrize(("gains", "goes_on"), [(0.9 * LEAVES_AT, True), (1.1 * LEAVES_AT, False)])
def test_who_has_come_to_its_place_and_gains_speed_there_is_no_longer_trusted_to_wait(gains, goes_on):
    ego = ego_at("signalised_left_turns", SOUTH_NORTH, 8.0, 8.0)
    part = ego.graph.connections["from_north_1->to_east_1"].parts[0]
    place = to_its_place() - 0.5 * LEAVES_WITHIN_M
    turner = ego.other("x", part, place, 0.5, ("to_east",))._replace(acceleration=gains)
    assert (ego.stop(turner, lights=GREEN) is None) is goes_on


def judged(*users, starts_earlier_by: float = 0.0) -> dict[str, bool]:
    """Whether the ego goes before each oncoming one; the regions of `y` begin so much earlier, m."""
    ego = turning_left()
    snapshot = ego.seen(*users, lights=GREEN)
    ahead = passages_ahead(ego.graph, ego.plan, ego.limits, snapshot.passages)
    way = next(iter(crossings(snapshot, ego.plan, ahead)))
    view = View(snapshot, ego.plan, ego.limits, ahead, (way,))

    def moved(foe):
        region = foe.conflict.region
        own = replace(region.own, start=region.own.start - starts_earlier_by)
        return foe._replace(conflict=foe.conflict._replace(region=replace(region, own=own)))

    foes = tuple(moved(foe) if foe.user.id == "y" else foe for foe in snapshot.foes)
    return {one.foe.user.id: one.passes for one, _ in judgements(way, foes, view, ego.memory)}


def test_who_waits_inside_for_one_does_not_go_before_another_in_whose_region_it_would_stand():
    ego = turning_left()
    near = ego.other("x", "from_north_0", -25.0, 13.0, ("from_north", "to_south"))
    later = ego.other("y", "from_north_0", -90.0, 8.0, ("from_north", "to_south"))
    assert judged(later) == judged(later, starts_earlier_by=4.0) == {"y": True}
    assert judged(near, later) == {"x": False, "y": True}
    assert judged(near, later, starts_earlier_by=4.0) == {"x": False, "y": False}
