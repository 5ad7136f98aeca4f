"""The record of a trial in a folder: `summary.json`, `trajectory.parquet`, `decisions.jsonl`, `regions.json`."""

from __future__ import annotations

import json
import os
import shutil
import tempfile
from collections.abc import Iterator
from pathlib import Path

from sumo_reactive.errors import ScenarioError
from sumo_reactive.experiment.result import TrialResult
from sumo_reactive.experiment.summary import summary_of
from sumo_reactive.experiment.trace import entries, line_of
from sumo_reactive.experiment.trajectory import write_trajectory
from sumo_reactive.messages.record import Scene, StepRecord
from sumo_reactive.world.regions import ConflictRegion
from sumo_reactive.world.road_graph import RoadGraph

SUMMARY, TRAJECTORY, DECISIONS, REGIONS = "summary.json", "trajectory.parquet", "decisions.jsonl", "regions.json"


class Recorder:
    """Keeps the steps of a run in memory and writes them at its end: a killed run leaves nothing.

    Raises ScenarioError at once if `folder` holds a run already and `overwrite` is not asked for, or cannot be written.
    Other files in `folder` stay.
    """

    def __init__(self, folder: Path, *, overwrite: bool = False) -> None:
        self._folder = folder
        self._steps: list[StepRecord] = []
        self._graphs: list[RoadGraph] = []
        _require_usable(folder, overwrite)

    def see(self, scene: Scene) -> None:
        """Keep one step."""
        self._steps.append(scene.step)

    def survey(self, graph: RoadGraph) -> None:
        """Keep the world of a route, for the outlines of the conflict regions that the steps name."""
        self._graphs.append(graph)

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
        lines = (json.dumps(line_of(entry), allow_nan=False) + "\n" for entry in entries(self._steps))
        (partial / DECISIONS).write_text("".join(lines), encoding="utf-8")
        outlines = {region.id: region.polygon.round(3).tolist() for region in self._regions_named()}
        (partial / REGIONS).write_text(json.dumps(outlines, allow_nan=False) + "\n", encoding="utf-8")
        summary = json.dumps(summary_of(result), indent=2, allow_nan=False)
        (partial / SUMMARY).write_text(summary + "\n", encoding="utf-8")

    def _regions_named(self) -> Iterator[ConflictRegion]:
        named = {state.region for step in self._steps for state in step.regions}
        named |= {decision.region for step in self._steps for decision in step.decisions}
        of_connections = (regions for graph in self._graphs for regions in graph.regions.values())
        return (region for regions in of_connections for region in regions if region.id in named)

    def _move(self, partial: Path) -> None:
        partial.chmod(0o777 & ~_umask())
        if not self._folder.exists():
            partial.rename(self._folder)
            return
        (self._folder / SUMMARY).unlink(missing_ok=True)
        for name in (TRAJECTORY, DECISIONS, REGIONS, SUMMARY):
            (partial / name).replace(self._folder / name)


def _require_usable(folder: Path, overwrite: bool) -> None:
    if folder.exists() and not folder.is_dir():
        raise ScenarioError(f"{folder}: a file, not a folder for the record of a run")
    found = [name for name in (SUMMARY, TRAJECTORY, DECISIONS, REGIONS) if (folder / name).exists()]
    if found and not overwrite:
        raise ScenarioError(f"{folder}: holds another run ({', '.join(found)}); use --overwrite or another folder")
    existing = next(place for place in (folder, *folder.absolute().parents) if place.exists())
    if not existing.is_dir() or not os.access(existing, os.W_OK):
        raise ScenarioError(f"{folder}: cannot be written: no folder can be made in {existing}")


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
