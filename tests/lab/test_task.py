"""Commands that repeat a run: written from a task, and read back as the same one."""

from dataclasses import replace
from pathlib import Path

import pytest
import typer.main
from hypothesis import given, settings
from hypothesis import strategies as some

from sumo_reactive.cli.main import app
from sumo_reactive.driver.parameters import Delays, Profile
from sumo_reactive.errors import ScenarioError
from sumo_reactive.lab.drivers.choice import REACTIVE, SUMO, DriverChoice
from sumo_reactive.lab.ego_rule import EgoRule, several
from sumo_reactive.lab.scenario import load_scenario
from sumo_reactive.lab.simulation import run_trial
from sumo_reactive.lab.task import _FIELDS, _MORE, Task, replay_command, task_of

ROOT = Path(__file__).parents[2]
CONFIG = ROOT / "networks" / "four_way_priority" / "four_way_priority.sumocfg"
USERS = DriverChoice("my.module:Own", (("gain", 0.5), ("is_bold", True), ("name", "a b")), Path.cwd())

seconds = some.floats(0.01, 1e5)
scenarios = some.fixed_dictionaries({
    "ego": some.none() | some.text("abc #'\"$äé.", min_size=1).filter(lambda name: not name.startswith("-")),
    "seed": some.integers(0, 2**31 - 1), "step_length_s": some.none() | seconds, "until_s": some.none() | seconds,
    "horizon_s": some.none() | seconds, "until_end": some.booleans(), "profile": some.sampled_from(Profile),
    "delays": some.sampled_from(Delays), "obstacle_polygons": some.sampled_from(["obstacle", "works on the road"]),
    "sumo_options": some.sampled_from([(), ("--scale", "1.5"), ("--", "-e", "600")]),
})  # fmt: skip


word = some.text("abc #'\"$é.", min_size=1).filter(lambda name: not name.startswith("-"))
words = some.lists(word, unique=True).map(tuple)
corners = some.none() | some.tuples(*[some.floats(-1e5, 1e5)] * 4)
shares = some.none() | some.floats(0.0, 1.0)
rules = some.builds(EgoRule, ids=words, types=words, classes=words, region=corners, share=shares).filter(several)


@settings(max_examples=100, deadline=None)
@given(scenarios, some.none() | rules)
def test_a_command_is_read_back_as_the_task_that_it_was_written_from(fields, rule):
    fields |= {"egos": rule} | ({"ego": None} if rule else {})
    task = Task(replace(load_scenario(CONFIG), **fields))
    varied = replace(task.scenario, parameters=task.scenario.parameters.with_values({"STUCK_S": 100.25, "progress_m": 1}))
    for one in (task, replace(task, scenario=varied)):
        assert task_of(replay_command(one)) == one


@pytest.mark.parametrize("driver", [REACTIVE, SUMO, USERS], ids=str)
def test_a_command_names_the_driver_with_its_options(driver):
    task = Task(replace(load_scenario(CONFIG), driver=driver))
    assert task_of(replay_command(task)) == task


def test_a_command_that_names_no_driver_is_this_projects_whatever_the_file_says(tmp_path):
    file = tmp_path / "a.toml"
    file.write_text(f'[scenario]\nconfig = "{CONFIG}"\ndriver = "sumo"\n', encoding="utf-8")
    task = Task(replace(load_scenario(file), driver=REACTIVE))
    assert load_scenario(file).driver == SUMO and task_of(replay_command(task)) == task


def test_run_has_every_option_of_such_a_command():
    run = typer.main.get_command(app).commands["run"]
    known = {name for option in run.params for name in option.opts}
    assert {*_FIELDS, *_MORE} <= known


@pytest.mark.parametrize(
    "command",
    ["", "rm -rf .", "sumo-reactive run", "sumo-reactive check a.toml", "sumo-reactive run a.sumocfg --gui",
     "sumo-reactive run a.sumocfg --seed", "sumo-reactive run a.sumocfg --seed one", "sumo-reactive run 'a",
     "sumo-reactive run a.sumocfg --profile fast",
     "sumo-reactive run a.sumocfg --ego-region 1,2,x,4", "sumo-reactive run a.sumocfg --driver-option a=[",
     "sumo run a.sumocfg"],
)  # fmt: skip
def test_any_other_command_is_refused(command):
    with pytest.raises(ScenarioError, match="not the command of a run"):
        task_of(command)


def test_a_run_tells_the_command_that_ends_it_at_the_same_time():
    result = run_trial(replace(load_scenario(CONFIG), ego="ego", seed=3, horizon_s=2.5))
    again = task_of(result.command).scenario
    assert "--ego ego --seed 3 --horizon 2.5" in result.command
    assert run_trial(again).end_s == result.end_s == result.departure_s + 2.5
