"""A scenario as a Gymnasium environment: the ego is driven by actions, and judged as in every other trip.

    env = gymnasium.make("sumo_reactive.gym:SumoReactive-v0", scenario="scenarios/roundabout.toml")

libsumo holds one simulation in a process: several environments at once need processes of their own (`AsyncVectorEnv`); a
reset ends the episode of another one in the same process.
"""

from __future__ import annotations

import gymnasium

from sumo_reactive.gym.environment import SumoReactiveEnv as SumoReactiveEnv

gymnasium.register("SumoReactive-v0", entry_point="sumo_reactive.gym:SumoReactiveEnv")
