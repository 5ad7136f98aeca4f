"""What a run does to everybody but the ego, from SUMO's own outputs.

Two runs of a trip are the same until the ego departs and end at the same simulation time, so that their sums over all others
differ by what the ego's driver has caused between the two. Others are the vehicles that were on the road at the ego's
departure or were due later; one that is still under way at the end counts with what it has done until then.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from sumo_reactive.errors import SimulationError
from sumo_reactive.sumo.config import SumoConfig
from sumo_reactive.sumo.outputs import (
    AS_READ,
    Contact,
    TripInfo,
    read_contacts,
    read_teleports,
    read_trips,
    silenced,
    trip_of,
)
from sumo_reactive.sumo.stand_ins import is_stand_in

MG_PER_KG, MG_PER_G, M_PER_KM = 1e6, 1e3, 1e3
SECONDS_PER_H = 3600.0
_UNFINISHED, _UNDEPARTED = "tripinfo-output.write-unfinished", "tripinfo-output.write-undeparted"


class Arrival(NamedTuple):
    """How long another vehicle took to its goal, and how long it stood of that, s."""

    duration: float
    waiting: float


@dataclass(frozen=True)
class Outputs:
    """The files that SUMO writes into `folder`, their names beginning with `prefix`."""

    folder: Path
    prefix: str = ""

    @property
    def trips(self) -> Path:
        """Every vehicle's trip, with its emissions."""
        return self.folder / f"{self.prefix}trips.xml"

    @property
    def totals(self) -> Path:
        """SUMO's own counts over the whole run."""
        return self.folder / f"{self.prefix}totals.xml"

    @property
    def contacts(self) -> Path:
        """Every collision."""
        return self.folder / f"{self.prefix}contacts.xml"

    def options(self, config: SumoConfig) -> dict[str, str]:
        """Return the options that make SUMO write these files, and none that the scenario names.

        Emission devices are dealt out without a random number, so that every other device goes to whom it went before.
        """
        return silenced(config.options) | AS_READ | {
            "tripinfo-output": str(self.trips), _UNFINISHED: "true", _UNDEPARTED: "true",
            "statistic-output": str(self.totals), "collision-output": str(self.contacts),
            "device.emissions.probability": "1", "device.emissions.deterministic": "true",
        }  # fmt: skip


@dataclass(frozen=True)
class NetworkEffects:
    """Sums over the others of one run by name, units in the names, and who of them has arrived."""

    figures: Mapping[str, float]
    arrivals: Mapping[str, Arrival]


def effects_of(outputs: Outputs, ego_id: str, ego_teleports: int) -> NetworkEffects:
    """Read what SUMO has written about a run; `ego_teleports` are left out of SUMO's count of teleports."""
    ego = trip_of(outputs.trips, ego_id)
    if ego is None or ego.departure is None:
        raise SimulationError(f"{outputs.trips}: SUMO tells no trip of ego '{ego_id}'")
    trips = list(_others(outputs.trips, ego_id, ego.departure))
    arrived = (trip for trip in trips if trip.arrival is not None and not trip.vaporized)
    arrivals = {trip.vehicle_id: Arrival(trip.duration, trip.waiting) for trip in arrived}
    figures = _sums(trips) | {
        "others_arrived": len(arrivals),
        "others_collisions": _contacts(outputs.contacts, ego_id, ego.departure),
        "others_teleports": read_teleports(outputs.totals) - ego_teleports,
    }
    return NetworkEffects(figures, arrivals)


def _others(path: Path, ego_id: str, departure: float) -> Iterator[TripInfo]:
    """Yield the trips of all others that had not ended when the ego departed."""
    for trip in read_trips(path):
        if not _is_own(trip.vehicle_id, ego_id) and (trip.arrival is None or trip.arrival >= departure):
            yield trip


def _contacts(path: Path, ego_id: str, departure: float) -> int:
    """Count the collisions between others since the ego's departure."""
    later = (contact for contact in read_contacts(path) if contact.time >= departure)
    return sum(not any(_is_own(name, ego_id) for name in (one.collider, one.victim)) for one in later)


def _with_stand_in(contact: Contact) -> bool:
    """Whether SUMO counts a body that is not there: a stand-in, which is where its ego is."""
    return is_stand_in(contact.collider) or is_stand_in(contact.victim)


def _is_own(vehicle_id: str, ego_id: str) -> bool:
    return vehicle_id == ego_id or is_stand_in(vehicle_id)


def _sums(trips: Sequence[TripInfo]) -> dict[str, float]:
    driven = [trip for trip in trips if trip.departure is not None]
    way_km = sum(trip.length_m for trip in driven) / M_PER_KM
    carbon_dioxide_mg = sum(trip.carbon_dioxide_mg for trip in driven)
    figures = {
        "others_vehicles": len(driven),
        "others_time_loss_s": round(sum(trip.time_loss for trip in driven), 2),
        "others_insertion_delay_s": round(sum(trip.departure_delay for trip in trips), 2),
        "others_stops": sum(trip.stops for trip in driven),
        "others_distance_km": round(way_km, 4),
        "others_co2_kg": round(carbon_dioxide_mg / MG_PER_KG, 4),
        "others_fuel_kg": round(sum(trip.fuel_mg for trip in driven) / MG_PER_KG, 4),
        "others_nox_g": round(sum(trip.nitrogen_oxides_mg for trip in driven) / MG_PER_G, 4),
    }
    return figures | ({"others_co2_g_per_km": round(carbon_dioxide_mg / MG_PER_G / way_km, 3)} if way_km > 0.0 else {})


def network_figures(outputs: Outputs, duration: float) -> dict[str, float | None]:
    """Return what SUMO has written about all vehicles of a run of `duration` s, by name; None: there is no such figure."""
    trips = [trip for trip in read_trips(outputs.trips) if not is_stand_in(trip.vehicle_id)]
    driven = [trip for trip in trips if trip.departure is not None]
    arrived = [trip for trip in driven if trip.arrival is not None and not trip.vaporized]
    way, time = sum(trip.length_m for trip in driven), sum(trip.duration for trip in driven)

    def per(total: float, count: float) -> float | None:
        return round(total / count, 4) if count > 0.0 else None

    return {
        "network_vehicles": len(driven),
        "network_arrived": len(arrived),
        "network_arrivals_per_h": per(SECONDS_PER_H * len(arrived), duration),
        "network_mean_duration_s": per(sum(trip.duration for trip in arrived), len(arrived)),
        "network_mean_speed_m_s": per(way, time),
        "network_mean_time_loss_s": per(sum(trip.time_loss for trip in driven), len(driven)),
        "network_mean_waiting_s": per(sum(trip.waiting for trip in driven), len(driven)),
        "network_mean_insertion_delay_s": per(sum(trip.departure_delay for trip in trips), len(trips)),
        "network_stops_per_vehicle": per(sum(trip.stops for trip in driven), len(driven)),
        "network_co2_g_per_km": per(sum(trip.carbon_dioxide_mg for trip in driven), way),
        "network_fuel_g_per_km": per(sum(trip.fuel_mg for trip in driven), way),
        "network_collisions": sum(not _with_stand_in(contact) for contact in read_contacts(outputs.contacts)),
        "network_teleports": read_teleports(outputs.totals),
    }  # mg a metre are g a kilometre


def means_over_both(one: NetworkEffects, other: NetworkEffects) -> tuple[dict[str, float], dict[str, float]]:
    """Return mean duration and standing time (s) of the others that arrived in both runs, in each of them."""
    both = sorted(one.arrivals.keys() & other.arrivals.keys())
    return _means(one, both), _means(other, both)


def _means(effects: NetworkEffects, names: list[str]) -> dict[str, float]:
    if not names:
        return {}
    duration = sum(effects.arrivals[name].duration for name in names) / len(names)
    waiting = sum(effects.arrivals[name].waiting for name in names) / len(names)
    return {"others_mean_duration_s": round(duration, 4), "others_mean_waiting_s": round(waiting, 4)}
