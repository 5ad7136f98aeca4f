"""Who is asked by another ego to let it in falls back behind it, gently, for as long as he is asked."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import pytest
from helpers.cars import CAR
from helpers.situations import PERIOD, Situation, before

from sumo_reactive.driver.controller import Controller, Step
from sumo_reactive.driver.nouns.decision import Reason
from sumo_reactive.driver.nouns.event import EventKind
from sumo_reactive.driver.nouns.traffic import Traffic

ROAD = ("road_before_exit", "road_after_exit")


@pytest.fixture(scope="module")
def ego() -> Situation:
    """The ego on a straight road of three lanes, at the speed of the road."""
    return before("multi_lane_road", ROAD, 380.0, 15.0)


BESIDE = "road_before_exit_1"


def driven_beside(ego: Situation, ahead: float, asks: float, lane: str = BESIDE, seconds: float = 12.0) -> list[Step]:
    """The steps of an ego beside x, whose front is `ahead` m before its own and who asks to be let in from 1 s on for so
    long."""
    first, controller = ego.other("x", lane, 15.94 + ahead, 15.0, ROAD), Controller(graph=ego.graph, limits=ego.limits)
    steps, drive = [], ego.drive()
    for k in range(round(seconds / PERIOD)):
        past = k * PERIOD
        asker = "x" if 1.0 <= past < 1.0 + asks else ""
        traffic = replace(Traffic(time=ego.time + past, users=(ego.later(first, past),), lights={}), asker=asker)
        steps.append(controller.step(traffic, drive, PERIOD))
        drive = steps[-1].drive
    return steps


def test_who_is_asked_falls_back_gently_to_its_usual_distance(ego):
    alone, steps = driven_beside(ego, 3.0, 0.0), driven_beside(ego, 3.0, 11.0)
    assert all(step.snapshot.asker is None for step in alone)
    assert min(step.drive.ego.speed for step in alone) > 14.9
    speeds = [step.drive.ego.speed for step in steps]
    assert min((b - a) / PERIOD for a, b in pairwise(speeds)) > -CAR.comfort_deceleration - 0.1
    gap = 3.0 + 15.0 * 12.0 - (steps[-1].drive.s - steps[0].snapshot.s) - 4.7
    assert gap > 0.9 * (CAR.standstill_gap + CAR.time_headway * 15.0)


def test_it_says_whom_it_lets_in_and_goes_on_when_it_is_asked_no_more(ego):
    steps = driven_beside(ego, 3.0, 3.0)
    events = [(event, step.snapshot.time) for step in steps for event in step.completed.events]
    asked = [(event.cause, time) for event, time in events if event.kind is EventKind.ASKED]
    assert [cause for cause, _ in asked] == ["x", ""]
    assert asked[1][1] - asked[0][1] == pytest.approx(3.0, abs=0.01)
    lets_in = [one for step in steps for one in step.completed.decisions if one.reason is Reason.LETS_IN]
    assert len(lets_in) * PERIOD == pytest.approx(3.0, abs=0.01)
    assert {(one.cause, one.passes) for one in lets_in} == {("x", True)}
    assert steps[-1].drive.ego.speed > min(step.drive.ego.speed for step in steps) + 1.0


def test_who_is_on_another_road_is_not_let_in(ego):
    steps = driven_beside(ego, 3.0, 11.0, lane="road_after_exit_0")
    assert all(step.snapshot.asker is None for step in steps)
