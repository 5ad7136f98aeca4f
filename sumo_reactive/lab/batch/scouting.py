"""Which trips a scenario has: one run of SUMO alone, from which egos are drawn."""

from __future__ import annotations

import random
import tempfile
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

from sumo_reactive.lab.scenario import Scenario
from sumo_reactive.lab.simulation import started
from sumo_reactive.sumo.config import read_config
from sumo_reactive.sumo.outputs import AS_READ, read_trips, silenced
from sumo_reactive.sumo.session import is_road_car

SCOUT = "sumo_reactive.lab.batch.scouting:scout"
"""Name of `scout`, to be called in another process."""


class Departure(NamedTuple):
    """A road car that arrives when SUMO drives it: when it departs (s after the scenario's begin), how far it goes (m)."""

    vehicle_id: str
    depart_s: float
    length_m: float


def scout(scenario: Scenario) -> list[Departure]:
    """Run the scenario in this process without an ego until it ends or `until_s`; return its trips by departure and id."""
    cars: set[str] = set()

    def look(vehicle_id: str) -> bool:
        if is_road_car(vehicle_id):
            cars.add(vehicle_id)
        return False

    with tempfile.TemporaryDirectory(prefix="sumo_reactive_") as folder:
        trips = Path(folder) / "trips.xml"
        wanted = silenced(read_config(scenario.config).options) | {"tripinfo-output": str(trips), **AS_READ}
        options = [word for name, value in wanted.items() for word in (f"--{name}", value)]
        with started(replace(scenario, ego=None), options) as run:
            run.session.wait_for(look, scenario.until_s, None)
        found = [
            Departure(trip.vehicle_id, round(trip.departure - run.begin, 3), trip.length_m)
            for trip in read_trips(trips)
            if trip.vehicle_id in cars and trip.departure is not None and trip.arrival is not None and not trip.vaporized
        ]
    return sorted(found, key=lambda trip: (trip.depart_s, trip.vehicle_id))


def drawn_egos(trips: Sequence[Departure], count: int, seed: int, min_length_m: float, warm_up_s: float) -> list[str]:
    """Return the ids of `count` trips drawn at random among those that qualify, by departure; fewer if fewer do."""
    fit = [trip for trip in trips if trip.length_m >= min_length_m and trip.depart_s >= warm_up_s]
    chosen = random.Random(seed).sample(range(len(fit)), min(count, len(fit)))
    return [fit[k].vehicle_id for k in sorted(chosen)]
