"""One trial: a scenario in, a judged result out."""

from __future__ import annotations

import gzip
import tempfile
from collections.abc import Callable
from pathlib import Path

import numba
import numpy

from sumo_reactive import __version__
from sumo_reactive.compilation import is_cached, mark_cached
from sumo_reactive.errors import ScenarioError
from sumo_reactive.experiment.metrics import Jury
from sumo_reactive.experiment.result import Override, TrialResult
from sumo_reactive.experiment.scenario import Scenario
from sumo_reactive.experiment.trip import Trip
from sumo_reactive.messages.record import Scene
from sumo_reactive.parameters import STUCK_S
from sumo_reactive.sumo.config import SumoConfig, read_config
from sumo_reactive.sumo.launch import chosen_step_length, runnable_config, sumo_arguments
from sumo_reactive.sumo.net_reader import NetFile, read_net
from sumo_reactive.sumo.session import Progress, Session, is_road_car, sumo_version, type_of
from sumo_reactive.world.road_graph import RoadGraph

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

    `observer` gets every scene, `progress` simulation time (s) and a text, `survey` the world, once at the end. Raises
    ScenarioError or NetworkError for what cannot be run, SimulationError if SUMO fails on the way.
    """
    config = read_config(scenario.config)
    step_length = chosen_step_length(config, scenario.step_length_s)
    net = read_net(config.net_file)
    with tempfile.TemporaryDirectory(prefix="sumo_reactive_") as folder:
        runnable, left_out = runnable_config(config, Path(folder))
        arguments, changed = sumo_arguments(
            config, runnable, seed=scenario.seed, step_length_s=step_length, sumo_options=scenario.sumo_options
        )
        with Session(arguments) as session:
            begin = session.time
            ego_id, chosen = _find_ego(session, scenario, config, progress)
            trip, jury, ended = _drive(session, ego_id, net, scenario, observer, progress)
            if survey is not None:
                survey(trip.graph)
            if scenario.until_end:
                if not trip.arrived:
                    trip.ego.release()
                session.play_out(scenario.until_s, progress)
            return _result(scenario, trip, jury, (*changed, *left_out), chosen, ended, begin)


def _drive(
    session: Session, ego_id: str, net: NetFile, scenario: Scenario, observer: Observer | None, progress: Progress | None
) -> tuple[Trip, Jury, str]:
    """Drive the ego; return the trip, the jury that watched it, and why it ended."""
    trip = Trip(session, ego_id, net, scenario.profile, scenario.delays, scenario.obstacle_polygons)
    first_time = not is_cached()
    limits = trip.ego.limits
    jury = Jury(limits.length, limits.width, limits.wheelbase, trip.graph)
    for scene in trip.scenes():
        jury.see(scene)
        if observer is not None:
            observer(scene)
        if progress is not None:
            progress(scene.step.time, scene.step.behaviour)
        if first_time:
            mark_cached()
            first_time = False
        if scenario.until_s is not None and scene.step.time >= scenario.until_s:
            return trip, jury, "arrived" if trip.arrived else f"until {scenario.until_s:g} s"
    return trip, jury, "arrived" if trip.arrived else f"stood still for {STUCK_S:g} s: {trip.stuck}"


def _find_ego(session: Session, scenario: Scenario, config: SumoConfig, progress: Progress | None) -> tuple[str, str]:
    """Step until the ego departs; return its id and how it was chosen."""
    if scenario.ego is not None:
        name = scenario.ego
        found = session.wait_for(lambda vehicle_id: vehicle_id == name, scenario.until_s, progress, name)
        chosen = "as named"
    elif _names_an_ego(config):
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


def _names_an_ego(config: SumoConfig) -> bool:
    """Whether a route or additional file speaks of a vehicle or type called 'ego'."""
    marks = (b'id="ego"', b'type="ego"')
    return any(mark in _content(file) for file in (*config.route_files, *config.additional_files) for mark in marks)


def _content(file: Path) -> bytes:
    if not file.is_file():
        return b""
    data = file.read_bytes()
    return gzip.decompress(data) if data[:2] == b"\x1f\x8b" else data


def _result(
    scenario: Scenario, trip: Trip, jury: Jury, overrides: tuple[Override, ...], chosen: str, ended: str, begin: float
) -> TrialResult:
    figures = jury.figures()
    return TrialResult(
        scenario=str(scenario.source),
        ego=trip.ego.id,
        chosen=chosen,
        seed=scenario.seed,
        step_length_s=trip.step_length,
        profile=scenario.profile.value,
        arrived=trip.arrived,
        ended=ended,
        begin_s=begin,
        departure_s=trip.departure,
        end_s=trip.end,
        time_loss_s=trip.time_loss,
        distance_m=trip.distance,
        figures=figures,
        timing=jury.timing(),
        collisions=jury.collisions,
        violations=jury.violations,
        overrides=overrides,
        versions={
            "sumo_reactive": __version__,
            "sumo": sumo_version(),
            "numba": numba.__version__,
            "numpy": numpy.__version__,
        },
        ghosts=trip.ghosts.made,
        emergencies=trip.emergencies,
    )
