"""A trial with what it leaves behind: the judged result, the decisions, a digest of the trajectory."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from typing import Any

from sumo_reactive.driver.nouns.record import Scene, StepRecord
from sumo_reactive.lab.process.driver import Driver
from sumo_reactive.lab.process.task import Task
from sumo_reactive.lab.simulation import run_sumo_driver, run_trial
from sumo_reactive.lab.trace import entries
from sumo_reactive.lab.trajectory import COLUMNS

_FIELDS = [field for field in COLUMNS if field != "control_us"]


def run_observed(task: Task) -> dict[str, Any]:
    """Run a task in this process; return the fields that its `Outcome` takes from the trial."""
    steps: list[StepRecord] = []

    def see(scene: Scene) -> None:
        steps.append(scene.step)

    run = run_sumo_driver if task.driver is Driver.SUMO else run_trial
    result = run(task.scenario, observer=see)
    return {"result": result, "entries": tuple(entries(steps)), "trajectory": digest_of(steps)}


def digest_of(steps: Iterable[StepRecord]) -> str:
    """Return a digest of all that the steps hold as it is written to `trajectory.parquet`, but for wall-clock times."""
    digest = hashlib.sha256()
    for step in steps:
        digest.update(repr([getattr(step, field) for field in _FIELDS]).encode())
    return digest.hexdigest()
