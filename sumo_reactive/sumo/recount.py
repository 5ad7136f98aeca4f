"""What SUMO counts amiss of an ego, put right in the files that SUMO has written.

SUMO takes each lane that a vehicle moved from outside leaves for driven to its end, also where it changes to the lane beside
(`moveToXY` and `moveTo` alike), and knows nothing of the stops that the ego serves by itself.
"""

from __future__ import annotations

import gzip
import re
import shutil
import tempfile
from collections.abc import Callable, Mapping
from os import close
from pathlib import Path
from typing import IO, NamedTuple
from xml.sax.saxutils import unescape

import libsumo

from sumo_reactive.sumo.config import seconds_of

_GZIP, _XML = b"\x1f\x8b", b"<?xml"
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
    rows = None if files.trips is None else _recounted(files.trips, lambda line, file: _row(line, file, egos))
    means = [] if files.means is None else _recounted(files.means, lambda line, file: _means(line, file, rows, egos))
    return (*(rows or ()), *means)


def _recounted(file: Path, edited: Callable[[str, Path], tuple[str, list[Recount]]]) -> list[Recount]:
    """Put every line of a file through `edited`, which returns another line and what that puts right."""
    found: list[Recount] = []

    def told(line: str) -> str:
        line, recounts = edited(line, file)
        found.extend(recounts)
        return line

    why = rewrite_lines(file, told)
    return [_left(file, why)] if why else found


def _left(file: Path, why: str, vehicle: str = "", counted: str = "") -> Recount:
    return Recount(file.name, vehicle, _LENGTH, counted, f"{_LEFT}: {why}")


def _row(line: str, file: Path, egos: Mapping[str, Driven]) -> tuple[str, list[Recount]]:
    """Put the row of an ego in a `tripinfo-output` right."""
    named = _ROW.search(line)
    vehicle = unescape(named[1], _QUOTES) if named else ""
    if vehicle not in egos:
        return line, []
    row, ego = dict(_ATTRIBUTE.findall(line)), egos[vehicle]
    if abs(seconds_of(row["duration"]) - ego.duration) > _resolution(row["duration"]):
        return line, [_left(file, "SUMO's own driver drove on", vehicle, row[_LENGTH])]
    figures = {_LENGTH: _like(row[_LENGTH], ego.distance)}
    if ego.stopped > 0.0:
        for name, sign in (("waitingTime", -1.0), ("stopTime", 1.0), ("timeLoss", -1.0)):
            figures[name] = _like(row[name], max(0.0, seconds_of(row[name]) + sign * ego.stopped))
    return _with(line, figures), [Recount(file.name, vehicle, name, row[name], used) for name, used in figures.items()]


def _means(line: str, file: Path, rows: list[Recount] | None, egos: Mapping[str, Driven]) -> tuple[str, list[Recount]]:
    """Move the means over all trips in a `statistic-output` by what was put right in the egos' `rows`."""
    if _MEAN_ROW not in line:
        return line, []
    row, found = dict(_ATTRIBUTE.findall(line)), list[Recount]()
    if rows is None or not all(one.vehicle for one in rows):
        found.append(_left(file, f"no {_TRIPS} in XML tells what SUMO has counted of an ego", counted=row[_LENGTH]))
    change: dict[str, float] = {}
    for one in rows or ():
        if one.vehicle and one.is_put_right:
            more = (seconds_of(one.used) - seconds_of(one.sumo)) / int(row["count"])
            change[one.attribute] = change.get(one.attribute, 0.0) + more
            if one.attribute == _LENGTH:
                change["speed"] = change.get("speed", 0.0) + more / max(egos[one.vehicle].duration, 1e-3)
    figures = {name: _like(row[name], seconds_of(row[name]) + more) for name, more in change.items() if name in row}
    found += [Recount(file.name, "", name, row[name], used) for name, used in figures.items()]
    return _with(line, figures), found


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


def rewrite_lines(path: Path, edited: Callable[[str], str]) -> str:
    """Put every line of an XML file, compressed or not, through `edited`; return why that was not done (empty: it was)."""
    target = path.resolve()
    if not target.is_file():
        return "no such file"
    try:
        with target.open("rb") as file:
            is_compressed = file.read(len(_GZIP)) == _GZIP
        with _opened(target, "rb", is_compressed) as content:
            if content.read(len(_XML)) != _XML:
                return "not XML"
        _rewrite(target, edited, is_compressed)
    except (OSError, EOFError) as error:
        return getattr(error, "strerror", None) or str(error)
    return ""


def _rewrite(target: Path, edited: Callable[[str], str], is_compressed: bool) -> None:
    handle, partial = tempfile.mkstemp(prefix=f".{target.name}.", dir=target.parent)
    close(handle)
    try:
        with _opened(target, "rt", is_compressed) as lines, _opened(Path(partial), "wt", is_compressed) as out:
            out.writelines(edited(line) for line in lines)
        shutil.copymode(target, partial)
        Path(partial).replace(target)
    finally:
        Path(partial).unlink(missing_ok=True)


def _opened(path: Path, mode: str, is_compressed: bool) -> IO:  # type: ignore[type-arg]
    text = {"encoding": "utf-8", "errors": "surrogateescape", "newline": ""} if "t" in mode else {}
    return gzip.open(path, mode, **text) if is_compressed else path.open(mode, **text)  # type: ignore[call-overload,no-any-return]
