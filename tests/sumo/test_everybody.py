"""Everybody within sight is seen in every step, though who is far away is not looked at in each."""

import math
from itertools import pairwise
from pathlib import Path

import libsumo
import pytest

from sumo_reactive.sumo.everybody import Everybody

CITY = Path(__file__).parents[2] / "networks" / "city_grid" / "city_grid.sumocfg"
REACH_M = 150.0


@pytest.fixture
def city():
    """A city that runs."""
    libsumo.start(["sumo", "-c", str(CITY), "--no-step-log", "--no-warnings", "--seed", "42", "--step-length", "0.1"])
    yield
    libsumo.close()


def near(ego, x, y):
    """Return who is within reach of a place by a look at all."""
    found = set()
    for domain in (libsumo.vehicle, libsumo.person):
        found |= {name for name in domain.getIDList() if math.dist(domain.getPosition(name), (x, y)) < REACH_M}
    return found - {ego}


def driven(steps, looks=lambda k: True):
    """Follow the first car; yield who was seen and who was there."""
    everybody, ego = Everybody(), ""
    for k in range(steps):
        libsumo.simulationStep()
        ego = ego if ego in libsumo.vehicle.getIDList() else next(iter(libsumo.vehicle.getIDList()), "")
        if ego and looks(k):
            x, y = libsumo.vehicle.getPosition(ego)
            yield everybody.within(REACH_M, ego, x, y), near(ego, x, y)


def test_nobody_who_comes_near_leaves_or_departs_is_missed(city):
    seen = [({one.id for one in some}, there) for some, there in driven(900)]
    assert all(some == there for some, there in seen)
    came = [there - before for (_, before), (_, there) in pairwise(seen)]
    assert sum(map(len, came)) > 20


def test_who_was_not_asked_for_a_while_still_sees_everybody(city):
    assert all({one.id for one in some} == there for some, there in driven(600, lambda k: k % 7 == 0))


def test_who_is_removed_is_not_seen_any_more(city):
    everybody = Everybody()
    for _ in range(300):
        libsumo.simulationStep()
    first = libsumo.vehicle.getIDList()[0]
    x, y = libsumo.vehicle.getPosition(first)
    before = {one.id for one in everybody.within(REACH_M, "", x, y)}
    assert first in before
    libsumo.vehicle.remove(first)
    libsumo.simulationStep()
    assert {one.id for one in everybody.within(REACH_M, "", x, y)} == near("", x, y)


def test_who_is_seen_is_told_as_sumo_has_him(city):
    ((some, _),) = list(driven(400))[-1:]
    assert some
    for one in some:
        assert (one.x, one.y) == libsumo.vehicle.getPosition(one.id)
        assert one.heading == pytest.approx(math.radians(90.0 - libsumo.vehicle.getAngle(one.id)))
        assert (one.speed, one.signals) == (libsumo.vehicle.getSpeed(one.id), libsumo.vehicle.getSignals(one.id))
        assert (one.length, one.width) == (libsumo.vehicle.getLength(one.id), libsumo.vehicle.getWidth(one.id))
