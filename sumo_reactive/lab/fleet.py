"""Several egos in one simulation, driven by one process or by several with the same simulation."""

from __future__ import annotations

import os
import tempfile
import time as clock
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

from sumo_reactive.errors import ScenarioError
from sumo_reactive.lab.crew import Crew, Part, Shelve
from sumo_reactive.lab.drivers.choice import SUMO
from sumo_reactive.lab.drivers.loading import is_of_parts
from sumo_reactive.lab.ego_rule import EgoRule
from sumo_reactive.lab.peers import Peers
from sumo_reactive.lab.recorder import Shelf
from sumo_reactive.lab.result import FleetResult, TrialResult
from sumo_reactive.lab.scenario import Scenario
from sumo_reactive.lab.simulation import AnyTrip, SceneObserver, Simulation, Started, recounted, started, taking_over
from sumo_reactive.lab.sumo_driver import WatchedTrip, as_told, trip_output
from sumo_reactive.lab.worlds import Worlds
from sumo_reactive.sumo.launch import passed_end
from sumo_reactive.sumo.muting import mute, prefix_of, with_prefix
from sumo_reactive.sumo.net_reader import read_net
from sumo_reactive.sumo.recount import TripFiles, trip_files
from sumo_reactive.sumo.sensor import Sensor
from sumo_reactive.sumo.session import Progress


class _Order(NamedTuple):
    """What another process drives, and where it keeps what it records (None: it records nothing)."""

    scenario: Scenario
    rule: EgoRule
    shelf: Shelf | None


class Running(NamedTuple):
    """How several egos are run: with SUMO's window, by how many processes, and where the others leave what they record."""

    has_window: bool = False
    cores: int = 1
    shelf: Shelf | None = None


ONE_PROCESS = Running()


def run_fleet(
    scenario: Scenario, rule: EgoRule, *, observer: SceneObserver | None = None, progress: Progress | None = None,
    may_be_nobody: bool = False, running: Running = ONE_PROCESS,
) -> FleetResult:  # fmt: skip
    """Run the scenario with every vehicle that `rule` chooses as an ego, until none can be left.

    Nobody is taken over after the scenario's end; who is under way then drives on, to `until_s` at the latest. With several
    cores as many processes have the simulation and drive an equal part of the egos each, to the same bits; a script that
    asks for it begins under `if __name__ == "__main__"`. `observer` gets the scenes of this process's egos; the others
    record theirs on the shelf of a `FleetRecorder`, if there is one.

    Raises what `run_trial` raises; a vehicle that is not named and cannot be taken over is no error, nobody at all is one
    unless there `may_be_nobody`.
    """
    began, is_watched, (has_window, cores, shelf) = clock.perf_counter(), scenario.driver == SUMO, running
    if cores > 1 and (has_window or is_watched or not is_of_parts(scenario.driver)):
        raise ScenarioError(f"{scenario.source}: several processes drive without a window, with this program's driver alone")
    crew = Crew(cores - 1, _drive, _Order(scenario, rule, shelf))
    with tempfile.TemporaryDirectory(prefix="sumo_reactive_") as folder, crew:
        options, trips = trip_output(scenario.sumo_options, Path(folder)) if is_watched else ([], Path())
        with started(scenario, options, has_window=has_window, takes_over_many=True) as start:
            simulation = Simulation(start, scenario, _fleet_taker(scenario, start), observer, progress, rule)
            simulation.share_with(crew.hub)
            simulation.run()
            files = trip_files()
            all_of_them = _together([_part_of(simulation), *crew.parts()])
            if not may_be_nobody:
                _require_egos(all_of_them, simulation.ended, rule, scenario)
        results = _told(all_of_them, files, trips if is_watched else None)
        crew.shelve(results)
        return FleetResult(
            results=tuple(results),
            refused=tuple(all_of_them.refused),
            on_their_way=frozenset(all_of_them.cut_short),
            until=simulation.ended,
            step_us=1e6 * simulation.busy_s / max(all_of_them.ego_steps, 1),
            wall_s=clock.perf_counter() - began,
            overrides=(*start.overrides, *passed_end(start.config, simulation.ended, scenario.sumo_options)),
        )


def _drive(peers: Peers, order: _Order) -> tuple[Part, Shelve | None]:
    """Drive this process's part of the egos."""
    scenario, rule, shelf = order
    recorder, prefix = shelf.recorder() if shelf else None, prefix_of(os.getpid())
    silent = replace(scenario, sumo_options=with_prefix(scenario.sumo_options, prefix))
    with started(silent, takes_over_many=True) as start:
        mute(prefix)
        taker, observer = _fleet_taker(scenario, start), recorder.see if recorder else None
        simulation = Simulation(start, scenario, taker, observer, None, rule)
        simulation.share_with(peers)
        simulation.run()
        mute(prefix)
    return _part_of(simulation), recorder.write if recorder else None


def _part_of(simulation: Simulation) -> Part:
    return Part(
        simulation.results, simulation.refused, simulation.cut_short, simulation.placed, simulation.ego_steps
    )


def _together(parts: Sequence[Part]) -> Part:
    """Return what all egos have come to, in order of departure."""
    results, refused, cut_short, placed, steps = zip(*parts, strict=True)
    return Part(
        sorted((one for some in results for one in some), key=lambda one: (one.departure_s, one.ego)),
        sorted(one for some in refused for one in some), set().union(*cut_short), set().union(*placed), sum(steps),
    )  # fmt: skip


def _told(part: Part, files: TripFiles, trips: Path | None) -> list[TrialResult]:
    """Return the results as SUMO's `trips` tell of those whom it has driven itself, or with what is put right there."""
    return recounted(files, part.results, part.placed) if trips is None else list(as_told(part.results, trips))


def _fleet_taker(scenario: Scenario, start: Started) -> Callable[[str], AnyTrip]:
    """Return what begins the trip of each ego of several."""
    session, net_file = start.session, start.config.net_file
    if scenario.driver == SUMO:
        return lambda ego: WatchedTrip(session, ego, net_file, scenario.parameters.stuck_s)
    taken_over, worlds, sensor = taking_over(scenario), Worlds(read_net(net_file)), Sensor(scenario.obstacle_polygons)
    return lambda ego: taken_over(session, ego, worlds, sensor)


def _require_egos(part: Part, ended: float, rule: EgoRule, scenario: Scenario) -> None:
    """Raise ScenarioError for a named ego that never came, or if there was none at all, or none that could be driven."""
    driven, until = {result.ego for result in part.results}, f"before {ended:.1f} s, where the run ends"
    for name in rule.ids:
        if name not in driven:
            raise ScenarioError(f"{scenario.source}: ego '{name}' never departs {until}")
    if part.results:
        return
    if part.refused:
        (first, reason), many = part.refused[0], len(part.refused)
        raise ScenarioError(f"{scenario.source}: none of {many} vehicles chosen can be taken over; '{first}': {reason}")
    raise ScenarioError(f"{scenario.source}: no vehicle is chosen as an ego {until}")
