"""Several egos in one simulation: real SUMO, each run in a process of its own."""

import json
from dataclasses import replace
from pathlib import Path
from subprocess import CompletedProcess

import pytest
from helpers.programs import ROOT, sumo_reactive

from sumo_reactive.driver.nouns.record import Scene
from sumo_reactive.errors import ScenarioError
from sumo_reactive.lab.drivers.choice import SUMO
from sumo_reactive.lab.ego_rule import EgoRule
from sumo_reactive.lab.fleet import run_fleet
from sumo_reactive.lab.metric_names import METRICS
from sumo_reactive.lab.result import FleetResult
from sumo_reactive.lab.scenario import Scenario, load_scenario
from sumo_reactive.lab.simulation import run_trial


def scenario(name: str = "four_way_priority", **changes: object) -> Scenario:
    return replace(load_scenario(ROOT / "scenarios" / f"{name}.toml"), **changes)


def seen(rule: EgoRule, **changes: object) -> tuple[FleetResult, dict[str, list[Scene]]]:
    scenes: dict[str, list[Scene]] = {}
    fleet = run_fleet(scenario(**changes), rule, observer=lambda scene: scenes.setdefault(scene.ego, []).append(scene))
    return fleet, scenes


def test_every_named_ego_is_driven_to_its_goal():
    fleet, scenes = seen(EgoRule(ids=("ego", "west_east.0")))
    assert {result.ego for result in fleet.results} == {"ego", "west_east.0"} == set(scenes)
    assert all(result.arrived and not result.collisions for result in fleet.results)
    assert fleet.exit_code == 0


def test_an_ego_alone_drives_as_it_does_without_a_fleet():
    fleet, scenes = seen(EgoRule(ids=("ego",)))
    alone: list[Scene] = []
    result = run_trial(scenario(), observer=alone.append)
    assert fleet.results[0].metrics == result.metrics
    assert [(s.step.time, s.step.x, s.step.y) for s in scenes["ego"]] == [(s.step.time, s.step.x, s.step.y) for s in alone]


def test_egos_see_each_other_as_ordinary_traffic():
    _, scenes = seen(EgoRule(share=1.0), until_s=40.0)
    others = {user.id for scene in scenes["ego"] for user in scene.users}
    assert others & set(scenes) - {"ego"}


def test_egos_are_all_decided_from_the_same_moment():
    _, scenes = seen(EgoRule(share=1.0), until_s=30.0)
    where = {(ego, round(s.step.time, 3)): (s.step.x, s.step.y) for ego, found in scenes.items() for s in found}
    met = [
        (user, where[user.id, round(scene.step.time, 3)])
        for found in scenes.values() for scene in found for user in scene.users
        if (user.id, round(scene.step.time, 3)) in where
    ]
    assert len(met) > 100
    assert all(abs(user.x - x) < 0.02 and abs(user.y - y) < 0.02 for user, (x, y) in met)


def test_the_end_of_a_run_is_no_fault_of_those_on_their_way():
    fleet, _ = seen(EgoRule(ids=("ego", "west_east.0")), until_s=15.0)
    assert fleet.on_their_way
    assert fleet.exit_code == 0


def test_the_same_share_and_seed_choose_and_drive_the_same_egos_again():
    one, two = (seen(EgoRule(share=0.5), until_s=60.0)[0] for _ in range(2))
    assert [(r.ego, r.metrics) for r in one.results] == [(r.ego, r.metrics) for r in two.results]
    assert one.results


def test_the_same_vehicles_are_judged_alike_in_the_hands_of_sumos_own_driver():
    rule = EgoRule(share=0.5)
    ours, _ = seen(rule, until_s=60.0)
    theirs, scenes = seen(rule, until_s=60.0, driver=SUMO)
    assert {one.ego for one in ours.results} == {one.ego for one in theirs.results} == set(scenes)
    assert all(one.profile == "sumo" and one.distance_m > 0.0 for one in theirs.results)
    assert set(ours.results[0].metrics) <= {*theirs.results[0].metrics, *METRICS}
    assert any(one.figures["min_time_to_collision_s"] is not None for one in theirs.results)


def test_egos_are_those_of_a_class_and_region_where_they_depart():
    everybody, scenes = seen(EgoRule(share=1.0), until_s=40.0)
    first = {ego: (found[0].step.x, found[0].step.y) for ego, found in scenes.items()}
    middle = sorted(x for x, _ in first.values())[len(first) // 2]
    west, _ = seen(EgoRule(region=(-1e4, -1e4, middle, 1e4)), until_s=40.0)
    chosen = {one.ego for one in west.results}
    assert set() < chosen < {one.ego for one in everybody.results}
    assert all(first[ego][0] < middle + 20.0 for ego in chosen)
    with pytest.raises(ScenarioError, match="no vehicle is chosen"):
        run_fleet(scenario(until_s=40.0), EgoRule(classes=("truck",)))


def test_an_ego_that_never_departs_is_an_error():
    with pytest.raises(ScenarioError, match="'nobody' never departs"):
        seen(EgoRule(ids=("ego", "nobody")), until_s=20.0)


DEVICES = """<routes>
<vType id="equipped"><param key="has.reactive.device" value="true"/></vType>
<vType id="plain"/>
<vehicle id="a" type="equipped" depart="0"><route edges="from_west to_east"/></vehicle>
<vehicle id="b" type="plain" depart="1"><param key="has.reactive.device" value="1"/>
  <route edges="from_east to_west"/></vehicle>
<vehicle id="c" type="equipped" depart="8"><param key="has.reactive.device" value="false"/>
  <route edges="from_west to_east"/></vehicle>
<flow id="f" type="plain" begin="12" end="20" number="2"><param key="device.reactive.probability" value="1"/>
  <route edges="from_east to_west"/></flow>
<vehicle id="d" type="plain" depart="20"><route edges="from_west to_east"/></vehicle>
</routes>"""


def equipped(folder: Path, routes: str) -> CompletedProcess[str]:
    net = ROOT / "networks" / "four_way_priority" / "four_way_priority.net.xml"
    (folder / "cars.rou.xml").write_text(routes)
    config = folder / "cars.sumocfg"
    config.write_text(
        f'<configuration><net-file value="{net}"/><route-files value="cars.rou.xml"/></configuration>', encoding="utf-8"
    )
    return sumo_reactive("run", config, "--out", folder / "out")


def test_vehicles_and_types_say_by_themselves_that_they_are_egos(tmp_path):
    done = equipped(tmp_path, DEVICES)
    assert done.returncode == 0, done.stderr
    fleet = json.loads((tmp_path / "out" / "fleet.json").read_text())
    assert [one["ego"] for one in fleet["egos"]] == ["a", "b", "f.0", "f.1"]
    assert (tmp_path / "out" / "f.0" / "summary.json").exists()


def test_an_equipment_that_is_neither_true_nor_false_is_one_clear_line(tmp_path):
    done = equipped(tmp_path, DEVICES.replace('value="1"/>\n', 'value="maybe"/>\n', 1))
    assert done.returncode == 2
    assert "vehicle 'b': has.reactive.device is 'maybe'" in done.stderr
    assert len(done.stderr.strip().splitlines()) == 1
