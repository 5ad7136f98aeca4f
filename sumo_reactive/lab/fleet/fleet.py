"""Several egos in one simulation: taken over as they depart, decided from one snapshot, stepped together."""

from __future__ import annotations

import time as clock
from collections.abc import Callable
from dataclasses import dataclass, replace

from sumo_reactive.driver.compilation import is_cached, mark_cached
from sumo_reactive.driver.nouns.record import Scene
from sumo_reactive.driver.parameters import STUCK_S
from sumo_reactive.driver.world.road_graph import RoadGraph
from sumo_reactive.errors import NetworkError, PlanError, ScenarioError, SimulationError
from sumo_reactive.lab.fleet.egos import EgoRule
from sumo_reactive.lab.fleet.worlds import Worlds
from sumo_reactive.lab.metrics import Jury
from sumo_reactive.lab.result import Override, TrialResult
from sumo_reactive.lab.scenario import Scenario, require_parameters
from sumo_reactive.lab.start import Started, started
from sumo_reactive.lab.trial import recounted, result_of
from sumo_reactive.lab.trip import Order, Trip, world_kept
from sumo_reactive.sumo.devices import Equipment
from sumo_reactive.sumo.ego import give_back
from sumo_reactive.sumo.launch import passed_end
from sumo_reactive.sumo.net_reader import read_net
from sumo_reactive.sumo.recount import Recount, trip_files
from sumo_reactive.sumo.sensor import Sensor
from sumo_reactive.sumo.session import Progress

FleetObserver = Callable[[str, Scene], None]
"""Gets every ego's id and scene."""

FleetSurvey = Callable[[str, RoadGraph], None]
"""Gets an ego's id and each world that it has driven in, at the end of its trip."""


@dataclass(frozen=True)
class FleetResult:
    """What the trips of all egos came to, in order of departure; `refused`: vehicles that could not be taken over, and why.

    `on_their_way` were those whose trip the run's end cut short: no fault of theirs. `until` is simulation time at the end
    (s). `step_us`: wall-clock time of one ego's share of a step, all that the driver adds to SUMO (observing, deciding,
    placing, judging), µs; `wall_s` that of the whole simulation.
    """

    results: tuple[TrialResult, ...]
    refused: tuple[tuple[str, str], ...]
    on_their_way: frozenset[str]
    until: float
    step_us: float
    wall_s: float
    overrides: tuple[Override, ...] = ()

    @property
    def faulty(self) -> tuple[TrialResult, ...]:
        """Trips with a collision or violation, and those that ended before the goal."""
        return tuple(one for one in self.results if one.collisions or one.violations or not self._is_excused(one))

    def _is_excused(self, result: TrialResult) -> bool:
        return result.arrived or result.ego in self.on_their_way

    @property
    def recounts(self) -> tuple[Recount, ...]:
        """What was put right in SUMO's own outputs."""
        return tuple(dict.fromkeys(one for result in self.results for one in result.recounts))

    @property
    def exit_code(self) -> int:
        """0: no ego has a fault; else 1."""
        return int(bool(self.faulty))


@dataclass
class _Member:
    """An ego on its way, and the jury that watches it."""

    trip: Trip
    jury: Jury


class Fleet:
    """All egos of a running simulation."""

    def __init__(
        self, start: Started, scenario: Scenario, rule: EgoRule, observer: FleetObserver | None, survey: FleetSurvey | None
    ) -> None:
        self._start, self._scenario, self._rule = start, scenario, rule
        self._observer, self._survey = observer, survey
        self._equipment = Equipment(start.config)
        self._worlds = Worlds(read_net(start.config.net_file))
        self._sensor = Sensor(scenario.obstacle_polygons)
        self._on_their_way: list[_Member] = []
        self._begun = False
        self.results: list[tuple[float, TrialResult]] = []
        self.refused: list[tuple[str, str]] = []
        self.cut_short: set[str] = set()
        self.ego_steps = 0
        self.busy_s = 0.0

    @property
    def size(self) -> int:
        """How many egos are on their way."""
        return len(self._on_their_way)

    @property
    def is_done(self) -> bool:
        """Whether no ego is on its way or can still come."""
        known = len(self.results) + len(self.refused)
        return not self._on_their_way and not self._rule.is_open and known == len(self._rule.ids)

    def step(self) -> None:
        """Let every ego decide, simulate one step, look at what came of it, take over who has departed."""
        began = clock.perf_counter()
        orders = [member.trip.command() for member in self._on_their_way]
        before = clock.perf_counter()
        self._start.session.step()
        after = clock.perf_counter()
        pairs = zip(self._on_their_way, orders, strict=True)
        self._on_their_way = [member for member, order in pairs if self._goes_on(member, order)]
        self.ego_steps += len(orders)
        self.busy_s += clock.perf_counter() - after + before - began
        self._take_over()

    def _goes_on(self, member: _Member, order: Order) -> bool:
        """Look at what came of an order; return whether the ego is still on its way."""
        trip = member.trip
        try:
            self._look(member, trip.scene(order))
        except SimulationError as error:  # SUMO has taken it off the road: the others drive on
            self._keep(member, str(error))
            return False
        if trip.arrive():
            self._keep(member, "arrived")
        elif trip.stuck:
            self._keep(member, f"stood still for {STUCK_S:g} s: {trip.stuck}")
            trip.release()
        return not trip.has_ended

    def _look(self, member: _Member, scene: Scene) -> None:
        member.jury.see(scene)
        member.jury.enter(member.trip.graph)
        if self._observer is not None:
            self._observer(member.trip.ego.id, scene)
        if not self._begun and not is_cached():
            mark_cached()
        self._begun = True

    def _take_over(self) -> None:
        seed, session = self._scenario.seed, self._start.session
        for vehicle_id in () if session.is_past_end() else session.departed:
            if self._rule.chooses(vehicle_id, self._equipment, seed):
                self._admit(vehicle_id)

    def _admit(self, vehicle_id: str) -> None:
        """Take over one vehicle; who cannot be driven stays with SUMO's own driver, unless the ego was named."""
        scenario = self._scenario
        try:
            trip = Trip(
                self._start.session, vehicle_id, self._worlds, scenario.profile, scenario.delays, self._sensor
            )
        except (ScenarioError, NetworkError, PlanError) as error:
            if vehicle_id in self._rule.ids:
                raise
            give_back(vehicle_id)
            self.refused.append((vehicle_id, str(error)))
            return
        limits = trip.ego.limits
        jury = Jury(limits.length, limits.width, limits.wheelbase, trip.graph)
        self._on_their_way.append(_Member(trip, jury))

    def end(self, why: str) -> None:
        """Judge those still on their way, and give them back to SUMO's own driver."""
        for member in self._on_their_way:
            self._keep(member, why)
            self.cut_short.add(member.trip.ego.id)
            member.trip.release()
        self._on_their_way = []

    def _keep(self, member: _Member, ended: str) -> None:
        scenario, start = replace(self._scenario, ego=member.trip.ego.id), self._start
        result = result_of(scenario, member.trip, member.jury, start, self._chosen(member.trip.ego.id), ended)
        self.results.append((member.trip.departure, result))
        if self._survey is not None:
            for graph in member.trip.graphs:
                self._survey(result.ego, graph)

    def _chosen(self, vehicle_id: str) -> str:
        return "as named" if vehicle_id in self._rule.ids else "by rule"


def run_fleet(
    scenario: Scenario,
    rule: EgoRule,
    *,
    observer: FleetObserver | None = None,
    progress: Progress | None = None,
    survey: FleetSurvey | None = None,
) -> FleetResult:
    """Run the scenario in this process with every vehicle that `rule` chooses as an ego, until none can be left.

    Nobody is taken over after the scenario's end; who is under way then drives on, to `until_s` at the latest. Raises what
    `run_trial` raises; a vehicle that is not named and cannot be taken over is no error.
    """
    require_parameters(scenario)
    began = clock.perf_counter()
    with started(scenario) as start, world_kept():
        fleet, session, until = Fleet(start, scenario, rule, observer, survey), start.session, scenario.latest_end
        while not fleet.is_done and (fleet.size or not session.is_over()):
            fleet.step()
            if progress is not None:
                progress(session.time, f"{fleet.size} egos on their way, {len(fleet.results)} have ended")
            if until is not None and session.time >= until:
                break
        overrides = (*start.overrides, *passed_end(start.config, session.time, scenario.sumo_options))
        fleet.end(f"until {session.time:g} s")
        if scenario.until_end:
            session.play_out(until, progress)
        ended, files = session.time, trip_files()
        _require_egos(fleet, rule, scenario, ended)
    ordered = recounted(files, [result for _, result in sorted(fleet.results, key=lambda one: one[0])])
    step_us = 1e6 * fleet.busy_s / max(fleet.ego_steps, 1)
    wall = clock.perf_counter() - began
    return FleetResult(
        tuple(ordered), tuple(fleet.refused), frozenset(fleet.cut_short), ended, step_us, wall, overrides
    )


def _require_egos(fleet: Fleet, rule: EgoRule, scenario: Scenario, until: float) -> None:
    """Raise ScenarioError for a named ego that never came, or if there was none at all."""
    driven = {result.ego for _, result in fleet.results}
    for name in rule.ids:
        if name not in driven:
            raise ScenarioError(f"{scenario.source}: ego '{name}' never departs before {until:.1f} s, where the run ends")
    if not fleet.results and not fleet.refused:
        raise ScenarioError(f"{scenario.source}: no vehicle is chosen as an ego before {until:.1f} s, where the run ends")
