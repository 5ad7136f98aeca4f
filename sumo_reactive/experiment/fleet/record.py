"""The record of several egos in a folder: one folder an ego, and `fleet.json` over all."""

from __future__ import annotations

import json
import re
from pathlib import Path

from sumo_reactive.experiment.fleet.fleet import FleetResult
from sumo_reactive.experiment.recorder import Recorder
from sumo_reactive.experiment.summary import overrides_of, recounts_of
from sumo_reactive.messages.record import Scene
from sumo_reactive.world.road_graph import RoadGraph

FLEET = "fleet.json"

_NOT_IN_A_NAME = re.compile(r'[/\\:*?"<>|\s]')


class FleetRecorder:
    """Keeps the steps of all egos in memory and writes them at the end of the run; raises what `Recorder` raises."""

    def __init__(self, folder: Path, *, overwrite: bool = False) -> None:
        self._folder, self._overwrite = folder, overwrite
        self._recorders: dict[str, Recorder] = {}
        self._own = Recorder(folder, overwrite=overwrite)  # is the folder usable?

    def see(self, ego_id: str, scene: Scene) -> None:
        """Keep one step of one ego."""
        if ego_id not in self._recorders:
            self._recorders[ego_id] = Recorder(self._folder / folder_name(ego_id), overwrite=self._overwrite)
        self._recorders[ego_id].see(scene)

    def survey(self, ego_id: str, graph: RoadGraph) -> None:
        """Keep a world that an ego has driven in."""
        if ego_id in self._recorders:
            self._recorders[ego_id].survey(graph)

    def write(self, fleet: FleetResult) -> None:
        """Write the folder of each ego, and last what all came to."""
        for result in fleet.results:
            if result.ego in self._recorders:
                self._recorders[result.ego].write(result)
        self._folder.mkdir(parents=True, exist_ok=True)
        summary = json.dumps(fleet_summary(fleet), indent=2, allow_nan=False)
        (self._folder / FLEET).write_text(summary + "\n", encoding="utf-8")


def folder_name(ego_id: str) -> str:
    """Return the name of an ego's folder: its id without what a file system might not take."""
    return _NOT_IN_A_NAME.sub("_", ego_id)


def fleet_summary(fleet: FleetResult) -> dict[str, object]:
    """Return what all egos came to as plain data, units in the keys, wall-clock figures under `timing`."""
    return {
        "exit_code": fleet.exit_code,
        "until_s": fleet.until,
        "egos": [{"ego": one.ego, "verdict": one.verdict, **one.metrics} for one in fleet.results],
        "overrides": overrides_of(fleet.overrides),
        "recounts": recounts_of(fleet.recounts),
        "refused": [{"vehicle": name, "reason": reason} for name, reason in fleet.refused],
        "timing": {"ego_step_us": round(fleet.step_us, 1), "wall_s": round(fleet.wall_s, 2)},
    }
