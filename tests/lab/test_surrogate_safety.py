"""Surrogate safety measures: each against a case computed by hand, and who counts as ahead, behind or beside."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scenes import drive, record, user

from sumo_reactive.lab.metrics.jury import Jury
from sumo_reactive.lab.metrics.safety.deceleration import drac, mdrac, safety_time_deceleration
from sumo_reactive.lab.metrics.safety.following import (
    headways,
    modified_ttc,
    short_share,
    time_exposed,
    time_integrated,
    ttc_along,
)
from sumo_reactive.lab.metrics.safety.rss import lateral_distance, longitudinal_distance

LENGTH, WIDTH = 5.0, 1.8


def only(found):
    """Return the one value of an array."""
    (value,) = found
    return float(value)


def one(value):
    return np.array([value])


def judged(ego, others, steps=11):
    """Return the figures of a drive."""
    jury = Jury(LENGTH, WIDTH, 3.0)
    drive(jury, ego, others, steps)
    return jury.figures()


def test_ttc_along_the_way_is_gap_over_closing_speed():
    assert only(ttc_along(one(30.0), one(15.0), one(5.0))) == 3.0
    assert only(ttc_along(one(30.0), one(5.0), one(5.0))) == math.inf


@pytest.mark.parametrize(
    ("gap", "closing", "faster", "time"),
    [
        (30.0, 10.0, 0.0, 3.0),
        (28.0, 10.0, 4.0, 2.0),  # 10·2 + ½·4·2²
        (24.0, 0.0, 3.0, 4.0),  # ½·3·4²
        (8.0, -2.0, 3.0, 3.07),  # −2 t + 1.5 t² = 8
        (30.0, 10.0, -2.0, math.inf),  # 10 t − t² reaches 25 at most
        (24.0, 10.0, -2.0, 4.0),  # 10·4 − 16
        (30.0, -1.0, 0.0, math.inf),
        (30.0, 10.0, math.nan, 3.0),
    ],
)
def test_modified_ttc_is_the_first_time_at_which_the_gap_is_used_up(gap, closing, faster, time):
    assert only(modified_ttc(one(gap), one(closing), one(faster))) == pytest.approx(time, abs=0.01)


@given(st.floats(0.1, 100.0), st.floats(-20.0, 20.0), st.floats(-5.0, 5.0))
def test_before_the_modified_ttc_the_gap_is_open(gap, closing, faster):
    found = only(modified_ttc(one(gap), one(closing), one(faster)))
    before = np.linspace(0.0, min(found, 60.0), 50, endpoint=False)
    assert (closing * before + 0.5 * faster * before**2 <= gap * (1.0 + 1e-6)).all()


def test_drac_mdrac_and_deceleration_to_safety_time_are_as_computed_by_hand():
    gap, closing, front = one(50.0), one(10.0), one(5.0)
    assert only(drac(gap, closing)) == 1.0  # 100 / 100
    assert only(mdrac(gap, closing)) == 1.25  # 10 / (2 (5 − 1))
    assert only(safety_time_deceleration(gap, closing, front)) == pytest.approx(100.0 / 90.0)


def test_a_gap_that_does_not_close_needs_no_deceleration_and_one_that_is_used_up_no_finite_one():
    assert only(drac(one(5.0), one(-1.0))) == only(mdrac(one(5.0), one(0.0))) == 0.0
    assert only(drac(one(0.0), one(1.0))) == only(mdrac(one(10.0), one(10.0))) == 99.0
    assert math.isnan(only(safety_time_deceleration(one(5.0), one(1.0), one(5.0))))


def test_a_headway_is_from_front_to_front_over_the_followers_speed():
    found = headways(np.array([30.0, 9.0, 10.0]), np.array([15.0, 10.0, 0.0]))
    assert found[:2].tolist() == [2.0, 0.9]
    assert math.isnan(found[2])
    assert short_share(found, np.array([0.3, 0.1, 5.0]), 0.8) == pytest.approx(0.125)
    assert short_share(found[2:], np.array([5.0]), 0.0) is None


def test_exposed_and_integrated_time_are_sums_below_three_seconds():
    times, durations = np.array([4.0, 2.5, 1.0, math.inf]), np.array([0.1, 0.1, 0.2, 0.1])
    assert time_exposed(times, durations) == pytest.approx(0.3)
    assert time_integrated(times, durations) == pytest.approx(0.5 * 0.1 + 2.0 * 0.2)


def test_rss_asks_for_the_distances_of_its_definitions():
    """Ahead 14 + 1.75 + 17.5²/8 − 10²/16; beside 0.1 + (0.1 + 0.2²/1.6) + (0.4 + 0.4²/1.6), more for who comes nearer."""
    assert only(longitudinal_distance(one(14.0), one(10.0), 1.0)) == pytest.approx(14.0 + 1.75 + 38.28125 - 6.25)
    assert only(longitudinal_distance(one(0.0), one(20.0), 1.0)) == 0.0
    assert only(lateral_distance(one(0.0))) == pytest.approx(0.1 + 0.125 + 0.5)
    assert only(lateral_distance(one(0.5))) == pytest.approx(0.1 + 0.125 + 0.5 * 1.4 * 2.0 + 0.81 / 1.6)
    assert only(lateral_distance(one(-2.0))) == pytest.approx(0.1)


def test_the_figures_of_a_trip_behind_another_are_those_of_its_worst_step():
    """The ego at 15 m/s nears one at 5 m/s: the gap of 50 m closes to 40 m within a second."""
    figures = judged(lambda t: record(t, x=15.0 * t, speed=15.0), lambda t: [user(x=55.0 + 5.0 * t, speed=5.0)])
    safe = 15.0 + 1.75 + 18.5**2 / 8.0 - 25.0 / 16.0
    assert figures["max_drac_m_s2"] == pytest.approx(100.0 / 80.0, abs=1e-3)
    assert figures["max_mdrac_m_s2"] == pytest.approx(10.0 / (2.0 * 3.0), abs=1e-3)
    assert figures["max_dst_m_s2"] == pytest.approx(100.0 / 70.0, abs=1e-3)
    assert figures["min_modified_ttc_s"] == pytest.approx(4.0, abs=1e-3)
    assert figures["min_time_headway_s"] == pytest.approx(3.0, abs=1e-3)
    assert figures["short_headway_share"] == figures["time_exposed_ttc_s"] == 0.0
    assert figures["min_rss_longitudinal_margin_m"] == pytest.approx(40.0 - safe, abs=1e-3)
    assert figures["rss_violation_s"] == pytest.approx(1.0)
    assert figures["max_drac_of_follower_m_s2"] == 0.0


def test_what_the_ego_asks_of_its_follower_is_told_apart():
    figures = judged(lambda t: record(t, x=5.0 * t, speed=5.0), lambda t: [user(x=-55.0 + 15.0 * t, speed=15.0)])
    assert figures["max_drac_of_follower_m_s2"] == pytest.approx(100.0 / 80.0, abs=1e-3)
    assert (figures["max_drac_m_s2"], figures["min_time_headway_s"]) == (0.0, None)


def test_only_the_nearest_ahead_is_followed():
    others = [user("near", x=30.0, speed=10.0), user("far", x=60.0, speed=0.0)]
    figures = judged(lambda t: record(t, x=0.0, speed=10.0), lambda t: others, 2)
    assert figures["max_drac_m_s2"] == 0.0


@pytest.mark.parametrize(
    ("other", "is_followed"),
    [
        (user(x=30.0, speed=5.0), True),
        (user(x=30.0, y=1.7, speed=5.0), True),
        (user(x=30.0, y=3.2, speed=5.0), False),  # on the next lane
        (user(x=30.0, heading=math.pi, speed=5.0), False),  # oncoming
        (user(x=30.0, heading=0.5 * math.pi, speed=5.0), False),  # crossing
    ],
)
def test_who_is_ahead_in_the_egos_way_and_goes_that_way_is_followed(other, is_followed):
    figures = judged(lambda t: record(t, x=0.0, speed=10.0), lambda t: [other], 2)
    assert (figures["min_time_headway_s"] is not None) is is_followed


def test_a_gap_is_measured_along_the_way_that_the_ego_drives_round_a_bend():
    """A circle of 20 m radius: the other's front is a quarter of it, 31.4 m, ahead of the ego's.

    When the ego's own way ends, where it would have driven is not known.
    """
    radius, speed = 20.0, 5.0

    def place(angle):
        return {"x": radius * math.sin(angle), "y": radius * (1.0 - math.cos(angle)), "heading": angle}

    figures = judged(
        lambda t: record(t, **place(speed * t / radius), speed=speed),
        lambda t: [user(**place(0.5 * math.pi + speed * t / radius), speed=speed)] if t < 3.5 else [], 100,
    )  # fmt: skip
    assert figures["min_time_headway_s"] == pytest.approx(0.5 * math.pi * radius / speed, rel=0.01)


@pytest.mark.parametrize(("room", "violation"), [(0.6, 1.0), (0.8, 0.0)])
def test_who_is_beside_needs_the_room_that_rss_asks_for(room, violation):
    beside = [user(y=WIDTH + room, speed=10.0)]
    figures = judged(lambda t: record(t, speed=10.0), lambda t: beside)
    assert figures["min_rss_lateral_margin_m"] == pytest.approx(room - 0.725, abs=1e-3)
    assert figures["rss_violation_s"] == pytest.approx(violation)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_who_comes_nearer_from_the_side_needs_more_room_than_who_goes_away(side):
    """2 m to the side, at a right angle's tenth and 10 m/s: his reach of 2 s grows from 0.5 m, or is nought."""
    margins = []
    for turn in (-0.1, 0.1):
        beside = user(y=side * (WIDTH + 2.0), heading=side * turn, speed=10.0)
        figures = judged(lambda t: record(t, speed=10.0), lambda t, beside=beside: [beside])
        margins.append(figures["min_rss_lateral_margin_m"])
    assert margins[0] < 0.0 < 1.3 < margins[1]


def test_while_the_ego_stands_rss_is_not_violated_and_has_no_margin():
    figures = judged(lambda t: record(t), lambda t: [user("ahead", x=6.0), user("beside", y=WIDTH + 0.1)])
    margins = figures["min_rss_longitudinal_margin_m"], figures["min_rss_lateral_margin_m"]
    assert (figures["rss_violation_s"], *margins) == (0.0, None, None)


def test_a_step_with_two_that_are_too_near_counts_once():
    others = [user("ahead", x=10.0, speed=10.0), user("beside", y=WIDTH + 0.1, speed=10.0)]
    assert judged(lambda t: record(t, speed=10.0), lambda t: others)["rss_violation_s"] == pytest.approx(1.0)


def test_a_modified_ttc_of_ten_seconds_or_more_is_none():
    figures = judged(lambda t: record(t, speed=10.0), lambda t: [user(x=75.0, speed=5.0)])
    assert figures["min_modified_ttc_s"] is None


def test_who_meets_nobody_comes_near_nobody_and_need_not_brake():
    figures = judged(lambda t: record(t, x=10.0 * t, speed=10.0), lambda t: [])
    nearest = ("min_modified_ttc_s", "min_time_headway_s", "min_rss_longitudinal_margin_m", "min_rss_lateral_margin_m")
    assert {figures[name] for name in nearest} == {None}
    most = ("max_drac_m_s2", "max_mdrac_m_s2", "max_dst_m_s2", "max_drac_of_follower_m_s2", "short_headway_share")
    assert {figures[name] for name in (*most, "rss_violation_s", "time_exposed_ttc_s", "time_integrated_ttc_s2")} == {0.0}


def test_a_share_of_short_headways_is_of_the_time_in_which_the_ego_moves():
    """Behind another at 0.8 s for half of a second, then alone, then standing."""
    others = lambda t: [user(x=8.0, speed=10.0)] if t < 0.55 else []  # noqa: E731
    figures = judged(lambda t: record(t, speed=10.0 if t < 1.05 else 0.0), others, 31)
    assert (figures["min_time_headway_s"], figures["short_headway_share"]) == (0.8, 0.5)
