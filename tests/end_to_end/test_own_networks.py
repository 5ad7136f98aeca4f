"""The ego drives each of the project's own networks to its goal: judged here from real SUMO and the scenes alone."""

from __future__ import annotations

import json
import math
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache
from itertools import groupby, pairwise
from pathlib import Path

import numpy as np
import pytest
import shapely
from helpers.priority import Priority, Rules
from helpers.tools import tool
from helpers.witness import RED, Witness

from sumo_reactive.driver.geometry.footprint import Footprint
from sumo_reactive.driver.nouns.decision import Instruction
from sumo_reactive.driver.nouns.record import Scene, StepRecord
from sumo_reactive.driver.parameters import Profile
from sumo_reactive.lab.result import TrialResult
from sumo_reactive.lab.scenario import load_scenario
from sumo_reactive.lab.simulation import run_trial

ROOT = Path(__file__).resolve().parents[2]
DIGESTS = tool("digests")
CHECKED_IN = json.loads(DIGESTS.OWN.read_text(encoding="utf-8"))
NETWORKS = sorted(folder.name for folder in (ROOT / "networks").iterdir() if folder.name != "city_grid")
LENGTH, WIDTH = 4.7, 1.8
"""The ego's, in every network's routes."""
KERB_M = 0.3
"""A body may reach this far over the drawn edge of the road: half of what separates a car from its lane's border."""
DEFAULT_LANE_WIDTH_M = 3.2
BESIDE_ITS_LANE = {Instruction.OVERTAKE.value, Instruction.RETURN.value, Instruction.FALL_BACK.value}


@dataclass(frozen=True, eq=False)
class Run:
    result: TrialResult
    scenes: tuple[Scene, ...]
    witness: Witness
    priority: Priority

    def boxes(self) -> Iterator[tuple[StepRecord, Footprint]]:
        for scene in self.scenes:
            step = scene.step
            yield step, Footprint(step.x, step.y, step.heading, LENGTH, WIDTH)


@cache
def run(network: str, step_length: float | None = None, profile: Profile = Profile.DEFAULT) -> Run:
    """Drive the network's scenario once and keep every scene."""
    scenes: list[Scene] = []
    witness, priority = Witness(), Priority(Rules(net_of(network)))

    def see(scene: Scene) -> None:
        scenes.append(scene)
        witness()
        priority()

    scenario = replace(load_scenario(ROOT / "scenarios" / f"{network}.toml"), profile=profile)
    if step_length is not None:
        scenario = replace(scenario, step_length_s=step_length)
    return Run(run_trial(scenario, observer=see), tuple(scenes), witness, priority)


def net_of(network: str) -> Path:
    return ROOT / "networks" / network / f"{network}.net.xml"


def points(shape: str) -> np.ndarray:
    return np.array([[float(n) for n in point.split(",")[:2]] for point in shape.split()])


@cache
def road_surface(network: str) -> shapely.Geometry:
    """All lanes and junctions of a network as SUMO draws them, with a narrow margin."""
    root = ET.parse(net_of(network)).getroot()
    parts = [
        shapely.LineString(points(lane.attrib["shape"])).buffer(
            0.5 * float(lane.get("width", DEFAULT_LANE_WIDTH_M)), cap_style="flat"
        )
        for lane in root.iter("lane")
    ]
    outlines = [points(junction.attrib["shape"]) for junction in root.iter("junction") if junction.get("shape")]
    parts += [shapely.Polygon(outline).buffer(0.0) for outline in outlines if len(outline) > 2]
    surface = shapely.union_all(parts).buffer(KERB_M)
    shapely.prepare(surface)
    return surface


def touched(run: Run) -> set[str]:
    """Ids of all whose box the ego's has overlapped."""
    found: set[str] = set()
    for scene, (_, ego) in zip(run.scenes, run.boxes(), strict=True):
        for user in scene.users:
            body = Footprint(user.x, user.y, user.heading, user.body.length, user.body.width)
            if shapely.intersects(shapely.polygons(ego.corners()), shapely.polygons(body.corners())):
                found.add(user.id)
    return found


each_network = pytest.mark.parametrize("network", NETWORKS)


@each_network
def test_the_ego_arrives(network):
    result = run(network).result
    assert result.arrived, result.verdict
    assert result.ego == "ego"


@each_network
def test_the_ego_touches_nobody(network):
    assert not touched(run(network))
    assert not run(network).witness.touched


@each_network
def test_the_ego_crosses_no_line_on_red(network):
    """By SUMO's lights, before the step and in it, where SUMO has the ego cross the line; the judge says the same."""
    assert [(time, letters) for time, letters in run(network).witness.lights if letters in RED] == []
    assert run(network).result.figures["red_lights_run"] == 0


@each_network
def test_the_ego_never_leaves_the_road(network):
    """All but the last step, which may end behind the goal, where the network ends too."""
    surface = road_surface(network)
    boxes = list(run(network).boxes())[:-1]
    assert not [step.time for step, ego in boxes if not surface.contains(shapely.Polygon(ego.corners()))]


@each_network
def test_sumo_maps_the_ego_to_a_lane_unless_it_passes_somebody(network):
    """Over the oncoming lane it is on no lane of its route."""
    unmapped = [step for step, _ in run(network).boxes() if not step.lane_id]
    assert {step.instruction for step in unmapped} <= BESIDE_ITS_LANE


@each_network
def test_the_ego_moves_as_a_car_can(network):
    """Between two steps neither place nor heading jumps, and no command exceeds what the car can do."""
    steps = [scene.step for scene in run(network).scenes]
    for a, b in pairwise(steps):
        turn = abs(math.remainder(b.heading - a.heading, 2.0 * math.pi))
        assert math.hypot(b.x - a.x, b.y - a.y) <= max(a.speed, b.speed) * (b.time - a.time) * 1.4 + 1e-6
        assert turn <= max(a.speed, b.speed) * (b.time - a.time) * 0.25 + 1e-6
        assert -8.0 - 1e-6 <= b.command_acceleration <= 2.6 + 1e-6


@each_network
def test_the_ego_takes_nobodys_right_of_way(network):
    """By the network file, and SUMO's word on who is behind whom; the judge says the same."""
    assert run(network).priority.taken == []
    assert run(network).witness.forced == []
    assert [str(v) for v in run(network).result.violations] == []


def test_the_ego_waits_for_green_and_for_a_gap_at_the_lights():
    found = run("signalised_left_turns")
    assert {letters for _, letters in found.witness.lights} <= set("gGyY")
    assert [(time, letters * 2) for time, letters in found.witness.lights] == [
        (round(scene.step.time, 2), scene.crossed) for scene in found.scenes if scene.crossed
    ]
    assert len(found.witness.lights) == len([step for step, _ in found.boxes() if step.light]) == 1


def test_the_ego_stops_fully_at_the_all_way_stop():
    before_line = [step for step, _ in run("all_way_stop").boxes() if step.lane_id == "from_west_0"]
    assert min(step.speed for step in before_line) < 0.1


@pytest.mark.parametrize("step_length", [0.05, 0.1, 0.25, 0.5, 1.0])
def test_every_step_length_works(step_length):
    found = run("four_way_priority", step_length)
    assert found.result.arrived, found.result.verdict
    assert found.result.step_length_s == step_length
    assert not touched(found)


def instructions(run: Run) -> list[str]:
    """The instructions of a drive in order, each once for as long as it stays."""
    return [name for name, _ in groupby(scene.step.instruction for scene in run.scenes)]


@pytest.mark.parametrize("profile", Profile)
def test_the_ego_overtakes_and_then_crosses_as_in_the_papers_figure_4(profile):
    order = instructions(run("figure4", None, profile))
    stages = [Instruction.OVERTAKE.value, Instruction.RETURN.value, Instruction.CROSS.value]
    assert [name for name in order if name in stages] == stages


@pytest.mark.parametrize("step_length", [0.1, 0.5, 1.0])
def test_a_broken_down_car_is_passed_at_every_step_length(step_length):
    found = run("blocked_lane", step_length)
    assert found.result.arrived, found.result.verdict
    assert not touched(found)
    assert Instruction.OVERTAKE.value in instructions(found)
    assert Instruction.FALL_BACK.value not in instructions(found)


@pytest.mark.parametrize("network", ["figure4", "two_way_road", "country_road"])
def test_between_events_the_pilot_does_not_run(network):
    """In most steps nothing happens that differs from what the pilot foresaw."""
    steps = [scene.step for scene in run(network).scenes]
    assert all(step.pilot == bool(step.events) for step in steps)
    assert sum(step.pilot for step in steps) < 0.25 * len(steps)


@each_network
def test_the_papers_profile_arrives_without_touching_anybody(network):
    found = run(network, None, Profile.PAPER)
    assert found.result.arrived, found.result.verdict
    assert not touched(found)


@pytest.mark.parametrize("profile", Profile)
@each_network
def test_the_ego_drives_and_decides_as_checked_in(network, profile):
    """After a change that is meant, `tools/digests.py --write` writes the file again, and `--also` on another machine."""
    found = run(network, None, profile) if profile is not Profile.DEFAULT else run(network)
    now = DIGESTS.digests_of(found.result.arrived, [scene.step for scene in found.scenes])
    assert DIGESTS.parting_from_all(CHECKED_IN[f"{network} {profile.value} {found.result.seed}"], now) == ""


def test_the_same_seed_gives_the_same_drive():
    first = run("four_way_priority").scenes
    scenes: list[Scene] = []
    run_trial(load_scenario(ROOT / "scenarios" / "four_way_priority.toml"), observer=scenes.append)
    assert [(s.step.time, s.step.x, s.step.y, s.step.speed) for s in scenes] == [
        (s.step.time, s.step.x, s.step.y, s.step.speed) for s in first
    ]
