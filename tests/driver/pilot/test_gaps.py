"""Times at a region, worked out by hand."""

import pytest

from sumo_reactive.driver.pilot.gaps import Passing, stopping_behind

OWN = Passing(arrival=1.0, clearance=3.0, merged=2.0, speed=10.0)


def test_who_stops_far_behind_a_region_leaves_it_as_fast_as_others():
    assert stopping_behind(OWN, to_clear=30.0, speed=10.0, to_stop=60.0) == OWN


def test_who_stops_just_behind_a_region_leaves_it_later():
    """From 10 m/s with 2 m/s² it begins to brake 25 m before its stop, and has 2 m/s left 1 m before it."""
    own = stopping_behind(OWN, to_clear=29.0, speed=10.0, to_stop=30.0)
    assert own.clearance == pytest.approx(5.0 / 10.0 + (10.0 - 2.0) / 2.0)
    assert own._replace(clearance=3.0) == OWN


def test_who_must_brake_harder_to_stop_behind_it_does_so():
    """From 10 m/s it stops within 12.5 m with 4 m/s², and has 4 m/s left 2 m before its stop."""
    own = stopping_behind(OWN._replace(clearance=1.1), to_clear=10.5, speed=10.0, to_stop=12.5)
    assert own.clearance == pytest.approx((10.0 - 4.0) / 4.0)


def test_who_starts_from_standstill_need_not_brake_before_it_has_left():
    assert stopping_behind(OWN, to_clear=14.0, speed=0.0, to_stop=15.0) == OWN
