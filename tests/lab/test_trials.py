"""The trials of an experiment: which there are, their keys, and how egos are drawn."""

import shutil
from dataclasses import replace
from pathlib import Path

import pytest

from sumo_reactive.driver.parameters import Parameters
from sumo_reactive.errors import ScenarioError
from sumo_reactive.lab.batch.experiment import load_experiment
from sumo_reactive.lab.batch.trials import Departure, _digest_of_files, drawn_egos, key_of, scout, trials_of
from sumo_reactive.lab.drivers.choice import REACTIVE, SUMO
from sumo_reactive.lab.ego_rule import EgoRule
from sumo_reactive.lab.fundamental_diagram import CountedEdges
from sumo_reactive.lab.scenario import load_scenario
from sumo_reactive.lab.task import Task

ROOT = Path(__file__).parents[2]
FOUR_WAY = ROOT / "scenarios" / "four_way_priority.toml"
TRIPS = [Departure(f"car_{k}", 10.0 * k, 100.0 * k) for k in range(10)]


def trials(folder, more, scout=lambda scenario: TRIPS):
    file = folder / "e.toml"
    file.write_text(f'[experiment]\nscenarios = ["{FOUR_WAY}"]\n{more}', encoding="utf-8")
    return trials_of(load_experiment(file), scout)


def test_a_grid_is_a_product_and_the_baseline_is_run_once(tmp_path):
    more = "seeds = [1, 2]\n[parameters]\nSTUCK_S = [100.0, 200.0]\nPROGRESS_M = [1.0, 2.0]\n[options]\nscale = [1.0, 2.0]\n"
    found = trials(tmp_path, more)
    assert len(found) == 2 * 2 * (4 + 1)
    assert len({trial.key for trial in found}) == len(found)
    assert all(not trial.parameters for trial in found if trial.task.scenario.driver == SUMO)
    points = {tuple(trial.task.scenario.parameters.varied.items()) for trial in found if trial.parameters}
    assert points == {(("progress_m", far), ("stuck_s", long)) for far in (1.0, 2.0) for long in (100.0, 200.0)}


def test_samples_are_drawn_within_their_ranges_and_the_same_each_time(tmp_path):
    more = 'drivers = ["reactive"]\nseeds = [1]\n[samples]\ncount = 5\n'
    more += "parameters = {STUCK_S = [100.0, 200.0], progress_m = [1, 9]}\n"
    found, again = trials(tmp_path, more), trials(tmp_path, more)
    assert [trial.key for trial in found] == [trial.key for trial in again]
    assert len(found) == 5
    assert all(100.0 <= trial.task.scenario.parameters.stuck_s <= 200.0 for trial in found)
    assert all(trial.parameters == trial.task.scenario.parameters.varied for trial in found)


def test_egos_are_drawn_among_long_trips_after_the_warm_up(tmp_path):
    more = 'drivers = ["sumo"]\nseeds = [1, 2]\n[egos]\ndrawn = 3\nmin_length_m = 300.0\nwarm_up_s = 50.0\n'
    egos = {trial.task.scenario.ego for trial in trials(tmp_path, more)}
    assert len(egos) == 3 and egos <= {f"car_{k}" for k in range(5, 10)}
    assert drawn_egos(TRIPS, 3, 1, 300.0, 50.0) == drawn_egos(TRIPS, 3, 1, 300.0, 50.0)


def test_too_few_trips_are_told_with_the_line(tmp_path):
    with pytest.raises(ScenarioError, match=r"e\.toml:4: key 'egos.drawn': only 0 of the 10 trips .* 5000 m"):
        trials(tmp_path, "[egos]\ndrawn = 3\nmin_length_m = 5000.0\n")


def test_scouting_finds_the_road_cars_that_arrive():
    found = scout(load_scenario(FOUR_WAY))
    assert "ego" in [trip.vehicle_id for trip in found]
    assert found == sorted(found, key=lambda trip: (trip.depart_s, trip.vehicle_id))
    assert all(trip.length_m > 0.0 for trip in found)


def test_a_key_depends_on_contents_and_not_on_where_they_lie(tmp_path):
    folder, network = tmp_path / "elsewhere", ROOT / "networks" / "four_way_priority"
    shutil.copytree(network, folder)
    here = load_scenario(network / "four_way_priority.sumocfg")
    moved = replace(here, config=folder / here.config.name)
    assert key_of(Task(here)) == key_of(Task(moved))
    (routes,) = folder.glob("*.rou.xml")
    with routes.open("a", encoding="utf-8") as file:
        file.write("<!-- another -->")
    _digest_of_files.cache_clear()
    assert key_of(Task(here)) != key_of(Task(moved))


def test_whatever_is_asked_for_is_part_of_the_key():
    scenario = load_scenario(FOUR_WAY)
    asked = [
        Task(scenario), Task(replace(scenario, driver=SUMO)),
        Task(replace(scenario, parameters=Parameters(stuck_s=1.0))),
        Task(replace(scenario, seed=1)), Task(replace(scenario, ego="other")), Task(replace(scenario, step_length_s=0.2)),
        Task(replace(scenario, egos=EgoRule(share=0.5))), Task(replace(scenario, egos=EgoRule(share=0.6))),
        Task(replace(scenario, egos=EgoRule(types=("bus",), share=0.5))),
        Task(replace(scenario, egos=EgoRule(share=0.5)), CountedEdges(30.0)),
        Task(replace(scenario, until_s=1.0)), Task(replace(scenario, sumo_options=("--scale", "2"))),
    ]  # fmt: skip
    assert len({key_of(task) for task in asked}) == len(asked)


def test_shares_of_egos_are_trials_of_their_own_and_told_among_what_varies(tmp_path):
    found = trials(tmp_path, "seeds = [1, 2]\n[egos]\nshare = [0.0, 0.3]\n[parameters]\nstuck_s = [5.0, 9.0]\n")
    assert len(found) == len({trial.key for trial in found}) == 8
    assert {trial.task.scenario.egos for trial in found} == {EgoRule(share=0.0), EgoRule(share=0.3)}
    assert {trial.task.scenario.driver for trial in found} == {REACTIVE}
    one = next(trial for trial in found if trial.task.scenario.egos.share == 0.3 and trial.task.scenario.seed == 2)
    assert one.parameters == {"share": 0.3, "stuck_s": 5.0}
    assert "--ego-probability 0.3 --seed 2" in one.replay
    assert "share=0.3" in str(one)


def test_kinds_of_egos_are_drawn_among_and_all_of_them_without_a_share(tmp_path):
    kinds = 'types = ["car"]\nclasses = ["passenger", "taxi"]\nregion = [0, 0, 100.5, 50]\n'
    rule = EgoRule(types=("car",), classes=("passenger", "taxi"), region=(0.0, 0.0, 100.5, 50.0))
    (every,) = trials(tmp_path, f"seeds = [1]\n[egos]\n{kinds}")
    assert (every.task.scenario.egos, every.parameters["share"]) == (rule, 1.0)
    found = trials(tmp_path, f"seeds = [1]\n[egos]\n{kinds}share = [0.2, 0.4]\n")
    assert [one.task.scenario.egos for one in found] == [replace(rule, share=share) for share in (0.2, 0.4)]
