"""SUMO's own outputs: which options write them, and what they say, read element by element."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import NamedTuple
from xml.etree.ElementTree import Element, ParseError, iterparse

from sumo_reactive.errors import SimulationError
from sumo_reactive.sumo.option_names import OUTPUT_FILES

AS_READ = {"output-prefix": "", "human-readable-time": "false", "precision": "2"}
"""Options that make a file lie where it was asked for, and its numbers readable."""

NOWHERE = "NUL"
"""SUMO's name for an output that nobody reads."""

_TRIP, _EMISSIONS = "tripinfo", "emissions"
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
    for element in _elements(path, _TRIP):
        yield _trip(element)


def trip_of(path: Path, vehicle_id: str) -> TripInfo | None:
    """Return the trip of one vehicle, if the file has it."""
    return next((trip for trip in read_trips(path) if trip.vehicle_id == vehicle_id), None)


def read_contacts(path: Path) -> Iterator[Contact]:
    """Yield the collisions of a `collision-output`, in order of time."""
    for element in _elements(path, "collision"):
        yield Contact(float(element.get("time", "nan")), element.get("collider", ""), element.get("victim", ""))


def read_teleports(path: Path) -> int:
    """Return the number of teleports that a `statistic-output` counts."""
    return sum(int(element.get("total", "0")) for element in _elements(path, "teleports"))


def _trip(element: Element) -> TripInfo:
    def number(name: str) -> float:
        return float(element.get(name, "0"))

    emissions = element.find(_EMISSIONS)
    pollutants = (0.0, 0.0, 0.0) if emissions is None else tuple(float(emissions.get(name, "0")) for name in _POLLUTANTS)
    departure, arrival = number("depart"), number("arrival")
    return TripInfo(
        element.get("id", ""),
        departure if departure >= 0.0 else None,
        number("departDelay"),
        arrival if arrival >= 0.0 else None,
        number("duration"),
        number("routeLength"),
        number("waitingTime"),
        int(number("waitingCount")),
        number("timeLoss"),
        bool(element.get("vaporized", "")),
        *pollutants,
    )


def _elements(path: Path, tag: str) -> Iterator[Element]:
    """Yield the elements of a kind below the root; each is forgotten when the next is asked for."""
    try:
        with path.open("rb") as file:
            depth, root = 0, None
            for event, element in iterparse(file, events=("start", "end")):
                root = element if root is None else root
                depth += 1 if event == "start" else -1
                if event == "end" and depth == 1:
                    if element.tag == tag:
                        yield element
                    root.clear()
    except (OSError, ParseError, ValueError) as error:
        said = getattr(error, "strerror", None) or error
        raise SimulationError(f"{path}: SUMO's output cannot be read: {said}") from error
