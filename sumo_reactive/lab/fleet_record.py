"""The record of several egos in a folder: one folder an ego, and `fleet.json` over all."""

from __future__ import annotations

import json
from collections import defaultdict
from collections.abc import Callable
from pathlib import Path

from sumo_reactive.driver.nouns.record import Scene
from sumo_reactive.driver.world.road_graph import RoadGraph
from sumo_reactive.errors import ScenarioError
from sumo_reactive.lab.ego_folders import FLEET, EgoFolders
from sumo_reactive.lab.recorder import DECISIONS, PAGE, REGIONS, SUMMARY, TRAJECTORY, Record, replaced_in
from sumo_reactive.lab.result import FleetResult
from sumo_reactive.lab.summary import overrides_of, recounts_of
from sumo_reactive.writing import whole_folder


class FleetRecorder:
    """Keeps the steps of all egos in memory and writes them at the end of the run.

    Raises at once what `Recorder` raises, and ScenarioError if a folder in `folder` holds a run that may not be replaced.
    """

    def __init__(self, folder: Path, *, overwrite: bool = False) -> None:
        self._folder = folder
        self._records: defaultdict[str, Record] = defaultdict(Record)
        self._replaced = replaced_in(folder, overwrite)
        if not overwrite and (other := next(folder.glob(f"*/{SUMMARY}"), None)):
            raise ScenarioError(f"{other.parent}: holds another run; use --overwrite or another folder than {folder}")

    def see(self, ego_id: str, scene: Scene) -> None:
        """Keep one step of one ego."""
        self._records[ego_id].see(scene)

    def survey(self, ego_id: str, graph: RoadGraph) -> None:
        """Keep a world that an ego has driven in."""
        self._records[ego_id].survey(graph)

    def write(self, fleet: FleetResult) -> None:
        """Write the folder of each ego and what all came to, or nothing; raise OutputError if that cannot be done."""
        names = EgoFolders((FLEET, SUMMARY, TRAJECTORY, DECISIONS, REGIONS, PAGE))
        with whole_folder(self._folder, FLEET, self._replaced) as partial:
            for result in fleet.results:
                own = partial / names.of(result.ego)
                own.mkdir()
                self._records[result.ego].write_into(own, result)
            summary = json.dumps(fleet_summary(fleet, names.of), indent=2, allow_nan=False)
            (partial / FLEET).write_text(summary + "\n", encoding="utf-8")


def fleet_summary(fleet: FleetResult, folder_of: Callable[[str], str]) -> dict[str, object]:
    """Return what all egos came to as plain data, units in the keys, wall-clock figures under `timing`."""
    return {
        "exit_code": fleet.exit_code,
        "until_s": fleet.until,
        "egos": [
            {"ego": one.ego, "folder": folder_of(one.ego), "verdict": one.verdict, **one.metrics} for one in fleet.results
        ],
        "overrides": overrides_of(fleet.overrides),
        "recounts": recounts_of(fleet.recounts),
        "refused": [{"vehicle": name, "reason": reason} for name, reason in fleet.refused],
        "timing": {"ego_step_us": round(fleet.step_us, 1), "wall_s": round(fleet.wall_s, 2)},
    }
