"""Twenty lines of learning: cross-entropy search for when to slow down behind a leader and before a light.

    python examples/drivers/learning.py scenarios/signalised_left_turns.toml
"""

import sys

import gymnasium
import numpy as np

import sumo_reactive.gym  # noqa: F401 (registers the environment)


def episode(env, weights, seed):
    """Return what an episode brings: a linear policy of leader, light and speed, or random actions without weights."""
    seen, _ = env.reset(seed=seed)
    total, is_over = 0.0, False
    while not is_over:
        light = seen["light"][0] * max(seen["light"][1:]) + 200.0 * (1.0 - max(seen["light"][1:]))
        features = np.array([1.0, seen["lanes"][0, 2] / 50.0, light / 50.0, seen["ego"][0] / 10.0])
        action = env.action_space.sample() if weights is None else np.tanh([weights @ features]).astype(np.float32)
        seen, reward, terminated, truncated, _ = env.step(action)
        total, is_over = total + reward, terminated or truncated
    return total


def learn(env, rounds=5, drawn=12, kept=4, seed=0):
    """Return the weights that cross-entropy search ends with."""
    draw, mean, spread = np.random.default_rng(seed), np.zeros(4), np.ones(4)
    for _ in range(rounds):
        tried = mean + spread * draw.standard_normal((drawn, 4))
        best = tried[np.argsort([-episode(env, weights, 42) for weights in tried])[:kept]]
        mean, spread = best.mean(axis=0), best.std(axis=0) + 0.05
    return mean


if __name__ == "__main__":
    env = gymnasium.make("SumoReactive-v0", scenario=sys.argv[1], action="speed", horizon_s=120.0)
    env.action_space.seed(0)
    before = np.mean([episode(env, None, seed) for seed in (42, 43, 44)])
    found = learn(env)
    print(f"random actions: {before:.1f}, learned: {np.mean([episode(env, found, seed) for seed in (42, 43, 44)]):.1f}")
    env.close()
