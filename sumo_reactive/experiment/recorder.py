"""The record of a trial in a folder: `summary.json`, `trajectory.parquet`, `decisions.jsonl`."""

from __future__ import annotations

import json
import os
import shutil
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path

from sumo_reactive.errors import ScenarioError
from sumo_reactive.experiment.result import TrialResult
from sumo_reactive.experiment.summary import summary_of
from sumo_reactive.experiment.trajectory import write_trajectory
from sumo_reactive.messages.decision import Decision
from sumo_reactive.messages.record import Scene, StepRecord

SUMMARY, TRAJECTORY, DECISIONS = "summary.json", "trajectory.parquet", "decisions.jsonl"


class Recorder:
    """Keeps the steps of a run in memory and writes them at its end: a killed run leaves nothing.

    Raises ScenarioError at once if `folder` holds a run already and `overwrite` is not asked for, or cannot be written.
    Other files in `folder` stay.
    """

    def __init__(self, folder: Path, *, overwrite: bool = False) -> None:
        self._folder = folder
        self._steps: list[StepRecord] = []
        _require_usable(folder, overwrite)

    def see(self, scene: Scene) -> None:
        """Keep one step."""
        self._steps.append(scene.step)

    def write(self, result: TrialResult) -> None:
        """Write all files under a temporary name beside the folder, then move them into place, the summary last."""
        try:
            self._folder.parent.mkdir(parents=True, exist_ok=True)
            partial = Path(tempfile.mkdtemp(prefix=f".{self._folder.name}.", suffix=".partial", dir=self._folder.parent))
        except OSError as error:
            raise ScenarioError(f"{self._folder}: cannot be written: {error.strerror}") from error
        try:
            self._write_into(partial, result)
            self._move(partial)
        finally:
            shutil.rmtree(partial, ignore_errors=True)

    def _write_into(self, partial: Path, result: TrialResult) -> None:
        write_trajectory(partial / TRAJECTORY, self._steps)
        lines = (json.dumps(line, allow_nan=False) + "\n" for line in decision_lines(self._steps))
        (partial / DECISIONS).write_text("".join(lines), encoding="utf-8")
        summary = json.dumps(summary_of(result), indent=2, allow_nan=False)
        (partial / SUMMARY).write_text(summary + "\n", encoding="utf-8")

    def _move(self, partial: Path) -> None:
        partial.chmod(0o777 & ~_umask())
        if not self._folder.exists():
            partial.rename(self._folder)
            return
        (self._folder / SUMMARY).unlink(missing_ok=True)
        for name in (TRAJECTORY, DECISIONS, SUMMARY):
            (partial / name).replace(self._folder / name)


def decision_lines(steps: Sequence[StepRecord]) -> Iterator[dict[str, object]]:
    """Yield a line where the behaviour or the set of decisions changes, and where an emergency begins."""
    last: object = None
    in_emergency = False
    for step in steps:
        now = (step.behaviour, {_without_figures(decision) for decision in step.decisions})
        began = step.emergency and not in_emergency
        if now != last or began:
            decisions = [_as_dict(decision) for decision in step.decisions]
            line = {"time_s": round(step.time, 3), "behaviour": step.behaviour, "decisions": decisions}
            yield line | ({"emergency": True} if began else {})
        last, in_emergency = now, step.emergency


def _without_figures(decision: Decision) -> tuple[object, ...]:
    return decision.behaviour, decision.reason, decision.region, decision.cause, decision.passes


def _as_dict(decision: Decision) -> dict[str, object]:
    return {
        "behaviour": decision.behaviour.value,
        "reason": decision.reason.value,
        "region": decision.region,
        "cause": decision.cause,
        "passes": decision.passes,
        "figures": {name: round(value, 3) if abs(value) < float("inf") else None for name, value in decision.figures},
    }


def _require_usable(folder: Path, overwrite: bool) -> None:
    if folder.exists() and not folder.is_dir():
        raise ScenarioError(f"{folder}: a file, not a folder for the record of a run")
    found = [name for name in (SUMMARY, TRAJECTORY, DECISIONS) if (folder / name).exists()]
    if found and not overwrite:
        raise ScenarioError(f"{folder}: holds another run ({', '.join(found)}); use --overwrite or another folder")
    existing = next(place for place in (folder, *folder.absolute().parents) if place.exists())
    if not existing.is_dir() or not os.access(existing, os.W_OK):
        raise ScenarioError(f"{folder}: cannot be written: no folder can be made in {existing}")


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
