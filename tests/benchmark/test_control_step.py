"""The control step and its stages before a busy junction; timed by `pytest tests/benchmark --benchmark-enable`."""

from __future__ import annotations

import pytest
from helpers.cars import CAR
from helpers.situations import PERIOD, Situation, before

from sumo_reactive.driver.controller import Controller, Drive
from sumo_reactive.driver.field.executor import execute
from sumo_reactive.driver.nouns.event import Event, EventKind
from sumo_reactive.driver.nouns.snapshot import NEAR_M
from sumo_reactive.driver.nouns.traffic import RoadUser, Traffic
from sumo_reactive.driver.pilot.events import detect
from sumo_reactive.driver.pilot.passages import view_of
from sumo_reactive.driver.pilot.pilot import Style, decide
from sumo_reactive.driver.view.ahead import passages_ahead
from sumo_reactive.driver.view.outlook import outlook
from sumo_reactive.driver.view.perceive import perceive

OTHERS = (
    ("from_west_0", -4.0, 11.0, "to_east"),
    ("from_west_0", -14.0, 11.0, "to_east"),
    ("from_east_0", -3.0, 12.0, "to_west"),
    ("from_east_0", -13.0, 12.0, "to_south"),
    ("from_north_0", -2.0, 3.0, "to_south"),
    ("from_north_0", -9.0, 2.0, "to_south"),
    ("to_east_0", 8.0, 13.0, ""),
    ("to_west_0", 9.0, 12.0, ""),
    ("to_south_0", 15.0, 9.0, ""),
    ("from_south_0", -2.0, 5.0, "to_west"),
)
"""Lane, place on it (m, negative: from its end), speed (m/s) and next edge."""


@pytest.fixture(scope="module")
def junction() -> Situation:
    return before("four_way_priority", ("from_south", "to_west"), away=12.0, speed=6.0)


@pytest.fixture(scope="module")
def traffic(junction: Situation) -> Traffic:
    users = tuple(_car(junction, k, *other) for k, other in enumerate(OTHERS))
    return Traffic(time=junction.time, users=users, lights={})


def _car(junction: Situation, k: int, lane_id: str, place: float, speed: float, then: str) -> RoadUser:
    return junction.other(f"car{k}", lane_id, place, speed, (lane_id[:-2], then) if then else (lane_id[:-2],))


@pytest.fixture(scope="module")
def controller(junction: Situation) -> Controller:
    return Controller(graph=junction.graph, limits=CAR)


@pytest.fixture(scope="module")
def drive(junction: Situation) -> Drive:
    return junction.drive()


def test_a_control_step_before_a_busy_junction(benchmark, controller, traffic, drive):
    step = benchmark(controller.step, traffic, drive, PERIOD)
    pose = drive.ego.pose
    assert all(abs(user.x - pose.x) + abs(user.y - pose.y) < NEAR_M for user in traffic.users)
    assert len(step.snapshot.boxes) == len(OTHERS)
    assert step.snapshot.foes


def test_perceiving(benchmark, controller, traffic, drive):
    snapshot = benchmark(perceive, traffic, drive.ego, drive.plan, controller.graph, CAR, (drive.s, 0.0))
    assert snapshot.on_path


def test_deciding(benchmark, controller, traffic, drive):
    snapshot = controller.step(traffic, drive, PERIOD).snapshot
    ahead = passages_ahead(controller.graph, drive.plan, CAR, snapshot.passages)
    view = outlook(traffic, snapshot, drive.plan, controller.graph, CAR)
    event = (Event(EventKind.NEW_PLAN),)
    completed, _ = benchmark(decide, view_of(snapshot, drive.plan, CAR, ahead), view, event, drive.memory, Style())
    assert completed.stop is not None


def test_detecting_events(benchmark, controller, traffic, drive):
    step = controller.step(traffic, drive, PERIOD)
    ahead, after = passages_ahead(controller.graph, drive.plan, CAR, step.snapshot.passages), step.drive
    found = benchmark(detect, step.snapshot, drive.plan, ahead, after.completed, after.memory, False)
    assert not found


def test_looking_ahead(benchmark, controller, traffic, drive):
    snapshot = controller.step(traffic, drive, PERIOD).snapshot
    assert benchmark(outlook, traffic, snapshot, drive.plan, controller.graph, CAR).forecast.user_ids


def test_executing(benchmark, controller, traffic, drive):
    step = controller.step(traffic, drive, PERIOD)
    execution = benchmark(execute, step.snapshot, step.completed, CAR, PERIOD)
    assert execution == step.execution
