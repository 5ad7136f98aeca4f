"""What a step costs besides the control step; timed by `pytest tests/benchmark --benchmark-enable`."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import count

import libsumo
import pytest
from helpers.cars import CAR
from helpers.situations import NETWORKS, graph_of

from sumo_reactive.driver.nouns.plan import NominalPlan
from sumo_reactive.driver.nouns.record import Scene, StepRecord
from sumo_reactive.driver.path.planner import PlanStart, plan
from sumo_reactive.driver.world.road_graph import RoadGraph
from sumo_reactive.driver.world.route import Route
from sumo_reactive.lab.metrics.jury import Jury
from sumo_reactive.sumo.observer import EgoObserver
from sumo_reactive.sumo.sensor import Sensor
from sumo_reactive.sumo.vehicle_type import heading_of, pose_of

EGO, NETWORK, UNTIL_S = "ego", "signalised_left_turns", 25.0


@pytest.fixture(scope="module")
def simulation() -> Iterator[tuple[RoadGraph, NominalPlan]]:
    """The ego's world and plan at `UNTIL_S` in a simulation that stands still there."""
    libsumo.start(["sumo", "-c", str(NETWORKS / NETWORK / f"{NETWORK}.sumocfg"), "--no-warnings", "true"])
    try:
        while libsumo.simulation.getTime() < UNTIL_S:
            libsumo.simulationStep()
        route = tuple(libsumo.vehicle.getRoute(EGO))
        graph, lane = graph_of(NETWORK, route), libsumo.vehicle.getLaneID(EGO)
        x, y = libsumo.vehicle.getPosition(EGO)
        pose = pose_of(x, y, heading_of(libsumo.vehicle.getAngle(EGO)), CAR)
        at = libsumo.vehicle.getLanePosition(EGO) * graph.lanes[lane].scale
        start = PlanStart(pose, libsumo.vehicle.getSpeed(EGO), 0.0, UNTIL_S, lane, at, 0)
        yield graph, plan(graph, Route(route), CAR, start)
    finally:
        libsumo.close()


def test_observing_the_lanes_in_sight(benchmark, simulation):
    graph, nominal = simulation
    traffic = benchmark(EgoObserver(EGO, Sensor(), CAR).observe, graph, nominal, 0.0, 10.0, 0.0)
    assert traffic.users
    assert all(user.id != EGO for user in traffic.users)


def test_judging_a_step(benchmark, simulation):
    graph, nominal = simulation
    traffic = EgoObserver(EGO, Sensor(), CAR).observe(graph, nominal, 0.0, 10.0, 0.0)
    x, y, heading = nominal.curve.at(0.0)
    jury, now = Jury(CAR.length, CAR.width, CAR.wheelbase), count(UNTIL_S)
    benchmark(lambda: jury.see(Scene(_record(next(now), x, y, heading), traffic.users, world=graph)))
    assert "collisions" in jury.figures()


def _record(time: float, x: float, y: float, heading: float) -> StepRecord:
    motion, flags = {"acceleration": 0.0, "steering_angle": 0.0}, {"pilot": 0, "emergency": False}
    return StepRecord(time, x, y, heading, 10.0, "", **motion, **flags, control_us=0.0)
