"""Stores of batches whose trials never ran."""

from dataclasses import replace
from pathlib import Path

from helpers.results import result
from sumo_reactive.driver.nouns.assessment import NOT_ASSESSED
from sumo_reactive.driver.nouns.decision import Behaviour, Decision, Instruction, Reason
from sumo_reactive.lab.batch.store import Store
from sumo_reactive.lab.batch.trials import Trial
from sumo_reactive.lab.drivers.choice import REACTIVE, SUMO
from sumo_reactive.lab.ego_rule import EgoRule
from sumo_reactive.lab.fault import COLLISION, Fault
from sumo_reactive.lab.fundamental_diagram import DiagramPoint
from sumo_reactive.lab.result import NetworkResult
from sumo_reactive.lab.scenario import load_scenario
from sumo_reactive.lab.task import Ending, Outcome, Task
from sumo_reactive.lab.trace import Entry

FOUR_WAY = Path(__file__).parents[2] / "scenarios" / "four_way_priority.toml"
METRICS = ("arrived", "collisions", "duration_s", "rms_jerk_m_s3")
JUDGED = Entry(
    12.0, (), NOT_ASSESSED, Behaviour.CAUTIOUS, Instruction.CROSS,
    (Decision(behaviour=Behaviour.CAUTIOUS, reason=Reason.YIELD_TO, region="J1", cause="veh_<7>", passes=True),),
)  # fmt: skip


def trial(seed, driver=REACTIVE, scenario="town.toml", parameters=None):
    """Return a trial of a scenario that stands for `scenario`."""
    task = Task(replace(load_scenario(FOUR_WAY), seed=seed, ego=scenario.removesuffix(".toml"), driver=driver))
    return Trial(scenario, parameters or {}, {}, task)


def outcome(one, duration, jerk=2.0, entries=(), **others):
    """Return an arrival after `duration` (s), but for `others`."""
    figures = {"rms_jerk_m_s3": jerk, "collisions": len(others.get("faults", ()))}
    ego = one.task.scenario.ego
    done = result(ego=ego, seed=one.task.scenario.seed, end_s=5.0 + duration, figures=figures, **others)
    return Outcome(task=one.task, ending=Ending.DONE, result=done, entries=entries, trajectory="digest", wall_s=0.1)


def made_store(path):
    """Make a store: two scenarios, three seeds, both drivers; one trial collides, one does not arrive, one crashes."""
    kept = []
    for scenario, slower in (("town.toml", 0.0), ("land.toml", 20.0)):
        for seed in (1, 2, 3):
            baseline, ours = trial(seed, SUMO, scenario), trial(seed, REACTIVE, scenario)
            kept.append((baseline, outcome(baseline, 40.0 + slower + seed, jerk=4.0 + 0.1 * seed)))
            kept.append((ours, outcome(ours, 30.0 + slower + 2.0 * seed, jerk=1.0 + 0.1 * seed)))
    hit = trial(4)
    collision = Fault(13.0, COLLISION, "veh_<7>", "lane_0")
    kept.append((hit, outcome(hit, 33.0, entries=(JUDGED,), faults=(collision,))))
    late, lost = trial(5), trial(6)
    kept.append((late, outcome(late, 99.0, arrived=False, ended="until 104 s")))
    kept.append((lost, Outcome(task=lost.task, ending=Ending.CRASHED, reason="the process was killed by SIGKILL")))
    with Store(path) as store:
        store.plan([one for one, _ in kept], list(METRICS))
        for one, ended in kept:
            store.put(one, ended, 1)
    return path


def made_share_store(path, seeds=4):
    """Make a store of runs with shares of egos: the higher the share, the smaller the time loss."""
    kept = []
    for share in (0.0, 0.2, 0.6):
        for seed in range(1, seeds + 1):
            task = Task(replace(load_scenario(FOUR_WAY), seed=seed, egos=EgoRule(share=share)))
            one = Trial("town.toml", {"share": share}, {}, task)
            metrics = {
                "egos": 100.0 * share, "network_mean_time_loss_s": 20.0 - 5.0 * share + 0.1 * seed,
                "network_vehicles": 100, "egos_collisions": 0, "egos_violations": 0,
            }  # fmt: skip
            points = tuple(
                DiagramPoint("main <road>", begin, begin + 60.0, 36.0 * (10.0 + seed) * (1.0 + share), 10.0 + seed,
                             round(10.0 * (1.0 + share), 4))
                for begin in (0.0, 60.0)
            )  # fmt: skip
            came = NetworkResult(share=share, metrics=metrics, by_ego=(), departure_s=0.0, diagram=points)
            kept.append((one, came))
    with Store(path) as store:
        store.plan([one for one, _ in kept], ["egos", "network_mean_time_loss_s"])
        for one, network in kept:
            store.put(one, Outcome(task=one.task, ending=Ending.DONE, network=network, trajectory="digest"), 1)
    return path
