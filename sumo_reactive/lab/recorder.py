"""The record of a trial in a folder, or of several egos in a folder each, with `fleet.json` over all."""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import tempfile
from collections import defaultdict
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import replace
from functools import cached_property, partial
from pathlib import Path
from typing import Annotated, NamedTuple
from urllib.parse import quote

from pydantic import AfterValidator, ConfigDict, Field

from sumo_reactive.driver.nouns.record import Scene, StepRecord
from sumo_reactive.driver.world.regions import ConflictRegion
from sumo_reactive.driver.world.road_graph import RoadGraph
from sumo_reactive.errors import ScenarioError
from sumo_reactive.lab.columns import STEP_TYPES, digest_of, trajectory_columns, write_columns
from sumo_reactive.lab.metrics.moment import Neighbourhood
from sumo_reactive.lab.metrics.safety.pairs import PairLog
from sumo_reactive.lab.metrics.safety.series import encounter_columns
from sumo_reactive.lab.result import FleetResult, TrialResult, changes_of, summary_of
from sumo_reactive.lab.scenario import Scenario
from sumo_reactive.lab.schema import RECORD_VERSION, Keys, Number, read_json, require_version
from sumo_reactive.lab.surroundings_record import SURROUNDINGS, USERS, SurroundingsRecord
from sumo_reactive.lab.trace import entries, line_of
from sumo_reactive.lab.under_way import Teller
from sumo_reactive.writing import require_writable, whole_folder


def write_trajectory(path: Path, steps: Sequence[StepRecord]) -> None:
    """Write `steps` as a Parquet file; raise what `write_columns` raises."""
    write_columns(path, trajectory_columns(steps), STEP_TYPES)


FLEET = "fleet.json"

FLEET_MEANINGS = {
    "version": "of the files of a record",
    "exit_code": "0: no ego has a fault; else 1",
    "until_s": "simulation time at the end",
    "egos": "each ego with the `folder` of its own record, its `verdict` and its metrics",
    "overrides": "what was changed in the scenario",
    "recounts": "what was put right in SUMO's own outputs",
    "refused": "vehicles that could not be taken over, and why",
    "timing": "wall-clock figures: of an ego and step, of the whole simulation",
}
"""Keys of FLEET."""

_LONGEST, _KEPT = 100, 80
"""Letters of a folder's name at most, and how many of a longer one stay before its digest."""

_SYSTEM_NAMES = {"con", "prn", "aux", "nul", *(f"{port}{k}" for port in ("com", "lpt") for k in range(1, 10))}
"""What is a device on some systems, with whatever suffix."""


class EgoFolders:
    """A folder's name for each ego id: two ids never share one, also where a file system does not tell capitals apart.

    A name is the id with all but letters, digits and `._-` percent-encoded; where it is too long, or another's but for
    capitals, it ends with `~` and a digest of the id. `taken` are names of files beside the folders.
    """

    def __init__(self, taken: Collection[str]) -> None:
        self._taken = {name.casefold() for name in taken}
        self._names: dict[str, str] = {}

    def of(self, ego_id: str) -> str:
        """Return the name of an ego's folder, the same every time."""
        if ego_id not in self._names:
            name = _encoded(ego_id)
            if len(name) > _LONGEST or name.casefold() in self._taken:
                digest = hashlib.sha256(ego_id.encode("utf-8", errors="surrogatepass")).hexdigest()
                name = f"{name[:_KEPT]}~{digest[:16]}"
            self._taken.add(name.casefold())
            self._names[ego_id] = name
        return self._names[ego_id]


def _encoded(ego_id: str) -> str:
    name = quote(ego_id, safe="", errors="surrogatepass").replace("~", "%7E")
    if name.startswith(".") or name.partition(".")[0].casefold() in _SYSTEM_NAMES:
        name = f"%{ord(name[0]):02X}{name[1:]}"
    return f"{name[:-1]}%2E" if name.endswith(".") else name or "%"


def _folder_name(name: str) -> str:
    """Return a record's word for an ego's folder, which is the name of one in the record's own folder."""
    if name in ("", ".", "..") or any(sign in name for sign in "/\\\0"):
        raise ValueError("an ego's folder is no name")
    return name


class FleetEgoKeys(Keys):
    """An ego in `fleet.json`, with its metrics beside."""

    model_config = ConfigDict(extra="allow")
    __pydantic_extra__: dict[str, Number | None]

    ego: Annotated[str, Field(min_length=1)]
    folder: Annotated[str, AfterValidator(_folder_name)]
    verdict: Annotated[str, Field(min_length=1)]


class RefusedKeys(Keys):
    """A vehicle that could not be taken over."""

    vehicle: str
    reason: str


class FleetKeys(Keys):
    """`fleet.json`."""

    version: int = 0
    egos: list[FleetEgoKeys]
    refused: list[RefusedKeys]


def read_fleet(folder: Path) -> FleetKeys:
    """Return what the `fleet.json` in a folder says; raise ScenarioError if it is no record of several egos of today."""
    found = _fleet_in(folder)
    require_version(found.version, RECORD_VERSION, str(folder / FLEET))
    return found


def _fleet_in(folder: Path) -> FleetKeys:
    return read_json(folder / FLEET, FleetKeys, "the record of several egos")


SUMMARY, TRAJECTORY, ENCOUNTERS, DECISIONS, REGIONS, SAID = (
    "summary.json", "trajectory.parquet", "encounters.parquet", "decisions.jsonl", "regions.json", "said.jsonl",
)  # fmt: skip
FILES = {
    SUMMARY: "what the trip came to; a fault has `time_s`, `user_id` and `lane_id`, a violation its `kind`, too",
    TRAJECTORY: "the ego: a row a simulation step",
    ENCOUNTERS: "surrogate safety measures: a row a step and road user ahead, behind, beside or on collision course",
    DECISIONS: "the pilot: a line where behaviour, instruction or the set of decisions changes, or an emergency begins",
    REGIONS: "the outline of each conflict region that the decisions name, by id: points [x, y], m",
    USERS: "the others: a row a step and road user whom the driver looked at, or near: within 150 m, of several egos 40 m",
    SURROUNDINGS: "the roads around, lights, C, places to stop at, U over the commands at each decision, or at every step",
    SAID: "of a driver of yours that tells its reasons alone: a line where its reason changes, `time_s` and `reason`",
}
"""The files of a run, and what each holds."""

PAGE = "report.html"
"""The page that `report` writes beside them."""


class _Record:
    """The steps of an ego, who was near in them, and the worlds in which it drove them."""

    def __init__(self, *, every_field: bool = False) -> None:
        self._steps: list[StepRecord] = []
        self._worlds: list[RoadGraph] = []
        self._surroundings = SurroundingsRecord(every_field=every_field)
        self._neighbourhood, self._log = Neighbourhood(), PairLog()

    def see(self, scene: Scene) -> None:
        self._steps.append(scene.step)
        self._surroundings.see(scene)
        self._log.see(self._neighbourhood.look(scene))
        if scene.world is not None and scene.world not in self._worlds[-1:]:
            self._worlds.append(scene.world)

    def write_into(self, folder: Path, result: TrialResult) -> None:
        """Write all files into a folder, one after another. Raises OSError."""
        write_columns(folder / ENCOUNTERS, encounter_columns(self._log, result.length_m, result.width_m))
        self.write_so_far(folder, summary_of(replace(result, trajectory=digest_of(self._steps))))

    def write_so_far(self, folder: Path, summary: Mapping[str, object]) -> None:
        """Write what is there before a run has been judged, the summary last. Raises OSError."""
        write_trajectory(folder / TRAJECTORY, self._steps)
        lines = (json.dumps(line_of(entry), allow_nan=False) + "\n" for entry in entries(self._steps))
        (folder / DECISIONS).write_text("".join(lines), encoding="utf-8")
        _write_json(folder / REGIONS, {region.id: region.polygon.round(3).tolist() for region in self._regions_named()})
        self._surroundings.write_into(folder)
        if reasons := reasons_in(self._steps):
            told = (json.dumps({"time_s": round(time, 3), "reason": reason}) + "\n" for time, reason in reasons)
            (folder / SAID).write_text("".join(told), encoding="utf-8")
        _write_json(folder / SUMMARY, summary, indent=2)

    def _regions_named(self) -> Iterator[ConflictRegion]:
        named = {state.region for step in self._steps for state in step.regions}
        named |= {decision.region for step in self._steps for decision in step.decisions}
        known = (region for world in self._worlds for region in world.regions.values())
        return (region for region in known if region.id in named)


def reasons_in(steps: Sequence[StepRecord]) -> list[tuple[float, str]]:
    """Return from when on (s) a driver of the user's gave which reason, without those before its first."""
    befores = (None, *(step.reason for step in steps))
    changes = [step for before, step in zip(befores, steps, strict=False) if step.reason != before]
    return [(step.time, step.reason) for step in changes] if any(step.reason for step in changes) else []


class Recorder:
    """Keeps the steps of an ego in memory and writes them at the end of the run: a killed run leaves nothing.

    `every_field`: U over the commands at every step, not at decisions only, and over the ground at decisions. Of a
    `scenario` that is named, what there is so far is told to who asks. Raises what `replaced_in` raises.
    """

    def __init__(
        self, folder: Path, *, overwrite: bool = False, every_field: bool = False, scenario: Scenario | None = None
    ) -> None:
        self._folder = folder
        self._replaced = replaced_in(folder, overwrite)
        self._record = _Record(every_field=every_field)
        told = {"version": RECORD_VERSION, "scenario": str(scenario.source), "seed": scenario.seed} if scenario else {}
        self._teller = Teller(folder, told, self._record.write_so_far) if scenario else None

    def see(self, scene: Scene) -> None:
        """Keep one step."""
        self._record.see(scene)
        if self._teller is not None:
            self._teller.see(scene.ego, scene.step.time)

    def write(self, result: TrialResult) -> None:
        """Write all files or none, in place of the run that is there; raise OutputError if that cannot be done."""
        with whole_folder(self._folder, SUMMARY, self._replaced) as partial:
            self._record.write_into(partial, result)
        if self._teller is not None:
            self._teller.close()


class Shelf(NamedTuple):
    """A folder where other processes leave what they have recorded of their egos."""

    folder: Path
    every_field: bool

    def place_of(self, ego_id: str) -> Path:
        """Return the folder of an ego."""
        return self.folder / hashlib.sha256(ego_id.encode("utf-8", errors="surrogatepass")).hexdigest()

    def recorder(self) -> ShelfRecorder:
        """Return what records the egos of a process."""
        return ShelfRecorder(self)


class _Records:
    """The records of several egos, in memory."""

    def __init__(self, *, every_field: bool) -> None:
        self._records: defaultdict[str, _Record] = defaultdict(partial(_Record, every_field=every_field))

    def see(self, scene: Scene) -> None:
        """Keep one step of one ego."""
        self._records[scene.ego].see(scene)


class ShelfRecorder(_Records):
    """Keeps the steps of some egos in memory, and leaves them on a shelf at the end of the run."""

    def __init__(self, shelf: Shelf) -> None:
        super().__init__(every_field=shelf.every_field)
        self._shelf = shelf

    def write(self, results: Sequence[TrialResult]) -> None:
        """Write the folders of these trips, as far as they were seen here. Raises OSError."""
        for result in results:
            if result.ego in self._records:
                place = self._shelf.place_of(result.ego)
                place.mkdir()
                self._records[result.ego].write_into(place, result)


class FleetRecorder(_Records):
    """Keeps the steps of all egos in memory and writes them at the end of the run; what other processes have recorded it
    takes from the `shelf`.

    Raises at once what `Recorder` raises, and ScenarioError if a folder in `folder` holds a run that may not be replaced.
    """

    def __init__(self, folder: Path, *, overwrite: bool = False, every_field: bool = False) -> None:
        super().__init__(every_field=every_field)
        self._folder = folder
        self._every_field, self._left = every_field, ExitStack()
        self._replaced = replaced_in(folder, overwrite)
        if not overwrite and (other := next(folder.glob(f"*/{SUMMARY}"), None)):
            raise ScenarioError(f"{other.parent}: holds another run; use --overwrite or another folder than {folder}")

    @cached_property
    def shelf(self) -> Shelf:
        """Where other processes leave what they record, until it is written."""
        folder = self._left.enter_context(tempfile.TemporaryDirectory(prefix="sumo_reactive_"))
        return Shelf(Path(folder), self._every_field)

    def write(self, fleet: FleetResult) -> None:
        """Write the folder of each ego and what all came to, or nothing; raise OutputError if that cannot be done."""
        names = EgoFolders((FLEET, *FILES, PAGE))
        with self._left, whole_folder(self._folder, FLEET, self._replaced) as partial:
            for result in fleet.results:
                own = partial / names.of(result.ego)
                if self._is_left(result.ego):
                    shutil.move(self.shelf.place_of(result.ego), own)
                    continue
                own.mkdir()
                self._records[result.ego].write_into(own, result)
            _write_json(partial / FLEET, fleet_summary(fleet, names.of), indent=2)

    def _is_left(self, ego_id: str) -> bool:
        return "shelf" in self.__dict__ and self.shelf.place_of(ego_id).is_dir()


def _write_json(path: Path, data: object, indent: int | None = None) -> None:
    path.write_text(json.dumps(data, indent=indent, allow_nan=False) + "\n", encoding="utf-8")


def replaced_in(folder: Path, overwrite: bool) -> list[Path]:
    """Return the files of the run, of one ego or of several, that another would replace in a folder: paths in it.

    Raises ScenarioError if there are some and `overwrite` is not asked for, OutputError if the folder cannot be written to.
    """
    require_writable(folder, is_folder=True)
    found = [name for name in (FLEET, *FILES) if os.path.lexists(folder / name)]
    if found and not overwrite:
        raise ScenarioError(f"{folder}: holds another run ({', '.join(found)}); use --overwrite or another folder")
    places = [".", *((one.folder for one in _fleet_in(folder).egos) if FLEET in found else ())]
    candidates = [Path(place, name) for place in places for name in (FLEET, *FILES, PAGE)] if found else []
    return [path for path in candidates if os.path.lexists(folder / path)]


def fleet_summary(fleet: FleetResult, folder_of: Callable[[str], str]) -> dict[str, object]:
    """Return what all egos came to as plain data, units in the keys, wall-clock figures under `timing`."""
    return {
        "version": RECORD_VERSION,
        "exit_code": fleet.exit_code,
        "until_s": fleet.until,
        "egos": [
            {"ego": one.ego, "folder": folder_of(one.ego), "verdict": one.verdict, **one.metrics} for one in fleet.results
        ],
        **changes_of(fleet),
        "refused": [{"vehicle": name, "reason": reason} for name, reason in fleet.refused],
        "timing": {"ego_step_us": round(fleet.step_us, 1), "wall_s": round(fleet.wall_s, 2)},
    }
