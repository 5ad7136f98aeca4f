"""Trips in a scenario: which SUMO's own driver completes, and what each of the two drivers makes of them."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Mapping, Sequence
from pathlib import Path
from random import Random
from typing import NamedTuple

import libsumo

from roads.scenarios import TRAFFIC, Place, written
from roads.traffic import WINDOW_S
from roads.vehicles import SORTS
from roads.witness import Seen, Witness, bridges_of
from sumo_reactive.driver.nouns.record import Scene
from sumo_reactive.driver.parameters import USUAL, Parameters
from sumo_reactive.errors import ReactiveError
from sumo_reactive.lab.ego_rule import EgoRule
from sumo_reactive.lab.fleet import run_fleet
from sumo_reactive.lab.metrics.encounters import HARD_BRAKING_M_S2
from sumo_reactive.lab.result import TrialResult
from sumo_reactive.lab.scenario import Scenario
from sumo_reactive.lab.simulation import Simulation, run_trial, started
from sumo_reactive.lab.sumo_driver import WatchedTrip

WARM_UP_S = 15.0
"""Nobody is an ego who departs before…"""

LAST_S = 600.0
"""…or arrives, with SUMO's own driver, after this time (s)."""

UNTIL_S = 1200.0
"""Every run ends then (s)."""

SHORTEST_S = 15.0
"""A trip takes no less."""

DECELERATIONS = {"motorcycle": 10.0}
"""SUMO's own, m/s², of a class that brakes harder than others unless its type says otherwise."""

EGOS = {"car": 8.0, "van": 1.0, "truck": 1.5, "bus": 1.5, "trailer": 0.7}
"""The sorts of vehicles that are egos, and how likely one of them is drawn."""


class Run(NamedTuple):
    """What a driver made of a trip. `exit_code` as the command line has it; `error` in one line; `told`: the verdict, or why
    the run ended before the goal.

    Times in s; `hard_braking`: of others, with the ego as the cause, those left out who brake so hard in comfort; `lateral`:
    m/s², the largest.
    """

    arrived: bool = False
    exit_code: int = 0
    error: str = ""
    told: str = ""
    duration_s: float = 0.0
    contacts: tuple[tuple[float, str], ...] = ()
    red: tuple[float, ...] = ()
    hard_braking: int = 0
    ways_taken: int = 0
    off_road_s: float = 0.0
    standstill_s: float = 0.0
    lateral: float = 0.0
    jerk: float = 0.0
    """RMS, m/s³."""
    judged: tuple[int, int] = (0, 0)
    """Collisions and red lights as the program's own judges count them."""


class Prepared(NamedTuple):
    """A scenario, its bridges, and the trips chosen, each with what SUMO's own driver made of it."""

    place: Place
    bridges: frozenset[frozenset[str]]
    trips: Mapping[str, Run]


class Order(NamedTuple):
    """A scenario to be written into a folder, with so many egos, or only one that is named; this driver's parameters."""

    seed: int
    index: int
    folder: Path
    egos: int
    ego: str = ""
    parameters: Parameters = USUAL


def prepared(order: Order) -> Prepared:
    """Write a scenario, choose trips, let SUMO's own driver take them; raise NetworkError if it cannot be built."""
    place = written(order.seed, order.index, order.folder)
    bridges = bridges_of(order.folder / "roads.net.xml")
    chosen = drawn(completed(scenario_of(place, "")), order)
    return Prepared(place, bridges, _driven_by_sumo(place, chosen, bridges) if chosen else {})


def scenario_of(place: Place, ego: str, parameters: Parameters = USUAL) -> Scenario:
    """Return what is run, by either driver; `parameters` are this driver's."""
    config = place.config
    return Scenario(
        config=config, ego=ego or None, seed=place.seed, step_length_s=place.step_s, until_s=UNTIL_S, parameters=parameters,
        source=config,
    )  # fmt: skip


def completed(scenario: Scenario) -> list[str]:
    """Return who, in SUMO's hands, departs and arrives in time and is not taken out of a jam, in order of departure."""
    departed: dict[str, float] = {}
    found: dict[str, float] = {}
    with started(scenario) as start:
        while start.session.time < LAST_S and not start.session.is_over():
            start.session.step()
            now = start.session.time
            departed |= {name: now for name in start.session.departed if WARM_UP_S < now < WINDOW_S}
            for name in libsumo.simulation.getStartingTeleportIDList():
                departed.pop(name, None)
            for name in libsumo.simulation.getArrivedIDList():
                if now - departed.get(name, now) >= SHORTEST_S:
                    found[name] = departed[name]
    return sorted(found, key=lambda name: (found[name], name))


def sort_of(vehicle_id: str) -> str:
    """Return the sort of a vehicle: its id begins with it."""
    return vehicle_id.partition("_")[0]


def drawn(names: Sequence[str], order: Order) -> tuple[str, ...]:
    """Return the egos: the one that is named, or some of `names` at random, cars most often."""
    if order.ego:
        return (order.ego,)
    rng, left = Random(f"egos {order.seed} {order.index}"), [name for name in names if sort_of(name) in EGOS]
    chosen = []
    while left and len(chosen) < order.egos:
        sorts = sorted({sort_of(name) for name in left}, key=list(SORTS).index)
        sort = rng.choices(sorts, [EGOS[one] for one in sorts])[0]
        chosen.append(rng.choice([name for name in left if sort_of(name) == sort]))
        left.remove(chosen[-1])
    return tuple(name for name in names if name in chosen)


def _driven_by_sumo(place: Place, egos: tuple[str, ...], bridges: frozenset[frozenset[str]]) -> dict[str, Run]:
    """Watch all trips in one simulation: what is only watched changes nothing."""
    witnesses = {name: Witness(name, bridges) for name in egos}
    scenario = scenario_of(place, "")
    with started(scenario) as start:
        session, net_file, stuck_s = start.session, start.config.net_file, scenario.parameters.stuck_s
        simulation = Simulation(
            start, scenario, lambda ego: WatchedTrip(session, ego, net_file, stuck_s),
            lambda scene: witnesses[scene.ego].look(), None, EgoRule(ids=egos),
        )  # fmt: skip
        simulation.run()
        results = simulation.results
    brisk = brisk_of(place.config.parent)
    runs = {one.ego: _run(one, witnesses[one.ego].seen, brisk) for one in results}
    return {name: runs[name] for name in egos if name in runs}


class Trip(NamedTuple):
    """A trip that this driver is to take."""

    place: Place
    ego: str
    bridges: frozenset[frozenset[str]] = frozenset()
    parameters: Parameters = USUAL


def driven(trip: Trip) -> Run:
    """Let this driver take a trip; what it refuses is a run with an error."""
    witness = Witness(trip.ego, trip.bridges)

    def look(_: Scene) -> None:
        witness.look()

    try:
        result = run_trial(scenario_of(trip.place, trip.ego, trip.parameters), observer=look)
    except ReactiveError as error:
        seen = witness.seen
        return Run(exit_code=error.exit_code, error=" ".join(str(error).split()), contacts=seen.contacts, red=seen.red)
    return _run(result, witness.seen, brisk_of(trip.place.config.parent))


def driven_together(trips: Sequence[Trip]) -> dict[str, Run]:
    """Let this driver take several trips of a scenario in one simulation, each ego among the others; raise ReactiveError if
    one of them is refused, and for all together if SUMO fails."""
    first, witnesses = trips[0], {trip.ego: Witness(trip.ego, trip.bridges) for trip in trips}

    def look(scene: Scene) -> None:
        witnesses[scene.ego].look()

    fleet = run_fleet(scenario_of(first.place, "", first.parameters), EgoRule(ids=(*witnesses,)), observer=look)
    brisk = brisk_of(first.place.config.parent)
    return {one.ego: _run(one, witnesses[one.ego].seen, brisk) for one in fleet.results}


def brisk_of(folder: Path) -> frozenset[str]:
    """Return the vehicles of a scenario whose comfortable deceleration is as hard as the judge's hard braking."""
    root = ET.parse(folder / TRAFFIC).getroot()
    own = {one.attrib["id"]: one.get("decel", DECELERATIONS.get(one.attrib["vClass"], 0.0)) for one in root.iter("vType")}
    brisk = {name for name, decel in own.items() if -float(decel) < HARD_BRAKING_M_S2}
    return frozenset(one.attrib["id"] for one in root if one.get("type") in brisk)


def _run(result: TrialResult, seen: Seen, brisk: frozenset[str]) -> Run:
    figures = {name: value or 0 for name, value in result.figures.items()}
    return Run(
        arrived=result.arrived,
        exit_code=result.exit_code,
        told=result.verdict if result.arrived else result.ended,
        duration_s=round(result.duration_s, 3),
        contacts=seen.contacts,
        red=seen.red,
        hard_braking=sum(one.user_id not in brisk for one in result.hard_brakes),
        ways_taken=int(figures["right_of_way_violations"]),
        off_road_s=seen.off_road_s,
        standstill_s=figures["standstill_s"],
        lateral=figures["max_lateral_acceleration_m_s2"],
        jerk=figures["rms_jerk_m_s3"],
        judged=(int(figures["collisions"]), int(figures["red_lights_run"])),
    )
