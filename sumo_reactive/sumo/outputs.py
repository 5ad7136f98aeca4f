"""SUMO's own outputs: which options write them, and what they say, read element by element."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple
from xml.etree.ElementTree import ParseError

from sumolib.xml import parse

from sumo_reactive.errors import SimulationError
from sumo_reactive.sumo.config import OUTPUT_FILES

AS_READ = {"output-prefix": "", "human-readable-time": "false", "precision": "2"}
"""Options that make a file lie where it was asked for, and its numbers readable."""

NOWHERE = "NUL"
"""SUMO's name for an output that nobody reads."""

_TRIP = "tripinfo"
_NUMBERS = ("depart", "departDelay", "arrival", "duration", "routeLength", "waitingTime", "waitingCount", "timeLoss")
_POLLUTANTS = ("CO2_abs", "fuel_abs", "NOx_abs")


class TripInfo(NamedTuple):
    """A vehicle's trip: times in s, `departure` None: not on the road until the end, `arrival` None: still there at the end.

    `length_m` is the way driven, `vaporized` whether SUMO took it off the road before its goal. `carbon_dioxide_mg`,
    `fuel_mg` and `nitrogen_oxides_mg` are 0 without an emission device.
    """

    vehicle_id: str
    departure: float | None
    departure_delay: float
    arrival: float | None
    duration: float
    length_m: float
    waiting: float
    stops: int
    time_loss: float
    vaporized: bool = False
    carbon_dioxide_mg: float = 0.0
    fuel_mg: float = 0.0
    nitrogen_oxides_mg: float = 0.0


class Contact(NamedTuple):
    """A collision as SUMO reports it, once for each pair that touches."""

    time: float
    collider: str
    victim: str


def silenced(options: Mapping[str, str]) -> dict[str, str]:
    """Return options that send every output file that a configuration names to nowhere."""
    return {name: NOWHERE for name in options if name in OUTPUT_FILES and not name.startswith("save-state")}


def read_trips(path: Path) -> Iterator[TripInfo]:
    """Yield the trips of a `tripinfo-output`, in the order in which they ended."""
    yield from map(_trip, elements_of(path, _TRIP, ("id", *_NUMBERS, "vaporized"), emissions=_POLLUTANTS))


def trip_of(path: Path, vehicle_id: str) -> TripInfo | None:
    """Return the trip of one vehicle, if the file has it."""
    return next((trip for trip in read_trips(path) if trip.vehicle_id == vehicle_id), None)


def read_contacts(path: Path) -> Iterator[Contact]:
    """Yield the collisions of a `collision-output`, in order of time."""
    for contact in elements_of(path, "collision", Contact._fields):
        yield Contact(float(contact.time or "nan"), contact.collider or "", contact.victim or "")


def read_teleports(path: Path) -> int:
    """Return the number of teleports that a `statistic-output` counts."""
    return sum(int(teleports.total or "0") for teleports in elements_of(path, "teleports", ("total",)))


def _trip(read: Any) -> TripInfo:
    departure, delay, arrival, duration, length, waiting, stops, loss = (float(getattr(read, key) or 0) for key in _NUMBERS)
    pollutants = [float(getattr(found, key) or 0) for found in read.emissions or () for key in _POLLUTANTS]
    departed, arrived = (time if time >= 0.0 else None for time in (departure, arrival))
    figures = departed, delay, arrived, duration, length, waiting, int(stops), loss
    return TripInfo(read.id or "", *figures, bool(read.vaporized), *pollutants)


def elements_of(path: Path, tag: str, attributes: Sequence[str], **children: Sequence[str]) -> Iterator[Any]:
    """Yield the elements of a kind with these attributes, None where one is missing, and those of their children.

    Raises SimulationError for a file that cannot be read.
    """
    try:
        with path.open("rb") as file:
            yield from parse(file, tag, {tag: attributes} | children, heterogeneous=False)
    except (OSError, ParseError, ValueError) as error:
        said = getattr(error, "strerror", None) or error
        raise SimulationError(f"{path}: SUMO's output cannot be read: {said}") from error
