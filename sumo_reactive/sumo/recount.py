"""What SUMO counts amiss of an ego, put right in the files that SUMO has written.

SUMO takes each lane that a vehicle moved from outside leaves for driven to its end, also where it changes to the lane beside
(`moveToXY` and `moveTo` alike), and knows nothing of the stops that the ego serves by itself.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple
from xml.sax.saxutils import unescape

import libsumo

from sumo_reactive.sumo.config import seconds_of
from sumo_reactive.sumo.rewriting import rewrite_lines

_TRIPS, _MEANS = "tripinfo-output", "statistic-output"
_ROW, _MEAN_ROW = re.compile(r'<tripinfo id="([^"]*)"'), "<vehicleTripStatistics "
_ATTRIBUTE = re.compile(r'\b(\w+)="([^"]*)"')
_QUOTES = {"&quot;": '"', "&apos;": "'"}
_NOWHERE = ("nul", "/dev/null")
_LENGTH = "routeLength"
_LEFT = "left as counted"


class Driven(NamedTuple):
    """What an ego has driven: for `duration` s, `distance` m; of that time it stood `stopped` s at stops of its route."""

    duration: float
    distance: float
    stopped: float


class Recount(NamedTuple):
    """A figure of one of SUMO's outputs: of which vehicle (empty: a mean over all), what SUMO has counted, what the file now
    says; "left as counted" and why, where that is the same."""

    file: str
    vehicle: str
    attribute: str
    sumo: str
    used: str

    @property
    def is_put_right(self) -> bool:
        """Whether the file says anything else than SUMO has counted."""
        return not self.used.startswith(_LEFT)


class TripFiles(NamedTuple):
    """Where SUMO writes every trip, and their means; None where nobody asks for that."""

    trips: Path | None
    means: Path | None


def trip_files() -> TripFiles:
    """Return the files that the running simulation writes."""
    return TripFiles(_file(_TRIPS), _file(_MEANS))


def _file(option: str) -> Path | None:
    name = str(libsumo.simulation.getOption(option))
    if not name or name.lower() in _NOWHERE:
        return None
    path = Path(name)
    return path.with_name(f"{libsumo.simulation.getOption('output-prefix')}{path.name}")


def put_right(files: TripFiles, egos: Mapping[str, Driven]) -> tuple[Recount, ...]:
    """Put the figures of all `egos` right in files that SUMO has closed; return each with what SUMO had counted.

    What cannot be put right (no XML, not to be written) stays as it is and is told as such.
    """
    rows = None if files.trips is None else _Rows(files.trips, egos).put_right()
    means = [] if files.means is None else _Means(files.means, rows, egos).put_right()
    return (*(rows or ()), *means)


def _left(file: Path, why: str, vehicle: str = "", counted: str = "") -> Recount:
    return Recount(file.name, vehicle, _LENGTH, counted, f"{_LEFT}: {why}")


class _Rows:
    """The egos' rows of a `tripinfo-output`."""

    def __init__(self, file: Path, egos: Mapping[str, Driven]) -> None:
        self._file, self._egos = file, egos
        self._found: list[Recount] = []

    def put_right(self) -> list[Recount]:
        why = rewrite_lines(self._file, self._line)
        return [_left(self._file, why)] if why else self._found

    def _line(self, line: str) -> str:
        named = _ROW.search(line)
        vehicle = unescape(named[1], _QUOTES) if named else ""
        if vehicle not in self._egos:
            return line
        row, ego = dict(_ATTRIBUTE.findall(line)), self._egos[vehicle]
        if abs(seconds_of(row["duration"]) - ego.duration) > _resolution(row["duration"]):
            self._found.append(_left(self._file, "SUMO's own driver drove on", vehicle, row[_LENGTH]))
            return line
        figures = {_LENGTH: _like(row[_LENGTH], ego.distance)}
        if ego.stopped > 0.0:
            for name, sign in (("waitingTime", -1.0), ("stopTime", 1.0), ("timeLoss", -1.0)):
                figures[name] = _like(row[name], max(0.0, seconds_of(row[name]) + sign * ego.stopped))
        self._found += [Recount(self._file.name, vehicle, name, row[name], used) for name, used in figures.items()]
        return _with(line, figures)


class _Means:
    """The means over all trips in a `statistic-output`, moved by what was put right in the egos' `rows`."""

    def __init__(self, file: Path, rows: list[Recount] | None, egos: Mapping[str, Driven]) -> None:
        self._file, self._egos = file, egos
        self._rows = [row for row in rows or () if row.vehicle and row.is_put_right]
        self._is_known = rows is not None and all(row.vehicle for row in rows)
        self._found: list[Recount] = []

    def put_right(self) -> list[Recount]:
        why = rewrite_lines(self._file, self._line)
        return [_left(self._file, why)] if why else self._found

    def _line(self, line: str) -> str:
        if _MEAN_ROW not in line:
            return line
        row = dict(_ATTRIBUTE.findall(line))
        if not self._is_known:
            why = f"no {_TRIPS} in XML tells what SUMO has counted of an ego"
            self._found.append(_left(self._file, why, counted=row[_LENGTH]))
        change: dict[str, float] = {}
        for one in self._rows:
            more = (seconds_of(one.used) - seconds_of(one.sumo)) / int(row["count"])
            change[one.attribute] = change.get(one.attribute, 0.0) + more
            if one.attribute == _LENGTH:
                change["speed"] = change.get("speed", 0.0) + more / max(self._egos[one.vehicle].duration, 1e-3)
        figures = {name: _like(row[name], seconds_of(row[name]) + more) for name, more in change.items() if name in row}
        self._found += [Recount(self._file.name, "", name, row[name], used) for name, used in figures.items()]
        return _with(line, figures)


def _with(line: str, figures: Mapping[str, str]) -> str:
    """Return a line with other values of attributes."""
    return _ATTRIBUTE.sub(lambda found: f'{found[1]}="{figures.get(found[1], found[2])}"', line)


def _like(text: str, value: float) -> str:
    """Return a figure written as `text` is: with as many decimals, as h:m:s where that is."""
    decimals = len(text.partition(".")[2])
    if ":" not in text:
        return f"{value:.{decimals}f}"
    rounded = round(value, decimals)
    hours, seconds = divmod(rounded, 3600.0)
    minutes, seconds = divmod(seconds, 60.0)
    width = 3 + decimals if decimals else 2
    return f"{int(hours):02d}:{int(minutes):02d}:{seconds:0{width}.{decimals}f}"


def _resolution(text: str) -> float:
    """Return how far a figure may be from the one that `text` says, s."""
    return 0.6 * 10.0 ** -len(text.partition(".")[2])
