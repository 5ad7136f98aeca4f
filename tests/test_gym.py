"""The Gymnasium environment: what checkers ask for, the same seed twice, several at once, a page that is true."""

import importlib.util
import re
import subprocess
import sys
import warnings
from pathlib import Path

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

from sumo_reactive.gym import SumoReactiveEnv
from sumo_reactive.gym.observation import OBSERVED, observation_table

ROOT = Path(__file__).resolve().parents[1]
ROUNDABOUT, LIGHTS = (str(ROOT / "scenarios" / f"{name}.toml") for name in ("roundabout", "signalised_left_turns"))
PAGE = ROOT / "docs" / "gym.md"


@pytest.fixture
def made():
    """Return what makes an environment that is closed at the end."""
    found = []

    def make(**how):
        found.append(SumoReactiveEnv(**({"scenario": ROUNDABOUT} | how)))
        return found[-1]

    yield make
    for env in found:
        env.close()


def trajectory(env, seed, action, steps=150):
    """Return speed and offset of each step of an episode with one action throughout, and how it ended."""
    env.reset(seed=seed)
    rows = []
    for _ in range(steps):
        seen, reward, terminated, truncated, info = env.step(np.array(action, dtype=np.float32))
        rows.append((*seen["ego"].tolist(), reward))
        if terminated or truncated:
            break
    return rows, terminated, truncated, info


@pytest.mark.parametrize("action", ["steer", "speed"])
def test_the_checker_has_no_complaint(made, action):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.filterwarnings("ignore", message=".*render.*")  # asked for with a mode of rendering alone
        check_env(made(action=action, render_mode="rgb_array"), skip_render_check=False)


def test_the_same_seed_and_actions_are_the_same_trajectory_and_another_seed_is_another(made):
    env = made(action="speed")
    first, again, other = (trajectory(env, seed, [0.6])[0] for seed in (3, 3, 4))
    assert first == again
    assert first != other


def test_an_even_speed_into_a_roundabout_ends_with_a_contact_and_its_verdict(made):
    _, terminated, truncated, info = trajectory(made(action="speed"), 3, [0.6])
    assert (terminated, truncated) == (True, False)
    assert info["verdict"].startswith("collision with")
    assert info["figures"]["collisions"] == 1


def test_straight_on_off_the_way_is_no_end_but_cut_short(made):
    _, terminated, truncated, _ = trajectory(made(action="steer"), 3, [0.6, 0.0], 1000)
    assert (terminated, truncated) == (False, True)


def test_a_reward_of_ones_own_gets_the_transition(made):
    env, seen = made(action="speed", reward=lambda one: one.advanced), []
    rows, *_ = trajectory(env, 3, [0.0], 50)
    seen = [row[-1] for row in rows]
    assert abs(sum(seen) - 5.0 * np.mean([row[0] for row in rows])) < 2.0


def test_a_reset_ends_the_episode_of_another_environment_of_the_process(made):
    first, second = made(), made()
    first.reset(seed=1)
    second.reset(seed=1)
    with pytest.raises(gymnasium.error.ResetNeeded):
        first.step(np.zeros(2, dtype=np.float32))
    second.step(np.zeros(2, dtype=np.float32))


def test_several_run_at_once_in_processes_of_their_own():
    make = [lambda: gymnasium.make("sumo_reactive.gym:SumoReactive-v0", scenario=ROUNDABOUT, action="speed")] * 2
    vector = gymnasium.vector.AsyncVectorEnv(make)
    try:
        vector.reset(seed=[1, 2])
        for _ in range(20):
            seen, *_ = vector.step(np.full((2, 1), 0.5, dtype=np.float32))
        assert seen["ego"].shape == (2, 7)
    finally:
        vector.close()


def test_the_picture_has_road_way_and_ego(made):
    env = made(render_mode="rgb_array")
    env.reset(seed=3)
    image = env.render()
    assert image.shape == (400, 400, 3)
    colours = {tuple(colour) for colour in image.reshape(-1, 3).tolist()}
    assert {(150, 156, 163), (86, 180, 233), (213, 94, 0)} < colours


def test_every_array_has_a_row_of_the_page_for_each_of_its_columns():
    table = re.search(r"<!-- sample: observation -->\n(.*)<!-- /sample -->", PAGE.read_text(encoding="utf-8"), re.DOTALL)[1]
    assert table == observation_table()
    assert table.count("\n| `") == sum(len(columns) for _, columns in OBSERVED.values())


def test_the_block_of_the_page_runs():
    (text,) = re.findall(r"^```python\n(.*?)^```$", PAGE.read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE)
    answer = subprocess.run([sys.executable, "-c", text], cwd=ROOT, capture_output=True, text=True, timeout=240, check=False)
    assert answer.returncode == 0, answer.stderr
    assert answer.stdout.strip()


def test_the_learning_example_improves_on_random_actions(made):
    place = importlib.util.spec_from_file_location("learning", ROOT / "examples" / "drivers" / "learning.py")
    learning = importlib.util.module_from_spec(place)
    place.loader.exec_module(learning)
    env = made(scenario=LIGHTS, action="speed", horizon_s=120.0)
    env.action_space.seed(0)
    found = learning.learn(env, rounds=2, drawn=6, kept=2)
    assert learning.episode(env, found, 42) > learning.episode(env, None, 42) + 5.0
