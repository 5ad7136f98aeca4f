"""A process that drives many trials keeps nothing of those that are over."""

import gc
from dataclasses import replace
from pathlib import Path

from sumo_reactive.driver.world.road_graph import RoadGraph
from sumo_reactive.lab.scenario import load_scenario
from sumo_reactive.lab.simulation import run_trial

FOUR_WAY = Path(__file__).parents[2] / "scenarios" / "four_way_priority.toml"
FEW = 10
"""Python objects a trial: less than the lanes, plans and curves of one world."""


def kept_after(trials):
    """Drive so many trials; return how many Python objects there are then, and how many of them are worlds."""
    scenario = load_scenario(FOUR_WAY)
    for seed in range(trials):
        run_trial(replace(scenario, seed=seed, until_s=25.0))
    gc.collect()
    found = gc.get_objects()
    return len(found), sum(type(one) is RoadGraph for one in found)


def test_memory_does_not_grow_with_the_trials():
    before, worlds = kept_after(3)
    after, worlds_then = kept_after(12)
    assert after - before < 12 * FEW and worlds_then == worlds
