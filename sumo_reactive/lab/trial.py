"""One trial: a scenario in, a judged result out."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numba
import numpy

from sumo_reactive import __version__
from sumo_reactive.driver.compilation import is_cached, mark_cached
from sumo_reactive.driver.nouns.record import Scene
from sumo_reactive.driver.parameters import STUCK_S
from sumo_reactive.driver.world.road_graph import RoadGraph
from sumo_reactive.errors import ScenarioError
from sumo_reactive.lab.metrics import Jury
from sumo_reactive.lab.result import TrialResult
from sumo_reactive.lab.scenario import Scenario, require_parameters
from sumo_reactive.lab.start import Started, started
from sumo_reactive.lab.trip import Trip
from sumo_reactive.sumo.config import SumoConfig, read_config
from sumo_reactive.sumo.launch import passed_end
from sumo_reactive.sumo.net_reader import NetFile, read_net
from sumo_reactive.sumo.recount import Driven, TripFiles, put_right, trip_files
from sumo_reactive.sumo.sensor import Sensor
from sumo_reactive.sumo.session import Progress, Session, is_road_car, sumo_version, type_of

Observer = Callable[[Scene], None]
Survey = Callable[[RoadGraph], None]

EGO = "ego"
"""Without an ego's id, a vehicle or type of this name is driven."""


def run_trial(
    scenario: Scenario,
    *,
    observer: Observer | None = None,
    progress: Progress | None = None,
    survey: Survey | None = None,
) -> TrialResult:
    """Run the scenario in this process until the ego has arrived; return the judged result.

    `observer` gets every scene, `progress` simulation time (s) and a text, `survey` the world of each route driven, at the
    end. Raises ScenarioError or NetworkError for what cannot be run, SimulationError if SUMO fails on the way.
    """
    require_parameters(scenario)
    net = read_net(read_config(scenario.config).net_file)
    with started(scenario) as start:
        session = start.session
        ego_id, chosen = find_ego(session, scenario, start.config, progress)
        trip, jury, ended = _drive(session, ego_id, net, scenario, observer, progress)
        if survey is not None:
            for graph in trip.graphs:
                survey(graph)
        if scenario.until_end:
            if not trip.arrived:
                trip.release()
            session.play_out(scenario.end_after(trip.departure), progress)
        files, result = trip_files(), result_of(scenario, trip, jury, start, chosen, ended)
    return recounted(files, [result])[0]


def _drive(
    session: Session, ego_id: str, net: NetFile, scenario: Scenario, observer: Observer | None, progress: Progress | None
) -> tuple[Trip, Jury, str]:
    """Drive the ego; return the trip, the jury that watched it, and why it ended."""
    trip = Trip(session, ego_id, net, scenario.profile, scenario.delays, Sensor(scenario.obstacle_polygons))
    first_time = not is_cached()
    until = scenario.end_after(trip.departure)
    limits = trip.ego.limits
    jury = Jury(limits.length, limits.width, limits.wheelbase, trip.graph)
    for scene in trip.scenes():
        jury.see(scene)
        jury.enter(trip.graph)
        if observer is not None:
            observer(scene)
        if progress is not None:
            progress(scene.step.time, scene.step.behaviour)
        if first_time:
            mark_cached()
            first_time = False
        if until is not None and scene.step.time >= until:
            return trip, jury, "arrived" if trip.arrived else f"until {until:g} s"
    return trip, jury, "arrived" if trip.arrived else f"stood still for {STUCK_S:g} s: {trip.stuck}"


def find_ego(session: Session, scenario: Scenario, config: SumoConfig, progress: Progress | None) -> tuple[str, str]:
    """Step until the ego departs; return its id and how it was chosen."""
    if scenario.ego is not None:
        name = scenario.ego
        found = session.wait_for(lambda vehicle_id: vehicle_id == name, scenario.until_s, progress, name)
        chosen = "as named"
    elif config.mentions((b'id="ego"', b'type="ego"')):
        found = session.wait_for(lambda vehicle_id: EGO in (vehicle_id, type_of(vehicle_id)), scenario.until_s, progress)
        chosen = f"vehicle or type '{EGO}'"
    else:
        found = session.wait_for(is_road_car, scenario.until_s, progress)
        chosen = "the first car to depart"
    if found:
        return found, chosen
    if scenario.ego is not None:
        raise ScenarioError(f"{scenario.source}: {session.why_not(scenario.ego)}")
    raise ScenarioError(f"{scenario.source}: no car departs before {session.time:.1f} s")


def result_of(
    scenario: Scenario, trip: Trip, jury: Jury, start: Started, chosen: str, ended: str
) -> TrialResult:
    """Return what a trip has come to; `chosen`: how the ego was, `ended`: why it ended."""
    return TrialResult(
        scenario=str(scenario.source),
        ego=trip.ego.id,
        chosen=chosen,
        seed=scenario.seed,
        step_length_s=trip.step_length,
        profile=scenario.profile.value,
        arrived=trip.arrived,
        ended=ended,
        begin_s=start.begin,
        departure_s=trip.departure,
        end_s=trip.end,
        time_loss_s=trip.time_loss,
        distance_m=trip.distance,
        figures=jury.figures(),
        timing=jury.timing(),
        collisions=jury.collisions,
        violations=jury.violations,
        hard_brakes=jury.hard_brakes,
        overrides=(*start.overrides, *passed_end(start.config, trip.end, scenario.sumo_options)),
        versions=versions(),
        ghosts=trip.ghosts_made,
        stopped_s=trip.stopped,
    )


def recounted(files: TripFiles, results: Sequence[TrialResult]) -> list[TrialResult]:
    """Put the egos' figures right in the outputs of a simulation that has ended; return the results with what that was."""
    egos = {one.ego: Driven(one.duration_s, one.distance_m, one.stopped_s) for one in results}
    found = put_right(files, egos)
    return [replace(one, recounts=tuple(it for it in found if it.vehicle in ("", one.ego))) for one in results]


def versions() -> dict[str, str]:
    """Return what a trial's numbers depend on besides the scenario: this package, SUMO, the libraries it computes with."""
    return {
        "sumo_reactive": __version__,
        "sumo": sumo_version(),
        "numba": numba.__version__,
        "numpy": numpy.__version__,
    }
