"""How far aside the ego must run to pass somebody, where it may, and when it is past him."""

from __future__ import annotations

from dataclasses import replace

import pytest
from helpers.cars import BODY, CAR
from helpers.situations import before

from sumo_reactive.driver.nouns.forecast import LaneBeside
from sumo_reactive.driver.nouns.plan import Aside
from sumo_reactive.driver.parameters import USUAL
from sumo_reactive.driver.pilot.passed import (
    EDGE_MARGIN_M,
    MOST_PASSED,
    ROLLING_SPEED,
    find,
    is_clear_of,
    is_in_queue,
    lane_in_use,
    lateral_for,
    legal_end,
    passed,
)

EGO = before("blocked_lane", ("eastbound", "eastbound_out"), 300.0, 8.0)
X = EGO.ahead("x", 30.0, 0.0, halted=True)
LANE = 3.2
HALF_BODY, HALF_EGO = 0.5 * BODY.width, 0.5 * CAR.width


def seen(lanes: tuple[LaneBeside, ...], width: float = LANE):
    """The situation behind X with these lanes beside an own lane of some width."""
    situation = EGO.considered(X)
    return situation._replace(outlook=situation.outlook._replace(beside=lanes, lane_width=width))


def beside(lateral: float, *, oncoming: bool = True, starts: float = 0.0, width: float = LANE) -> LaneBeside:
    """A lane whose middle is `lateral` m beside the own one's."""
    (some, *_) = EGO.outlook(X).beside
    return some._replace(lateral=lateral, is_oncoming=oncoming, start=starts, width=width)


def who(situation, **what):
    """X as one to pass, in the middle of the lane."""
    return passed(situation, situation.ahead_of_ego)._replace(left=HALF_BODY, right=-HALF_BODY, **what)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_the_ego_runs_as_far_aside_as_its_body_needs_on_the_side_of_the_lane_that_it_uses(side):
    lane = beside(side * LANE)
    needed = HALF_BODY + USUAL.passing_clearance_m + HALF_EGO
    assert lateral_for(seen((lane,)), who(seen((lane,)))) == (pytest.approx(side * needed), lane)


def test_on_a_lane_of_its_own_direction_the_ego_runs_in_the_middle():
    lane = beside(LANE, oncoming=False)
    assert lateral_for(seen((lane,)), who(seen((lane,)))) == (LANE, lane)


@pytest.mark.parametrize("oncoming", [True, False])
@pytest.mark.parametrize(("more", "is_wide_enough"), [(-0.01, False), (0.01, True)])
def test_a_lane_that_is_too_narrow_is_not_used(oncoming, more, is_wide_enough):
    needed = HALF_BODY + USUAL.passing_clearance_m + HALF_EGO
    lane = beside(1.5, oncoming=oncoming, width=2.0 * (needed - 1.5 + more) + CAR.width)
    found = lateral_for(seen((lane,)), who(seen((lane,))))
    assert (found != (0.0, None)) is is_wide_enough


@pytest.mark.parametrize(("more", "is_wide_enough"), [(-0.01, False), (0.01, True)])
def test_on_a_wide_lane_of_its_own_no_other_is_used(more, is_wide_enough):
    needed = HALF_BODY + USUAL.passing_clearance_m + HALF_EGO
    wide = seen((beside(LANE),), width=2.0 * (needed + EDGE_MARGIN_M + more) + CAR.width)
    assert (lateral_for(wide, who(wide))[1] is None) is is_wide_enough
    without = seen((), width=2.0 * (needed + EDGE_MARGIN_M + more) + CAR.width)
    assert lateral_for(without, who(without)) == (pytest.approx(needed if is_wide_enough else 0.0), None)


def test_without_a_lane_and_with_one_that_begins_later_nobody_is_passed():
    later = beside(LANE, starts=EGO.seen().front + 1.0)
    for lanes in ((), (later,)):
        assert lateral_for(seen(lanes), who(seen(lanes))) == (0.0, None)


def test_two_wheelers_are_given_more_room():
    situation = seen((beside(LANE),))
    bicycle = who(situation, width=0.65)._replace(left=0.3, right=-0.3)
    assert lateral_for(situation, bicycle)[0] == pytest.approx(0.3 + USUAL.two_wheeler_clearance_m + HALF_EGO)


def test_who_leaves_the_ego_its_way_is_passed_without_running_aside():
    situation = seen((beside(LANE),))
    assert lateral_for(situation, who(situation)._replace(left=-5.0, right=-7.0)) == (0.0, None)


def test_who_is_being_passed_is_found_where_he_is():
    situation = EGO.considered(X)
    found, ahead = find(situation, "x"), passed(situation, situation.ahead_of_ego)
    assert found is not None
    assert (found.rear, found.front) == pytest.approx((ahead.rear, ahead.front), abs=0.3)
    assert (found.left, found.right) == pytest.approx((HALF_BODY, -HALF_BODY), abs=0.05)
    assert (found.user_ids, found.width, found.is_halted) == (("x",), BODY.width, True)
    assert find(situation, "nobody") is None


@pytest.mark.parametrize(("back", "off"), [(1e4, 3.0), (0.0, 0.0)])
def test_where_the_curve_leads_aside_he_is_measured_from_the_lane(back, off):
    """C runs 3 m to the left of it until it leads back."""
    situation = EGO.considered(X)
    aside = Aside(3.0, back, back + 1.0)
    found = find(situation._replace(plan=replace(situation.plan, aside=aside)), "x")
    assert found is not None
    assert (found.left, found.right) == pytest.approx((HALF_BODY + off, off - HALF_BODY), abs=0.05)


@pytest.mark.parametrize(("ahead", "is_clear"), [(-0.1, False), (0.1, True)])
def test_the_ego_is_clear_of_him_when_its_rear_is_a_gap_ahead(ahead, is_clear):
    situation = EGO.considered(X)
    x = who(situation)
    front = situation.snapshot.front - CAR.length - x.gap(USUAL) - ahead
    assert bool(is_clear_of(situation, x._replace(front=front))) is is_clear


@pytest.mark.parametrize(("lateral", "is_used"), [(0.69, False), (0.71, True), (-0.71, True)])
def test_a_way_beside_the_middle_uses_another_lane_once_the_body_is_over_the_line(lateral, is_used):
    lane = beside(LANE)
    assert lane_in_use(seen((lane,)), lateral) == (lane if is_used else None)
    assert lane_in_use(seen(()), lateral) is None


def test_passing_ends_before_a_stop_and_where_the_lane_does():
    situation = EGO.considered(X)
    plain = legal_end(situation, who(situation), None)
    lane = beside(LANE)._replace(end=EGO.seen().front + 60.0)
    assert legal_end(situation, who(situation), lane) == lane.end < plain
    nearer = replace(situation.plan, goal=EGO.seen().front + 50.0)
    assert legal_end(situation._replace(plan=nearer), who(situation), lane) == nearer.goal


SLOW, NEAR = 2.0, USUAL.following_m + USUAL.following_s * 2.0


@pytest.mark.parametrize(
    ("gaps", "speeds", "is_queue"),
    [
        ((), (), False),
        ((3.0,) * (MOST_PASSED - 1), (SLOW,) * (MOST_PASSED - 1), False),
        ((3.0,) * MOST_PASSED, (SLOW,) * MOST_PASSED, True),
        ((3.0, 3.0), (SLOW, ROLLING_SPEED), True),
        ((3.0, 3.0), (SLOW, ROLLING_SPEED + 0.1), False),
        ((3.0, NEAR + 0.5), (SLOW, 0.0), False),
        ((3.0, NEAR - 0.5), (SLOW, 0.0), True),
        ((3.0, 3.0, 3.0), (SLOW, 12.0, 0.0), False),
        ((14.0,) * 3, (SLOW,) * 3, True),  # farther than the ego sees
    ],
)
def test_who_is_slow_because_of_those_before_him_is_in_a_queue(gaps, speeds, is_queue):
    """Each of those before X drives so far before the one behind it, m."""
    users, at = [EGO.ahead("x", 10.0, SLOW)], 10.0
    for k, (gap, speed) in enumerate(zip(gaps, speeds, strict=True)):
        at += BODY.length + gap
        users.append(EGO.ahead(f"q{k}", at, speed))
    situation = EGO.considered(*users, sight=600.0)
    assert is_in_queue(situation, passed(situation, situation.ahead_of_ego)) is is_queue
