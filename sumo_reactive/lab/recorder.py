"""The record of a trial in a folder: `summary.json`, `trajectory.parquet`, `decisions.jsonl`, `regions.json`."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from pathlib import Path

from sumo_reactive.driver.nouns.record import Scene, StepRecord
from sumo_reactive.driver.world.regions import ConflictRegion
from sumo_reactive.driver.world.road_graph import RoadGraph
from sumo_reactive.errors import ScenarioError
from sumo_reactive.lab.ego_folders import FLEET, folders_in
from sumo_reactive.lab.result import TrialResult
from sumo_reactive.lab.summary import summary_of
from sumo_reactive.lab.trace import entries, line_of
from sumo_reactive.lab.trajectory import write_trajectory
from sumo_reactive.writing import require_writable, whole_folder

SUMMARY, TRAJECTORY, DECISIONS, REGIONS = "summary.json", "trajectory.parquet", "decisions.jsonl", "regions.json"

PAGE = "report.html"
"""The page that `report` writes beside them."""


class Record:
    """The steps of an ego, kept in memory until its trip is judged."""

    def __init__(self) -> None:
        self._steps: list[StepRecord] = []
        self._graphs: list[RoadGraph] = []

    def see(self, scene: Scene) -> None:
        """Keep one step."""
        self._steps.append(scene.step)

    def survey(self, graph: RoadGraph) -> None:
        """Keep the world of a route, for the outlines of the conflict regions that the steps name."""
        self._graphs.append(graph)

    def write_into(self, folder: Path, result: TrialResult) -> None:
        """Write all files into a folder, one after another. Raises OSError."""
        write_trajectory(folder / TRAJECTORY, self._steps)
        lines = (json.dumps(line_of(entry), allow_nan=False) + "\n" for entry in entries(self._steps))
        (folder / DECISIONS).write_text("".join(lines), encoding="utf-8")
        outlines = {region.id: region.polygon.round(3).tolist() for region in self._regions_named()}
        (folder / REGIONS).write_text(json.dumps(outlines, allow_nan=False) + "\n", encoding="utf-8")
        summary = json.dumps(summary_of(result), indent=2, allow_nan=False)
        (folder / SUMMARY).write_text(summary + "\n", encoding="utf-8")

    def _regions_named(self) -> Iterator[ConflictRegion]:
        named = {state.region for step in self._steps for state in step.regions}
        named |= {decision.region for step in self._steps for decision in step.decisions}
        of_connections = (regions for graph in self._graphs for regions in graph.regions.values())
        return (region for regions in of_connections for region in regions if region.id in named)


class Recorder(Record):
    """A record that is written at the end of the run: a killed run leaves nothing. Raises what `replaced_in` raises."""

    def __init__(self, folder: Path, *, overwrite: bool = False) -> None:
        super().__init__()
        self._folder = folder
        self._replaced = replaced_in(folder, overwrite)

    def write(self, result: TrialResult) -> None:
        """Write all files or none, in place of the run that is there; raise OutputError if that cannot be done."""
        with whole_folder(self._folder, SUMMARY, self._replaced) as partial:
            self.write_into(partial, result)


def replaced_in(folder: Path, overwrite: bool) -> list[Path]:
    """Return the files of the run, of one ego or of several, that another would replace in a folder: paths in it.

    Raises ScenarioError if there are some and `overwrite` is not asked for, OutputError if the folder cannot be written to.
    """
    require_writable(folder, is_folder=True)
    files = (SUMMARY, TRAJECTORY, DECISIONS, REGIONS)
    found = [name for name in (FLEET, *files) if os.path.lexists(folder / name)]
    if found and not overwrite:
        raise ScenarioError(f"{folder}: holds another run ({', '.join(found)}); use --overwrite or another folder")
    places = [".", *(folders_in(folder / FLEET) if FLEET in found else [])]
    candidates = [Path(place, name) for place in places for name in (FLEET, *files, PAGE)] if found else []
    return [path for path in candidates if os.path.lexists(folder / path)]
