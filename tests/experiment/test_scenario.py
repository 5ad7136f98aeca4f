"""Scenario files: what they give, and the one line that a bad one gets."""

from pathlib import Path

import pytest

from sumo_reactive.controller import Profile
from sumo_reactive.errors import ScenarioError
from sumo_reactive.experiment.scenario import load_scenario

ROOT = Path(__file__).parents[2]
CONFIG = (ROOT / "networks" / "roundabout" / "roundabout.sumocfg").as_posix()


def _file(tmp_path, text):
    path = tmp_path / "one.toml"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize("path", sorted((ROOT / "scenarios").glob("*.toml")), ids=lambda path: path.stem)
def test_every_scenario_of_the_repository_loads(path):
    scenario = load_scenario(path)
    assert scenario.config.exists()
    assert scenario.ego and scenario.source == path


def test_keys_become_the_scenario(tmp_path):
    text = f'[scenario]\nconfig = "{CONFIG}"\nego = "a"\nseed = 7\nstep_length_s = 0.05\nuntil_s = 60\nprofile = "paper"\n'
    scenario = load_scenario(_file(tmp_path, text))
    assert (scenario.ego, scenario.seed, scenario.step_length_s, scenario.until_s) == ("a", 7, 0.05, 60.0)
    assert scenario.profile is Profile.PAPER


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
        (f'[scenario]\nconfig = "{CONFIG}"\nspeed = 3\n', "unknown key 'scenario.speed'"),
        (f'[scenario]\nconfig = "{CONFIG}"\n[other]\n', "unknown key 'other'"),
        ("[scenario]\n", "missing key 'scenario.config'"),
        ("", "missing key 'scenario'"),
        (f'[scenario]\nconfig = "{CONFIG}"\nseed = "x"\n', "key 'scenario.seed'"),
        (f'[scenario]\nconfig = "{CONFIG}"\nstep_length_s = 0\n', "key 'scenario.step_length_s'"),
        (f'[scenario]\nconfig = "{CONFIG}"\nprofile = "fast"\n', "key 'scenario.profile'"),
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
