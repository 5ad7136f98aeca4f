"""Passing others over whole runs: oncoming traffic at several seeds; bodies that block the lane, with room and without."""

from __future__ import annotations

import subprocess
from dataclasses import replace
from pathlib import Path

import libsumo
import pytest
import shapely
from sumolib import checkBinary

from sumo_reactive.driver.geometry.footprint import Footprint
from sumo_reactive.driver.nouns.decision import Instruction, Reason
from sumo_reactive.driver.nouns.record import Scene
from sumo_reactive.lab.result import TrialResult
from sumo_reactive.lab.scenario import Scenario, load_scenario
from sumo_reactive.lab.simulation import run_trial

ROOT = Path(__file__).resolve().parents[2]
LENGTH, WIDTH = 4.7, 1.8
SEEDS = (2, 5, 17)
HARD_BRAKING = -3.0

NODES = '<nodes><node id="a" x="0" y="0"/><node id="b" x="320" y="0"/></nodes>'
ROAD = '<edges><edge id="ab" from="a" to="b" numLanes="{lanes}" speed="13.9"/></edges>'
CAR = '<vType id="car" length="4.7" width="1.8"/>'
STOP = '<stop lane="ab_0" endPos="160" duration="10000"/>'
PARKED = f'<vehicle id="parked" type="car" depart="0" departPos="150"><route edges="ab"/>{STOP}</vehicle>'
STOPPING = f'<vehicle id="parked" type="car" depart="0" departPos="10" departSpeed="5"><route edges="ab"/>{STOP}</vehicle>'
EGO = '<vehicle id="ego" type="car" depart="{depart}" departLane="0"><route edges="ab"/></vehicle>'


class Witness:
    """Sees a run: what the ego was told, whom it touched, how hard those braked before whom it or its stand-in was."""

    def __init__(self) -> None:
        self.scenes: list[Scene] = []
        self.touched: set[str] = set()
        self.forced: list[tuple[str, float]] = []
        self._speeds: dict[str, float] = {}

    def __call__(self, scene: Scene) -> None:
        self.scenes.append(scene)
        step = scene.step
        ego = Footprint(step.x, step.y, step.heading, LENGTH, WIDTH)
        for user in scene.users:
            body = Footprint(user.x, user.y, user.heading, user.body.length, user.body.width)
            if shapely.intersects(shapely.polygons(ego.corners()), shapely.polygons(body.corners())):
                self.touched.add(user.id)
            braking = (user.speed - self._speeds.get(user.id, user.speed)) / libsumo.simulation.getDeltaT()
            if braking < HARD_BRAKING and not user.id.startswith("polygon:") and self._is_led(user.id):
                self.forced.append((user.id, braking))
        self._speeds = {user.id: user.speed for user in scene.users}

    def _is_led(self, user_id: str) -> bool:
        leader = libsumo.vehicle.getLeader(user_id, 200.0)
        return leader is not None and (leader[0] == "ego" or leader[0].startswith("reactive.ghost."))

    @property
    def instructions(self) -> set[str]:
        return {scene.step.instruction for scene in self.scenes}


def road(folder: Path, lanes: int, *vehicles: str) -> Scenario:
    """Return a scenario on a one-way road of 320 m."""
    (folder / "r.nod.xml").write_text(NODES)
    (folder / "r.edg.xml").write_text(ROAD.format(lanes=lanes))
    (folder / "r.rou.xml").write_text(f"<routes>{CAR}{''.join(vehicles)}</routes>")
    command = [checkBinary("netconvert"), "-n", "r.nod.xml", "-e", "r.edg.xml", "-o", "r.net.xml"]
    subprocess.run(command, check=True, capture_output=True, cwd=folder)
    files = '<net-file value="r.net.xml"/><route-files value="r.rou.xml"/>'
    (folder / "r.sumocfg").write_text(f"<configuration><input>{files}</input></configuration>")
    return replace(load_scenario(folder / "r.sumocfg"), ego="ego", until_s=120.0)


def driven(scenario: Scenario) -> tuple[TrialResult, Witness]:
    witness = Witness()
    return run_trial(scenario, observer=witness), witness


@pytest.mark.parametrize("seed", SEEDS)
def test_the_ego_overtakes_between_oncoming_cars_and_forces_none(seed):
    result, witness = driven(replace(load_scenario(ROOT / "scenarios" / "country_road.toml"), seed=seed))
    assert result.arrived, result.verdict
    assert Instruction.OVERTAKE.value in witness.instructions
    assert (witness.touched, witness.forced) == (set(), [])


def test_a_parked_car_is_passed_on_the_next_lane(tmp_path):
    result, witness = driven(road(tmp_path, 2, PARKED, EGO.format(depart=5)))
    assert result.arrived, result.verdict
    assert Instruction.OVERTAKE.value in witness.instructions
    assert not witness.touched


def test_an_ego_that_stands_too_near_behind_a_parked_car_backs_up_and_passes(tmp_path):
    result, witness = driven(road(tmp_path, 2, STOPPING, EGO.format(depart=1.2)))
    assert result.arrived, result.verdict
    assert {Instruction.BACK_UP.value, Instruction.OVERTAKE.value} <= witness.instructions
    assert not witness.touched


def test_without_room_the_ego_says_who_blocks_it(tmp_path):
    result, witness = driven(road(tmp_path, 1, PARKED, EGO.format(depart=5)))
    assert not result.arrived
    last = witness.scenes[-1].step
    assert (Reason.BLOCKED, "parked") in {(decision.reason, decision.cause) for decision in last.decisions}
    assert last.speed < 0.01
    assert not witness.touched
