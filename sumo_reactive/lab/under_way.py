"""A run that has not ended, told to whoever asks: what it has recorded so far, in a folder that the asker has made.

Who follows a run makes `.NAME.follow` beside the folder NAME of its record; the run looks for it twice a second. Nothing is
written for nobody, and nothing is left: the asker removes the folder with all that is in it.
"""

from __future__ import annotations

import shutil
import time as clock
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path

import psutil

from sumo_reactive.errors import OutputError
from sumo_reactive.files import is_own
from sumo_reactive.writing import whole_folder

Writer = Callable[[Path, Mapping[str, object]], None]

LOOK_S = 0.5
"""Both sides look so often for something new."""

_MOST_SHARE = 0.05
"""So much of its time a run spends on telling, at most."""

_KEPT = 2
"""Tellings that stay: one is read while the next is made."""

PROCESS = "process"
"""Key of the summary of a run that is under way: id of its process, and when that began."""


def place_to_tell(folder: Path) -> Path:
    """Return where a run tells what it has recorded so far, if it records in `folder`."""
    whole = folder.absolute()
    return whole.with_name(f".{whole.name}.follow")


@contextmanager
def asked(folder: Path) -> Iterator[Path]:
    """Ask the run that records in `folder`, now or later, to tell; give the place where it does, which is gone in the end.

    Raises OutputError where nobody could write.
    """
    place = place_to_tell(folder)
    try:
        place.mkdir(mode=0o700, parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"{place}: cannot be written: {error.strerror}") from error
    if not is_own(place):
        raise OutputError(f"{place}: not a folder of this user's alone")
    try:
        yield place
    finally:
        shutil.rmtree(place, ignore_errors=True)


def latest_in(place: Path) -> Path | None:
    """Return the folder of the last telling; None: there is none yet."""
    return max((one for one in place.glob("[0-9]*") if one.name.isdecimal()), key=lambda one: one.name, default=None)


def is_alive(process: object) -> bool:
    """Whether the process that a telling names under PROCESS still runs."""
    match process:
        case [int(number), float(began)] if number > 0:
            with suppress(psutil.Error):
                return abs(float(psutil.Process(number).create_time()) - began) < LOOK_S
    return False


class Teller:
    """Tells, where somebody asks, how far a run has come that records in `folder`.

    `summary` is what is known from the start; `write` gets a folder and a summary, and writes the record so far into it.
    """

    def __init__(self, folder: Path, summary: Mapping[str, object], write: Writer) -> None:
        self._place, self._summary, self._write = place_to_tell(folder), dict(summary), write
        self._due, self._number = 0.0, 0

    def see(self, ego: str, time: float) -> None:
        """Tell of the ego until a simulation time (s), if somebody asks and it is time to."""
        began = clock.monotonic()
        if began < self._due:
            return
        self._due = began + LOOK_S
        if not is_own(self._place):
            return
        with suppress(OutputError):  # who has asked may have gone
            self._tell(ego, time)
        self._due = clock.monotonic() + max(LOOK_S, (clock.monotonic() - began) / _MOST_SHARE)

    def _tell(self, ego: str, time: float) -> None:
        own = psutil.Process()
        told = {"ego": ego, "verdict": f"under way at {time:.1f} s", "figures": {}, PROCESS: [own.pid, own.create_time()]}
        latest = latest_in(self._place)
        self._number = 1 if latest is None else 1 + int(latest.name)
        with whole_folder(self._place / f"{self._number:06d}", "") as partial:
            self._write(partial, self._summary | told)
        shutil.rmtree(self._place / f"{self._number - _KEPT:06d}", ignore_errors=True)

    def close(self) -> None:
        """Take back what has been told: the record is there."""
        if self._number:
            shutil.rmtree(self._place, ignore_errors=True)
