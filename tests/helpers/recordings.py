"""Records of runs that never took place."""

import json

from helpers.results import result
from sumo_reactive.driver.nouns.decision import Behaviour, Instruction
from sumo_reactive.driver.nouns.record import StepRecord
from sumo_reactive.lab.recorder import DECISIONS, REGIONS, SUMMARY, TRAJECTORY, write_trajectory
from sumo_reactive.lab.result import summary_of
from sumo_reactive.lab.trace import entries, line_of

NAN = float("nan")


def step(k, behaviour=Behaviour.NORMAL, **others):
    """Return the k-th step of 0.1 s: at 10 m/s along x on lane `a_0`, 50 m behind `van`."""
    values = {
        "time": 0.1 * k, "x": float(k), "y": 2.0, "heading": 0.0, "speed": 10.0, "acceleration": 0.0, "steering_angle": 0.0,
        "lane_id": "a_0", "s": float(k), "d": 0.0, "command_acceleration": 0.0, "command_steering_rate": 0.0,
        "desired_speed": 12.0, "stop_s": NAN, "u": 0.3, "u1": 0.1, "u2": 0.2, "u3": 0.0, "leader": "van", "gap": 50.0,
        "behaviour": behaviour.value, "instruction": Instruction.FOLLOW_CURVE.value, "pilot": 0, "emergency": False,
        "light": "", "control_us": 100.0, "decisions": (), "hazard": "",
    }  # fmt: skip
    return StepRecord(**(values | others))


def made_record(folder, steps, regions=None, **others):
    """Write the record of a run with these steps; `others` differ from a clean arrival."""
    folder.mkdir()
    write_trajectory(folder / TRAJECTORY, steps)
    lines = [json.dumps(line_of(entry)) + "\n" for entry in entries(steps)]
    (folder / DECISIONS).write_text("".join(lines), encoding="utf-8")
    (folder / REGIONS).write_text(json.dumps(regions or {}), encoding="utf-8")
    (folder / SUMMARY).write_text(json.dumps(summary_of(result(**others))), encoding="utf-8")
    return folder
