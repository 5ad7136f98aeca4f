"""Which gap on the other lane is enough for whoever comes behind."""

import pytest

from sumo_reactive.parameters import EASY_STOP_DECELERATION, FOLLOWER_STANDSTILL_GAP_M, HARD_STOP_DECELERATION
from sumo_reactive.pilot.gaps import gap_for_follower


@pytest.mark.parametrize("speed", [8.0, 14.0, 28.0])
@pytest.mark.parametrize("slower", [0.0, 3.0, 8.0])
def test_a_follower_need_not_brake_hard_for_the_ego(speed, slower):
    """SUMO's cars brake 1.2 times as hard as they must to stop behind somebody who brakes with 4.5 m/s²."""
    ahead = speed - slower
    gap = gap_for_follower(speed, ahead, 0.15, HARD_STOP_DECELERATION) - FOLLOWER_STANDSTILL_GAP_M
    assert 1.2 * speed * speed / (2.0 * (gap + ahead * ahead / 9.0)) < 4.6


def test_a_slower_ego_needs_a_longer_gap():
    gaps = [gap_for_follower(20.0, ahead, 0.8, EASY_STOP_DECELERATION) for ahead in (20.0, 15.0, 5.0)]
    assert gaps == sorted(gaps)
    assert gaps[0] == pytest.approx(FOLLOWER_STANDSTILL_GAP_M + 16.2, abs=0.5)


def test_a_follower_that_stands_or_falls_behind_needs_none():
    assert gap_for_follower(0.0, 0.0, 0.8, EASY_STOP_DECELERATION) == 0.0
    assert gap_for_follower(5.0, 15.0, 0.8, EASY_STOP_DECELERATION) == 0.0
