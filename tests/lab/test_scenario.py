"""Scenario files: what they give, and the one line that a bad one gets."""

from dataclasses import replace
from pathlib import Path

import pytest

from sumo_reactive.driver.parameters import Parameters, Profile
from sumo_reactive.errors import ScenarioError
from sumo_reactive.lab.ego_rule import EgoRule
from sumo_reactive.lab.scenario import Expectation, Limit, load_scenario, load_scenario_file

ROOT = Path(__file__).parents[2]
CONFIG = (ROOT / "networks" / "roundabout" / "roundabout.sumocfg").as_posix()
HEAD = f'[scenario]\nconfig = "{CONFIG}"\n'


def _file(tmp_path, text):
    path = tmp_path / "one.toml"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize("path", sorted((ROOT / "scenarios").glob("*.toml")), ids=lambda path: path.stem)
def test_every_scenario_of_the_repository_loads(path):
    scenario = load_scenario(path)
    assert scenario.config.exists()
    assert scenario.ego and scenario.source == path
    assert load_scenario_file(path).expectation.metrics


def test_keys_become_the_scenario(tmp_path):
    text = f'[scenario]\nconfig = "{CONFIG}"\nego = "a"\nseed = 7\nstep_length_s = 0.05\nuntil_s = 60\nprofile = "paper"\n'
    scenario = load_scenario(_file(tmp_path, text))
    assert (scenario.ego, scenario.seed, scenario.step_length_s, scenario.until_s) == ("a", 7, 0.05, 60.0)
    assert scenario.profile is Profile.PAPER


def test_a_file_without_seeds_and_expectations_is_one_case_that_arrives_without_a_fault(tmp_path):
    file = load_scenario_file(_file(tmp_path, f'[scenario]\nconfig = "{CONFIG}"\nseed = 7\n'))
    assert (file.seeds, file.scenario.seed) == ((7,), 7)
    assert file.expectation == Expectation(arrived=True, collisions=0, violations=0, metrics={})


def test_seeds_parameters_and_expectations_are_read(tmp_path):
    text = f"""
[scenario]
config = "{CONFIG}"
seeds = [3, 1, 2]
[scenario.parameters]
STUCK_S = 60
[expect]
violations = 1
[expect.metrics]
duration_s = {{ max = 60 }}
min_time_to_collision_s = {{ min = 0.5, max = 9 }}
"""
    scenario, seeds, expectation, _ = load_scenario_file(_file(tmp_path, text))
    assert (scenario.seed, seeds) == (3, (3, 1, 2))
    assert scenario.parameters == Parameters(stuck_s=60.0)
    limits = {"duration_s": Limit(max=60.0), "min_time_to_collision_s": Limit(min=0.5, max=9.0)}
    assert expectation == Expectation(violations=1, metrics=limits)


def test_a_configuration_is_a_scenario_with_its_own_seed(tmp_path):
    text = (ROOT / "networks" / "roundabout" / "roundabout.sumocfg").read_text(encoding="utf-8")
    text = text.replace('value="roundabout.', f'value="{ROOT.as_posix()}/networks/roundabout/roundabout.')
    path = tmp_path / "any.name"
    path.write_text(text.replace("<time>", '<random_number><seed value="7"/></random_number><time>'), encoding="utf-8")
    scenario = load_scenario(path)
    assert (scenario.ego, scenario.seed, scenario.step_length_s) == (None, 7, None)


@pytest.mark.parametrize(
    ("text", "place"),
    [
        (f'{HEAD}speed = 3\n', ":3: unknown key 'scenario.speed'"),
        (f'{HEAD}sedes = [1]\n', ":3: unknown key 'scenario.sedes'; near it: seeds, seed"),
        (f'{HEAD}[other]\n', ":3: unknown key 'other'"),
        ("[scenario]\n", ":1: missing key 'scenario.config'"),
        ("", ": missing key 'scenario'"),
        (f'{HEAD}seed = "x"\n', ":3: key 'scenario.seed': Input should be a valid integer"),
        (f'{HEAD}seed = true\n', ":3: key 'scenario.seed'"),
        (f'{HEAD}seeds = []\n', ":3: key 'scenario.seeds'"),
        (f'{HEAD}seeds = [\n  1,\n  -2,\n]\n', ":3: key 'scenario.seeds.1'"),
        (f'{HEAD}seeds = [1, 1]\n', ":3: key 'scenario.seeds': a seed is named twice"),
        (f'{HEAD}seed = 1\nseeds = [1]\n', ":4: key 'scenario.seeds': there is 'seed' already"),
        (f'{HEAD}step_length_s = 0\n', ":3: key 'scenario.step_length_s'"),
        (f'{HEAD}profile = "fast"\n', ":3: key 'scenario.profile'"),
        (
            f'{HEAD}[scenario.parameters]\nSTUKC_S = 1\n',
            ":4: key 'scenario.parameters.STUKC_S': unknown parameter 'STUKC_S'; near it: stuck_s",
        ),
        (f'{HEAD}parameters = {{ STUCK_S = "1" }}\n', ":3: key 'scenario.parameters.STUCK_S'"),
        (f'{HEAD}parameters.without = 1.5\n', ":3: key 'scenario.parameters.without'"),
        (f'{HEAD}parameters.stuck_s = -1\n', ":3: key 'scenario.parameters.stuck_s': parameter 'stuck_s': -1.0 is less"),
        (
            f'{HEAD}[scenario.parameters]\nSTUCK_S = 1\nstuck_s = 1\n',
            ":5: key 'scenario.parameters.stuck_s': parameter 'stuck_s' is named twice",
        ),
        (f'{HEAD}[expect]\narived = true\n', ":4: unknown key 'expect.arived'; near it: arrived"),
        (f'{HEAD}[expect]\narrived = 1\n', ":4: key 'expect.arrived'"),
        (f'{HEAD}[expect]\ncollisions = -1\n', ":4: key 'expect.collisions'"),
        (
            f'{HEAD}[expect.metrics]\n# none\nduration = {{ max = 3 }}\n',
            ":5: key 'expect.metrics.duration': unknown metric 'duration'; near it: duration_s",
        ),
        (f'{HEAD}[expect.metrics]\nduration_s = 3\n', ":4: key 'expect.metrics.duration_s'"),
        (f'{HEAD}[expect.metrics]\nduration_s = {{}}\n', ":4: key 'expect.metrics.duration_s': needs min, max or both"),
        (f'{HEAD}[expect.metrics]\nduration_s = {{ min = 3, max = 2 }}\n', "min 3 is above max 2"),
        (f"{HEAD}[egos]\n", ":3: key 'egos': names neither a share nor a kind nor anybody"),
        (f'{HEAD}[egos]\nnames = ["a"]\n', ":4: key 'egos.names': names one ego alone"),
        (f'{HEAD}ego = "a"\n[egos]\nshare = [0.5]\n', ":3: key 'scenario.ego': there are several under [egos]"),
        (f"{HEAD}[egos]\nshare = [0.5]\n[expect]\narrived = false\n", ":6: key 'expect.arrived': only one ego"),
        (f"{HEAD}[egos]\nshare = [2.0]\n", ":4: key 'egos.share.0'"),
        (f"{HEAD}[egos]\ntypes = []\n", ":4: key 'egos.types'"),
        (f"{HEAD}[egos]\nregion = [0.0, 1.0, 2.0]\n", ":4: key 'egos.region'"),
        (f"{HEAD}[egos]\nregion = [0.0, 1.0, 2.0, inf]\n", ":4: key 'egos.region.3'"),
        (f'{HEAD}[egos]\nnames = ["a", "a"]\n', ":4: key 'egos.names': ego 'a' is named twice"),
        (
            f"{HEAD}[egos]\nshare = [0.5]\n[expect.metrics]\nduration_s = {{ max = 3 }}\n",
            ":6: key 'expect.metrics.duration_s': unknown metric of several egos 'duration_s'",
        ),
        (f'{HEAD}[expect.metrics.duration_s]\nmost = 2\n', ":4: unknown key 'expect.metrics.duration_s.most'"),
        (f'{HEAD}[expect.metrics.duration_s]\nmax = nan\n', ":4: key 'expect.metrics.duration_s.max'"),
        ('[scenario]\nconfig = "nowhere.sumocfg"\n', "nowhere.sumocfg: no such file"),
        ("[scenario]\nconfig = \n", ":2: not TOML"),
    ],
)
def test_a_bad_file_gets_one_line_that_names_it_and_the_place(tmp_path, text, place):
    with pytest.raises(ScenarioError) as raised:
        load_scenario(_file(tmp_path, text))
    assert place in str(raised.value)
    assert str(tmp_path) in str(raised.value)
    assert "\n" not in str(raised.value)


def test_several_egos_are_a_rule_for_each_share(tmp_path):
    kinds = 'types = ["car"]\nregion = [0, 0, 9, 9]\nnames = ["a"]\n'
    file = load_scenario_file(_file(tmp_path, f"{HEAD}[egos]\nshare = [0.1, 0.5]\n{kinds}"))
    rule = EgoRule(ids=("a",), types=("car",), region=(0.0, 0.0, 9.0, 9.0))
    assert file.rules == file.variants == (replace(rule, share=0.1), replace(rule, share=0.5))
    assert file.scenario.egos == file.rules[0]
    alone = load_scenario_file(_file(tmp_path, HEAD))
    assert (alone.rules, alone.variants, alone.scenario.egos) == ((), (None,), None)
