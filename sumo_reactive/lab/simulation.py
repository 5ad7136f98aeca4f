"""One simulation over n drivers: all command, SUMO steps, all look at what came of it, and judges look on.

A trial is a simulation of one driver of this project, the baseline one of SUMO's own driver, which is only watched.
"""

from __future__ import annotations

import contextlib
import tempfile
import time as clock
from collections.abc import Callable, Container, Iterator, Sequence
from dataclasses import replace
from enum import IntEnum
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numba
import numpy

from sumo_reactive import __version__
from sumo_reactive.driver.nouns.record import Scene, StepRecord
from sumo_reactive.errors import NetworkError, PlanError, ScenarioError, SimulationError
from sumo_reactive.lab.columns import digest_of
from sumo_reactive.lab.drivers.choice import SUMO
from sumo_reactive.lab.drivers.loading import controller_parts, is_of_parts, maker_of
from sumo_reactive.lab.drivers.users_trip import UsersTrip
from sumo_reactive.lab.ego_rule import EgoRule
from sumo_reactive.lab.egos import chooses, find_ego
from sumo_reactive.lab.metrics.jury import Jury
from sumo_reactive.lab.peers import ALONE, PeerMessage, Peers
from sumo_reactive.lab.recorder import Recorder, reasons_in
from sumo_reactive.lab.result import TrialResult
from sumo_reactive.lab.scenario import Scenario
from sumo_reactive.lab.sumo_driver import WatchedTrip, as_told, trip_output
from sumo_reactive.lab.surroundings_record import RECORDED_M
from sumo_reactive.lab.task import Task, replay_command
from sumo_reactive.lab.trace import entries
from sumo_reactive.lab.trip import Trip
from sumo_reactive.lab.worlds import world_kept
from sumo_reactive.sumo.config import SumoConfig, read_config
from sumo_reactive.sumo.ego import give_back
from sumo_reactive.sumo.everybody import Everybody
from sumo_reactive.sumo.launch import OptionOverride, chosen_step_length, passed_end, runnable_config, sumo_arguments
from sumo_reactive.sumo.net_reader import WorldSource, read_net
from sumo_reactive.sumo.recount import Driven, TripFiles, put_right, trip_files
from sumo_reactive.sumo.sensor import Sensor
from sumo_reactive.sumo.session import Progress, Session, sumo_version
from sumo_reactive.sumo.vehicle_type import Equipment, may_say_arrivals

SceneObserver = Callable[[Scene], None]
"""Gets every scene of every ego."""


class Started(NamedTuple):
    """A simulation that runs: its configuration, what was overridden in it, simulation time at its begin (s)."""

    session: Session
    config: SumoConfig
    overrides: tuple[OptionOverride, ...]
    begin: float


@contextlib.contextmanager
def started(
    scenario: Scenario, more_options: Sequence[str] = (), *, has_window: bool = False, takes_over_many: bool = False
) -> Iterator[Started]:
    """Start SUMO with the scenario, and `more_options` of its own, or with its window; close it at the end.

    To ask SUMO where a trip ends takes as long as to read all files for that: they are read where it `takes_over_many`.
    Raises ScenarioError for what SUMO cannot run.
    """
    config = read_config(scenario.config)
    step_length = chosen_step_length(config, scenario.step_length_s)
    runnable, left_out = runnable_config(config)
    options = (*scenario.sumo_options, *more_options)
    arguments, changed = sumo_arguments(
        config, runnable, seed=scenario.seed, step_length_s=step_length, sumo_options=options
    )
    says_arrivals = not takes_over_many or may_say_arrivals(config, scenario.sumo_options)
    with Session(arguments, has_window=has_window, says_arrivals=says_arrivals) as session:
        yield Started(session, config, (*changed, *left_out), session.time)


AnyTrip = Trip | UsersTrip | WatchedTrip
"""Whoever drives: each simulation step is preceded by a `command` and followed by a `scene`."""


class _Phase(IntEnum):
    """What SUMO is told in turn: first all that the egos say as they look, and so on."""

    LOOK, ARRIVE, CHOOSE, COMMAND = range(4)


class _Member(NamedTuple):
    """A trip under way: which of those chosen it is, the jury that watches it, how its ego was chosen, when it ends at the
    latest (s)."""

    number: int
    trip: AnyTrip
    jury: Jury
    chosen: str
    until: float | None


class Simulation:
    """Drivers in a running simulation: one that is admitted, or all that a `rule` chooses as they depart.

    `take_over` begins a trip. What the trips have come to is in `results`; `refused` are vehicles that could not be taken
    over, and why, `cut_short` the egos whose trip the run's end has ended, `placed` those that SUMO has not moved itself.
    """

    def __init__(
        self, start: Started, scenario: Scenario, take_over: Callable[[str], AnyTrip],
        observer: SceneObserver | None, progress: Progress | None, rule: EgoRule | None = None,
    ) -> None:  # fmt: skip
        self._start, self._session, self._scenario = start, start.session, scenario
        self._take_over, self._observer, self._progress, self._rule = take_over, observer, progress, rule
        self._peers, self._chosen, self._all = ALONE, 0, PeerMessage()
        self._equipment = Equipment(start.config) if rule else None
        self._everybody = Everybody()
        self._members: list[_Member] = []
        self._until = scenario.latest_end
        self._has_left, self._doing = False, ""
        self.results: list[TrialResult] = []
        self.refused: list[tuple[str, str]] = []
        self.cut_short, self.placed = set[str](), set[str]()
        self.ended = start.session.time
        self.ego_steps, self.busy_s = 0, 0.0

    def share_with(self, peers: Peers) -> None:
        """Drive a part of the egos; other processes with the same simulation drive theirs. The results are of those here."""
        self._peers = peers

    def admit(self, vehicle_id: str, chosen: str, number: int = 0) -> None:
        """Take over a vehicle that has departed, chosen in the way told, as ego `number`."""
        self._session.orders.begin(_Phase.CHOOSE, number)
        trip = self._take_over(vehicle_id)
        until = self._scenario.end_after(trip.departure)
        self._until = self._until if self._rule else until
        jury = Jury(trip.limits.length, trip.limits.width, trip.limits.wheelbase, self._scenario.metrics)
        self._members.append(_Member(number, trip, jury, chosen, until))

    def run_one(self) -> None:
        """Wait for the scenario's one ego, and let it drive."""
        self.admit(*find_ego(self._session, self._scenario, self._start.config, self._progress))
        self.run()

    def run(self) -> None:
        """Step until nobody is on the way or can still come; then play the scenario out if it asks for that."""
        with world_kept():
            while self.step():
                if self._progress is not None:
                    self._progress(self._session.time, self._doing)
        self.ended = self._session.time
        if self._all.has_left:
            self._session.step()
        if self._scenario.until_end and self._peers.index == 0:
            self._session.play_out(self._until, self._progress)

    def _agree(self) -> None:
        """Tell the peers what the egos here have SUMO do, and how they fare; carry out all of it, theirs, too."""
        orders, ended = self._session.orders, len(self.results) + len(self.refused)
        here = PeerMessage(orders.for_others() if self._peers.number > 1 else (), len(self._members), ended, self._has_left)
        told = self._peers.others(here)
        orders.carry_out(order for one in told for order in one.orders)
        _, on_their_way, all_ended, have_left = zip(here, *told, strict=True)
        self._all = PeerMessage((), sum(on_their_way), sum(all_ended), any(have_left))

    def _goes_on(self) -> bool:
        if self._all.on_their_way or self._rule is None:
            return bool(self._all.on_their_way)
        can_come = self._rule.is_open or self._all.ended < len(self._rule.ids)
        is_past = self._until is not None and self._session.time >= self._until
        return can_come and not is_past and not self._session.is_over()

    @property
    def juries(self) -> dict[str, Jury]:
        """The judges of the trips under way, by ego."""
        return {member.trip.id: member.jury for member in self._members}

    def step(self) -> bool:
        """Let everybody command, simulate one step, look at what came of it, take over who has departed.

        Return whether there was a step: somebody is on the way or can still come.
        """
        began = clock.perf_counter()
        for member in self._members:
            self._session.orders.begin(_Phase.COMMAND, member.number)
            member.trip.command()
        self._agree()
        if not self._goes_on():
            return False
        before, self._has_left = clock.perf_counter(), False
        self._session.step()
        after = clock.perf_counter()
        self.ego_steps += len(self._members)
        seen = [member for member in self._members if self._look(member)]  # all, before who has arrived is taken away
        self._members = [member for member in seen if self._is_on_its_way(member)]
        self.busy_s += clock.perf_counter() - after + before - began
        if self._rule is not None:
            self._choose(self._rule)
            self._doing = f"{self._all.on_their_way} egos on their way, {self._all.ended} have ended"
        return True

    def _look(self, member: _Member) -> bool:
        """Look at what came of a command; return whether the ego is still in the simulation."""
        self._session.orders.begin(_Phase.LOOK, member.number)
        try:
            if (scene := member.trip.scene()) is not None:
                self._show(member, scene)
        except SimulationError as error:
            if self._rule is None:
                raise
            self._keep(member, str(error))  # SUMO has taken it off the road: the others drive on
            return False
        return True

    def _is_on_its_way(self, member: _Member) -> bool:
        """Take an ego away that has arrived, let go of one whose time is over; return whether the trip goes on."""
        self._session.orders.begin(_Phase.ARRIVE, member.number)
        trip = member.trip
        self._has_left = trip.arrive() or self._has_left
        is_cut_short = member.until is not None and self._session.time >= member.until
        if not (trip.arrived or is_cut_short or trip.stuck):
            return True
        self._keep(member, "arrived" if trip.arrived else f"until {member.until:g} s" if is_cut_short else trip.stuck)
        if not trip.arrived:
            self.cut_short |= {trip.id} if is_cut_short else set()
            trip.release()
        return False

    def _show(self, member: _Member, scene: Scene) -> None:
        member.jury.see(scene)
        if self._observer is not None:
            step = scene.step
            if self._rule is None and not self._session.has_window:  # SUMO with a window hangs when asked for so much
                scene = scene._replace(around=partial(self._everybody.within, RECORDED_M, scene.ego, step.x, step.y))
            self._observer(scene)
        self._doing = scene.step.behaviour or "SUMO's own driver"

    def _choose(self, rule: EgoRule) -> None:
        """Take over who has departed and is chosen; who cannot be driven and is not named stays with SUMO's own driver."""
        assert self._equipment is not None
        for vehicle_id in () if self._session.is_past_end() else self._session.departed:
            if not chooses(rule, vehicle_id, self._equipment, self._scenario.seed):
                continue
            number, self._chosen, is_named = self._chosen, self._chosen + 1, vehicle_id in rule.ids
            if number % self._peers.number != self._peers.index:
                continue
            try:
                self.admit(vehicle_id, "as named" if is_named else "by rule", number)
            except (ScenarioError, NetworkError, PlanError) as error:
                if is_named:
                    raise
                self._session.orders(give_back, vehicle_id)
                self.refused.append((vehicle_id, str(error)))

    def _keep(self, member: _Member, ended: str) -> None:
        """Judge a trip that has ended for the reason told."""
        trip, jury, scenario, start = member.trip, member.jury, self._scenario, self._start
        self.placed |= {trip.id} if trip.is_placed else set()
        overrides = (*start.overrides, *passed_end(start.config, trip.end, scenario.sumo_options))
        own, failures = jury.own_figures()
        self.results.append(TrialResult(
            scenario=str(scenario.source), ego=trip.id, chosen=member.chosen, seed=scenario.seed,
            step_length_s=self._session.step_length, profile=trip.profile, arrived=trip.arrived, ended=ended,
            begin_s=start.begin, departure_s=trip.departure, end_s=trip.end, time_loss_s=trip.time_loss,
            distance_m=trip.distance, length_m=trip.limits.length, width_m=trip.limits.width,
            figures=jury.figures() | trip.figures | own, timing=jury.timing(), metric_failures=failures,
            faults=jury.faults, overrides=overrides, versions=versions(), ghosts=trip.ghosts_made, stopped_s=trip.stopped,
            failure=trip.failure,
        ))  # fmt: skip


def run_trial(
    scenario: Scenario, *, observer: SceneObserver | None = None, progress: Progress | None = None, has_window: bool = False
) -> TrialResult:
    """Run the scenario in this process until the ego has arrived, with the driver that it names; return the judged result.

    `observer` gets every scene, `progress` simulation time (s) and a text. Raises ScenarioError or NetworkError for what
    cannot be run, SimulationError if SUMO fails on the way, WindowClosedError if it `has_window` and that is closed.
    """
    if scenario.driver == SUMO:
        return run_sumo_driver(scenario, observer=observer, progress=progress, has_window=has_window)
    net, taken_over = read_net(read_config(scenario.config).net_file), taking_over(scenario)
    with started(scenario, has_window=has_window) as start:
        simulation = Simulation(
            start, scenario, lambda ego: taken_over(start.session, ego, net, Sensor(scenario.obstacle_polygons)),
            observer, progress,
        )  # fmt: skip
        simulation.run_one()
        files = trip_files()
    return replace(recounted(files, simulation.results, simulation.placed)[0], command=_command_of(scenario, simulation))


def taking_over(scenario: Scenario) -> Callable[[Session, str, WorldSource, Sensor], Trip | UsersTrip]:
    """Return what begins the trip of an ego with the driver that a scenario names; raise ScenarioError if there is none."""
    if is_of_parts(scenario.driver):
        parts = controller_parts(scenario.driver)
        return lambda session, ego, net, sensor: Trip(session, ego, net, scenario, sensor, parts)
    make = maker_of(scenario.driver)
    return lambda session, ego, net, _: UsersTrip(session, ego, net, scenario, make)


def run_sumo_driver(
    scenario: Scenario, *, observer: SceneObserver | None = None, progress: Progress | None = None, has_window: bool = False
) -> TrialResult:
    """Run the scenario in this process with the ego in SUMO's hands until it has arrived; return the judged result.

    SUMO is started as `run_trial` starts it. Departure, arrival, duration, distance and time loss are those of SUMO's
    `tripinfo` of the ego. What only this project's driver has is None among the figures, and so is the right of way in a
    network that cannot be read; one figure is added, how often SUMO has teleported the ego. Raises what `run_trial` raises.
    """
    with tempfile.TemporaryDirectory(prefix="sumo_reactive_") as folder:
        options, trips = trip_output(scenario.sumo_options, Path(folder))
        with started(scenario, options, has_window=has_window) as start:
            session, net_file = start.session, start.config.net_file
            stuck_s = scenario.parameters.stuck_s
            simulation = Simulation(
                start, scenario, lambda ego: WatchedTrip(session, ego, net_file, stuck_s), observer, progress
            )
            simulation.run_one()
        return replace(next(as_told(simulation.results, trips)), command=_command_of(scenario, simulation))


def _command_of(scenario: Scenario, simulation: Simulation) -> str:
    """Return what drives the one ego of a simulation again."""
    return replay_command(Task(replace(scenario, ego=simulation.results[0].ego, egos=None)))


def versions() -> dict[str, str]:
    """Return what a trial's numbers depend on besides the scenario: this package, SUMO, the libraries it computes with."""
    return {
        "sumo_reactive": __version__,
        "sumo": sumo_version(),
        "numba": numba.__version__,
        "numpy": numpy.__version__,
    }


def recounted(files: TripFiles, results: Sequence[TrialResult], placed: Container[str]) -> list[TrialResult]:
    """Put the egos' figures right in the outputs of a simulation that has ended; return the results with what that was.

    What SUMO has moved itself to the end, not `placed`, it has counted right.
    """
    egos = {one.ego: Driven(one.duration_s, one.distance_m, one.stopped_s) for one in results if one.ego in placed}
    found = put_right(files, egos) if egos else ()
    return [replace(one, recounts=tuple(it for it in found if it.vehicle in ("", one.ego))) for one in results]


def run_observed(task: Task) -> dict[str, Any]:
    """Run a task in this process; return the fields that its `Outcome` takes from the trial."""
    steps: list[StepRecord] = []

    def see(scene: Scene) -> None:
        steps.append(scene.step)

    result = run_trial(task.scenario, observer=see)
    told = {"entries": tuple(entries(steps)), "reasons": tuple(reasons_in(steps))}
    return {"result": result, "trajectory": digest_of(steps), **told}


def run_recorded(order: tuple[Task, Path]) -> None:
    """Run a task in this process, and record it in a folder in place of what is recorded there."""
    task, folder = order
    recorder = Recorder(folder, overwrite=True)
    recorder.write(run_trial(task.scenario, observer=recorder.see))
